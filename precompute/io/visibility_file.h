// visibility.exr and pca.exr: coefficients per texel or per vertex.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/irradiance_weight.h"
#include "precompute/math/vec.h"

namespace prt {

enum class PointDomain { Texel, Vertex };
const char* pointDomainName(PointDomain domain);  ///< "texel", "vertex"

/// Why a texel (or vertex) has the value it has; the channel `validity`.
enum class Validity : uint32_t {
    Empty = 0,         ///< no surface here; zeros
    Valid = 1,         ///< baked here
    GutterFilled = 2,  ///< outside the charts, copied from the nearest valid texel
    InsideFilled = 3,  ///< its point lies inside geometry, copied from the nearest valid texel of the chart
    Inside = 4,        ///< inside geometry with no valid texel near; baked value kept
};
inline constexpr int kValidityCount = 5;
/// Its point lies inside geometry, whatever value it has.
constexpr bool isInside(Validity validity) {
    return validity == Validity::InsideFilled || validity == Validity::Inside;
}
const char* validityName(
    Validity validity);  ///< "empty", "valid", "gutter_filled", "inside_filled", "inside"

/// Grid of points: the atlas per texel; per vertex, vertices in mesh.glb order wrapped into rows of `width`.
struct PointGrid {
    PointDomain domain = PointDomain::Texel;
    int width = 0, height = 0;
    size_t count = 0;  ///< points in use: width·height per texel, the number of vertices per vertex
};

/// Row length of per-vertex files.
inline constexpr int kVertexRowLength = 1024;
/// Grid for so many vertices.
PointGrid vertexGrid(size_t vertexCount);

struct VisibilityMap {
    PointGrid grid;
    int shOrder = 0;
    std::vector<float> coefficients;  ///< [count×n²]
    std::vector<Validity> validity;   ///< [count]
    std::vector<float> ao;            ///< [count] cosine-weighted, 1 = open
    std::vector<Vec3f> normals;       ///< [count] geometric, world
    /// [count] estimated RMS sampling error of irradiance, as a share of what an open point receives; empty:
    /// not known (files of older versions)
    std::vector<float> error;
    Projection projection = kPlainProjection;       ///< how the coefficients were made
    std::map<std::string, std::string> attributes;  ///< any more, written as EXR string attributes
};

/// What stage 2 reads of a point.
struct VisibilityRowBlock {
    size_t first = 0;                 ///< index of the first point
    std::vector<float> coefficients;  ///< [points×n²]
    std::vector<Validity> validity;   ///< [points]
    std::vector<Vec3f> normals;       ///< [points]
};

/// visibility.exr opened for reading some rows of its grid at a time.
class VisibilityReader {
  public:
    /// Checks conventions, channels and sizes.
    /// @throws InputError
    explicit VisibilityReader(const std::string& path);
    ~VisibilityReader();
    VisibilityReader(const VisibilityReader&) = delete;
    VisibilityReader& operator=(const VisibilityReader&) = delete;

    /// Grid, order, projection and attributes; its values are empty.
    const VisibilityMap& header() const { return header_; }
    /// The points of rows firstRow … firstRow + rows − 1 of the grid. Memory of the block is kept for the
    /// next.
    /// @throws InputError  damaged pixels; Interrupted
    void read(int firstRow, int rows, VisibilityRowBlock& block) const;

  private:
    friend VisibilityMap readVisibilityFile(const std::string& path);
    struct File;
    std::string path_;
    std::unique_ptr<File> file_;
    VisibilityMap header_;
};

/// Channels V.00…V.NN (zero-padded shIndex), ao, error, normal.X/Y/Z (float), validity (uint); ZIP,
/// scanlines.
/// @throws OutputError
void writeVisibilityFile(const std::string& path, const VisibilityMap& map);
/// Checks conventions, channels and sizes before it allocates.
/// @throws InputError
VisibilityMap readVisibilityFile(const std::string& path);

/// V ≈ mean + Σ_m w_m basis_m.
struct PcaMap {
    PointGrid grid;
    int shOrder = 0;
    int components = 0;
    std::vector<float> mean;                   ///< [n²]
    std::vector<float> basis;                  ///< [M×n²], rows orthonormal
    std::vector<float> weights;                ///< [count×M]
    std::vector<float> variance;               ///< [M] eigenvalues of the covariance, falling
    Projection projection = kPlainProjection;  ///< how the compressed coefficients were made
    std::map<std::string, std::string> attributes;
};

/// pca.exr written some rows of the grid at a time.
class PcaWriter {
  public:
    /// @param map  its weights are not looked at
    /// @throws OutputError
    PcaWriter(const std::string& path, const PcaMap& map);
    ~PcaWriter();
    PcaWriter(const PcaWriter&) = delete;
    PcaWriter& operator=(const PcaWriter&) = delete;

    /// Weights of the next points of the grid, whole rows of it but for the last.
    /// @param weights  [points×M]
    /// @throws OutputError, Interrupted
    void write(std::span<const float> weights);
    /// After the last point; without it no file appears.
    /// @throws OutputError
    void commit();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// @throws OutputError
void writePcaFile(const std::string& path, const PcaMap& map);
/// @throws InputError
PcaMap readPcaFile(const std::string& path);

}  // namespace prt
