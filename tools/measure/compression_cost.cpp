// Counts of runtime/shaders/light.frag [IwanickiSloan2012], and of transfer matrices [Sloan2002],
// [Sloan2006].
#include "tools/measure/compression_cost.h"

#include "compress/tables/normal_tables.h"
#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "runtime/technique.h"

namespace prt::tools {
namespace {

constexpr size_t kBytesOfHalf = 2;

}  // namespace

size_t tableBytes(int values, bool hasMean, int size) {
    PRT_CHECK_LE(1, size);
    return shippedTableBytes(values, hasMean, "half") * 6 * size_t(size) * size_t(size);
}

PixelCost pixelCost(int values, bool hasMean, PointDomain domain) {
    TechniqueSource source;
    (hasMean ? source.components : source.shOrder) = hasMean ? values : shOrderFromCount(size_t(values));
    const TechniqueCost cost =
        techniqueCost(hasMean ? Technique::Pca : Technique::Unc, source, domain, kTableCosineBands);
    return {cost.fetches, cost.multiplyAdds};
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
