// What visibility costs: bytes of a point, work of a pixel, and bytes of the transfer matrices it replaces.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "compress/shipped_bytes.h"
#include "precompute/io/visibility_file.h"

namespace prt::tools {

/// Bytes of the tables of one environment as half floats, four functions to a texel: three colours, and RGB
/// of the mean.
/// @param values   n², or M    @param hasMean  triple-product tables
/// @param size     texels along an edge of the cube, at least 1
size_t tableBytes(int values, bool hasMean, int size);

/// Work of runtime/shaders/light.frag for one pixel.
struct PixelCost {
    int fetches = 0;       ///< of four channels, filtered or not
    int multiplyAdds = 0;  ///< of scalars
};

/// With L = ⌈values/4⌉: 4L fetches and 12L multiply-adds, one fetch more for the mean; per vertex each layer
/// of coefficients is fetched at three corners and mixed: 2L fetches and 12L multiply-adds more.
/// @source [IwanickiSloan2012, Sec. 3.2 and 4]
PixelCost pixelCost(int values, bool hasMean, PointDomain domain);

/// A way to store transfer in place of visibility, for the same light of n² coefficients and one colour
/// channel (interreflection would need three).
struct TransferStorage {
    std::string method;
    int values;    ///< of a point
    size_t bytes;  ///< of a point, in half floats
};

/// "half-life-2": irradiance in 3 functions of the normal, 3·n² values [Sloan2006] as [HabelWimmer2010, Sec.
/// 2] has it. "sh9": irradiance in the 9 functions that clamped cosines need, 9·n² [RamamoorthiHanrahan2001].
/// "matrix": transferred radiance in n² functions, n⁴, which glossy reflection needs [Sloan2002, Sec. 5].
/// @param shOrder  n, at least 1
std::vector<TransferStorage> transferStorage(int shOrder);

}  // namespace prt::tools
