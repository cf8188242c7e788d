// tables/ENV.KIND.LAYOUT.exr
#pragma once

#include <map>
#include <string>
#include <vector>

namespace prt {

enum class TableKind { LightCosine, TripleProduct };
const char* tableKindName(TableKind kind);  ///< "light-cosine", "triple-product"

/// Tables over the normal, cube layout (math/sphere_map.h): size × 6·size texels.
struct NormalTable {
    TableKind kind = TableKind::LightCosine;
    int size = 0;     ///< texels along an edge of a face
    int shOrder = 0;  ///< of the visibility it is made for
    int layers = 0;   ///< light-cosine: n²; triple-product: M + 1, the mean last
    /// [colour 3][layer][6·size·size], float
    std::vector<float> values;
    std::map<std::string, std::string> attributes;  ///< environment name and hash, cosine model, …

    size_t texels() const { return size_t(6) * size_t(size) * size_t(size); }
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
