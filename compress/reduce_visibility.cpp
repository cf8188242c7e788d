// Sources: [IwanickiSloan2012, Sec. 4] for vectors and weights; math/irradiance_projection.h for bands.
#include "compress/reduce_visibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "compress/irradiance_weights.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

// Points of a block: the coefficients of one fit into the caches.
constexpr size_t kBlock = 4096;

void solveAgain(const VisibilityMap& from, VisibilityMap& to) {
    const size_t columns = size_t(shCount(from.shOrder)), kept = size_t(shCount(to.shOrder));
    const IrradianceProjection before(from.shOrder, from.projection.weight),
        after(to.shOrder, from.projection.weight);
    parallelFor(from.grid.count, kBlock, [&](size_t begin, size_t end) {
        std::vector<float> weighed(columns), cosine(columns);
        for (size_t point = begin; point < end; ++point) {
            const std::span row(&from.coefficients[point * columns], columns);
            const std::span out(&to.coefficients[point * kept], kept);
            const Vec3f& normal = from.normals[point];
            if (!(normal.squaredNorm() > 0)) {
                std::copy_n(row.begin(), kept, out.begin());
                continue;
            }
            const Vec3f unit = normal.normalized();
            evalClampedCosineSh(from.shOrder, unit, cosine);
            double irradiance = 0;
            for (size_t i = 0; i < columns; ++i) irradiance += double(row[i]) * double(cosine[i]);
            before.weigh(unit, row, weighed);
            after.solve(unit, std::span(weighed).first(kept), float(irradiance), out);
        }
    });
}

bool isFittedForIrradiance(const PcaMap& pca) {
    const auto fit = pca.attributes.find("weightsFit");
    if (fit == pca.attributes.end() || fit->second == "plain") return false;
    if (fit->second != "irradiance")
        throw InputError("PCA weights", fmt::format("were fitted in an unknown way, '{}'", fit->second),
                         "renew them with prt compress");
    return true;
}

}  // namespace

VisibilityMap reduceOrder(const VisibilityMap& visibility, int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, visibility.shOrder);
    if (shOrder == visibility.shOrder) return visibility;
    VisibilityMap reduced;
    reduced.grid = visibility.grid;
    reduced.shOrder = shOrder;
    reduced.validity = visibility.validity;
    reduced.ao = visibility.ao;
    reduced.normals = visibility.normals;
    reduced.error = visibility.error;
    reduced.projection = visibility.projection;
    reduced.attributes = visibility.attributes;
    const size_t columns = size_t(shCount(visibility.shOrder)), kept = size_t(shCount(shOrder));
    reduced.coefficients.resize(visibility.grid.count * kept);
    if (visibility.projection.kind == ProjectionKind::Irradiance) {
        PRT_CHECK_EQ(visibility.normals.size(), visibility.grid.count);
        solveAgain(visibility, reduced);
    } else {
        for (size_t point = 0; point < visibility.grid.count; ++point)
            std::copy_n(&visibility.coefficients[point * columns], kept, &reduced.coefficients[point * kept]);
    }
    return reduced;
}

PcaMap reduceComponents(const PcaMap& pca, std::span<const Vec3f> normals, int components) {
    PRT_CHECK_LE(1, components);
    PRT_CHECK_LE(components, pca.components);
    if (components == pca.components) return pca;
    const size_t columns = size_t(shCount(pca.shOrder)), all = size_t(pca.components),
                 kept = size_t(components);
    PcaMap reduced;
    reduced.grid = pca.grid;
    reduced.shOrder = pca.shOrder;
    reduced.components = components;
    reduced.mean = pca.mean;
    reduced.basis.assign(pca.basis.begin(), pca.basis.begin() + std::ptrdiff_t(kept * columns));
    reduced.variance.assign(pca.variance.begin(), pca.variance.begin() + std::ptrdiff_t(kept));
    reduced.projection = pca.projection;
    reduced.attributes = pca.attributes;
    reduced.weights.resize(pca.grid.count * kept);
    if (!isFittedForIrradiance(pca)) {
        for (size_t point = 0; point < pca.grid.count; ++point)
            std::copy_n(&pca.weights[point * all], kept, &reduced.weights[point * kept]);
        return reduced;
    }
    PRT_CHECK_EQ(normals.size(), pca.grid.count);
    PcaResult basis;
    basis.components = components;
    basis.mean = reduced.mean;
    basis.basis = reduced.basis;
    const IrradianceFit fit(basis, pca.shOrder, pca.projection.weight);
    // Rows are made again some at a time: all of them may be more than the weights by far.
    constexpr size_t kRows = 64 * kBlock;
    std::vector<float> rows;
    for (size_t first = 0; first < pca.grid.count; first += kRows) {
        const size_t count = std::min(kRows, pca.grid.count - first);
        rows.resize(count * columns);
        parallelFor(count, kBlock, [&](size_t begin, size_t end) {
            for (size_t point = begin; point < end; ++point) {
                float* row = &rows[point * columns];
                std::copy_n(pca.mean.begin(), columns, row);
                for (size_t m = 0; m < all; ++m) {
                    const float weight = pca.weights[(first + point) * all + m];
                    for (size_t i = 0; i < columns; ++i) row[i] += weight * pca.basis[m * columns + i];
                }
            }
        });
        fit.fit(rows, normals.subspan(first, count),
                std::span(reduced.weights).subspan(first * kept, count * kept));
    }
    return reduced;
}

}  // namespace prt
