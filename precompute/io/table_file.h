// tables/ENV.KIND.LAYOUT.exr
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "precompute/math/table_layout.h"

namespace prt {

enum class TableKind { LightCosine, TripleProduct };
const char* tableKindName(TableKind kind);  ///< "light-cosine", "triple-product"

/// Tables over the normal, in one of the layouts of math/table_layout.h.
struct NormalTable {
    TableKind kind = TableKind::LightCosine;
    std::string layout = "cube";  ///< one of TableLayout::names()
    int size = 0;                 ///< texels along the side of a face
    int shOrder = 0;              ///< of the visibility it is made for
    int layers = 0;               ///< light-cosine: n²; triple-product: M + 1, the mean last
    /// [colour 3][layer][texels()], float
    std::vector<float> values;
    std::map<std::string, std::string> attributes;  ///< environment name and hash, cosine model, …

    /// Width and height of the image of one layer, texels.
    std::array<int, 2> imageSize() const { return TableLayout::imageSize(layout, size); }
    size_t texels() const { return size_t(imageSize()[0]) * size_t(imageSize()[1]); }
    float* layer(int colour, int index) {
        return values.data() + (size_t(colour) * size_t(layers) + size_t(index)) * texels();
    }
    const float* layer(int colour, int index) const {
        return values.data() + (size_t(colour) * size_t(layers) + size_t(index)) * texels();
    }
};

/// Light-cosine: channels R.00…, G.00…, B.00…. Triple-product: R.00.R R.00.G R.00.B R.00.A R.01.R … (four
/// vectors per RGBA layer, zeros behind the last), and mean.R mean.G mean.B.
void writeTableFile(const std::string& path, const NormalTable& table);
NormalTable readTableFile(const std::string& path);

}  // namespace prt
