// Counts of runtime/shaders/light.frag [IwanickiSloan2012], and of transfer matrices [Sloan2002],
// [Sloan2006].
#include "tools/measure/compression_cost.h"

#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

constexpr size_t kBytesOfHalf = 2;

int layersOf(int values) { return (values + 3) / 4; }

}  // namespace

size_t tableBytes(int values, bool hasMean, int size) {
    PRT_CHECK_LE(1, size);
    return shippedTableBytes(values, hasMean, "half") * 6 * size_t(size) * size_t(size);
}

PixelCost pixelCost(int values, bool hasMean, PointDomain domain) {
    const int layers = layersOf(values);
    PixelCost cost{4 * layers + (hasMean ? 1 : 0), 12 * layers};
    if (domain == PointDomain::Vertex) {
        cost.fetches += 2 * layers;
        cost.multiplyAdds += 12 * layers;
    }
    return cost;
}

std::vector<TransferStorage> transferStorage(int shOrder) {
    const int n2 = shCount(shOrder);
    std::vector<TransferStorage> rows;
    for (const auto& [method, functions] :
         {std::pair{"half-life-2", 3}, std::pair{"sh9", 9}, std::pair{"matrix", n2}})
        rows.push_back({method, functions * n2, size_t(functions * n2) * kBytesOfHalf});
    return rows;
}

}  // namespace prt::tools
