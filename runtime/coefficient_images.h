// Visibility, PCA weights and tables as textures of four values per texel. Internal.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"

namespace prt {

/// Coefficients of every point of a grid: a 2D array, layer i holds coefficients 4i … 4i + 3 (zeros behind
/// the last).
struct CoefficientImage {
    GlObject texture;
    PointGrid grid;
    int layers = 0;
};

/// @param perPoint  coefficients of a point
/// @param values    [grid.count×perPoint]
/// @param where     names the data in errors
/// @throws InputError  larger than OpenGL takes
CoefficientImage uploadCoefficients(const GlContext& context, const PointGrid& grid, int perPoint,
                                    std::span<const float> values, const char* where);

/// A table over normals: a 2D array whose group colour·layers + i holds coefficients 4i … 4i + 3; then the
/// RGB mean, if there is one. A group is one image of the table's layout; of a cube six, the faces, each
/// within a border of the neighbouring faces' texels.
struct TableShape {
    std::string layout;
    int size = 0;
    int layers = 0;
    bool mean = false;
    int width = 0, height = 0, images = 0;  ///< of the texture
    bool operator==(const TableShape&) const = default;
};
struct TableImage {
    GlObject texture;
    TableShape shape;
    GlObject frame;  ///< over all images, when something was blended into it
};

/// Fills an image, or makes it anew when its shape differs.
/// @throws InputError  larger than OpenGL takes
void uploadTable(const GlContext& context, const NormalTable& table, TableImage& image);
/// Makes an image anew, with any values, unless it has the shape already.
/// @throws InputError  larger than OpenGL takes
void shapeTable(const GlContext& context, const TableShape& shape, TableImage& image);

}  // namespace prt
