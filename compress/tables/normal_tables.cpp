// Light × cosine and light × cosine × PCA vector over all normals: [IwanickiSloan2012, Sec. 3.2-3.3 and Eq.
// 6].
//
// R(n) = Pᵀ h(n): P is the product matrix of the environment (rows: bands of the cosine, columns:
// visibility), h(n) the clamped cosine about n [RamamoorthiHanrahan2001]. Its odd bands from 3 on are zero
// and left out.
#include "compress/tables/normal_tables.h"

#include <algorithm>

#include "compress/tables/fast_tables.h"
#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sphere_map.h"
#include "precompute/math/table_layout.h"

namespace prt {
namespace {

// Texels that one task works on: their cosine coefficients and a row of results stay in the first-level
// cache.
constexpr size_t kNormalBlock = 128;

using RowMatrixXf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Indices of the coefficients of a clamped cosine that are not zero.
std::vector<int> cosineRows(int bands) {
    std::vector<int> rows;
    for (int band = 0; band < bands; ++band) {
        if (band >= 3 && band % 2 == 1) continue;
        for (int m = -band; m <= band; ++m) rows.push_back(shIndex(band, m));
    }
    return rows;
}

// Product matrices of the three colours, transposed, without the rows of zero bands: [3·n² × rows].
RowMatrixXf lightMatrix(const EnvironmentSh& environment, int shOrder, int cosineBands,
                        const std::vector<int>& rows) {
    const int columns = shCount(shOrder);
    const size_t used = size_t(shCount(tableEnvironmentShOrder(shOrder, cosineBands)));
    RowMatrixXf matrix(3 * columns, Eigen::Index(rows.size()));
    for (int colour = 0; colour < 3; ++colour) {
        const std::span<const float> light(environment.rgb[size_t(colour)]);
        const std::vector<float> product = productMatrix(light.first(used), cosineBands, shOrder);
        for (size_t r = 0; r < rows.size(); ++r)
            for (int i = 0; i < columns; ++i)
                matrix(colour * columns + i, Eigen::Index(r)) =
                    product[size_t(rows[r]) * size_t(columns) + size_t(i)];
    }
    return matrix;
}

}  // namespace

std::vector<float> evalLightCosine(const EnvironmentSh& environment, int shOrder,
                                   std::span<const Vec3f> normals, int cosineBands) {
    PRT_CHECK_LE(1, cosineBands);
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(tableEnvironmentShOrder(shOrder, cosineBands), environment.shOrder);
    const std::vector<int> rows = cosineRows(cosineBands);
    const RowMatrixXf light = lightMatrix(environment, shOrder, cosineBands, rows);

    std::vector<float> values(size_t(light.rows()) * normals.size());
    Eigen::Map<RowMatrixXf> out(values.data(), light.rows(), Eigen::Index(normals.size()));
    parallelFor(normals.size(), kNormalBlock, [&](size_t begin, size_t end) {
        Eigen::MatrixXf cosines(Eigen::Index(rows.size()), Eigen::Index(end - begin));
        std::vector<float> all(size_t(shCount(cosineBands)));
        for (size_t k = begin; k < end; ++k) {
            evalClampedCosineSh(cosineBands, normals[k], all);
            for (size_t r = 0; r < rows.size(); ++r)
                cosines(Eigen::Index(r), Eigen::Index(k - begin)) = all[size_t(rows[r])];
        }
        out.middleCols(Eigen::Index(begin), cosines.cols()).noalias() = light * cosines;
    });
    return values;
}

std::vector<float> buildLightCosineTable(const EnvironmentSh& environment, int shOrder, int size,
                                         int cosineBands) {
    PRT_CHECK_LE(1, size);
    PRT_CHECK_LE(size, 1024);
    LightTableBuilder builder(TableLayout("cube", size), shOrder, cosineBands);
    std::vector<float> values(size_t(3) * size_t(shCount(shOrder)) * builder.texelCount());
    builder.buildLightCosine(environment, values);
    return values;
}

std::vector<float> buildTripleProductTable(std::span<const float> lightCosine, int shOrder, int size,
                                           std::span<const float> mean, std::span<const float> basis) {
    const int n2 = shCount(shOrder);
    const size_t texels = size_t(6) * size_t(size) * size_t(size);
    PRT_CHECK_EQ(lightCosine.size(), size_t(3) * size_t(n2) * texels);
    PRT_CHECK_EQ(mean.size(), size_t(n2));
    PRT_CHECK_EQ(basis.size() % size_t(n2), size_t(0));
    const auto components = Eigen::Index(basis.size() / size_t(n2));
    RowMatrixXf vectors(components + 1, n2);
    vectors.topRows(components) = Eigen::Map<const RowMatrixXf>(basis.data(), components, n2);
    vectors.row(components) = Eigen::Map<const Eigen::RowVectorXf>(mean.data(), n2);

    std::vector<float> table(size_t(3) * size_t(components + 1) * texels);
    parallelFor(texels, kNormalBlock, [&](size_t begin, size_t end) {
        const auto first = Eigen::Index(begin), count = Eigen::Index(end - begin);
        for (size_t colour = 0; colour < 3; ++colour) {
            const Eigen::Map<const RowMatrixXf> light(lightCosine.data() + colour * size_t(n2) * texels, n2,
                                                      Eigen::Index(texels));
            Eigen::Map<RowMatrixXf> out(table.data() + colour * size_t(components + 1) * texels,
                                        components + 1, Eigen::Index(texels));
            out.middleCols(first, count).noalias() = vectors * light.middleCols(first, count);
        }
    });
    return table;
}

std::vector<float> lookUpTable(std::span<const float> table, int layers, const TableLayout& layout,
                               const Vec3d& normal) {
    const auto texels = size_t(layout.texelCount());
    PRT_CHECK_EQ(table.size(), size_t(3) * size_t(layers) * texels);
    std::vector<float> values(size_t(3) * size_t(layers), 0.0f);
    for (const SphereTap& tap : layout.taps(normal))
        for (size_t layer = 0; layer < values.size(); ++layer)
            values[layer] += tap.weight * table[layer * texels + size_t(tap.texel)];
    return values;
}

std::vector<float> lookUpTable(std::span<const float> table, int layers, int size, const Vec3d& normal) {
    return lookUpTable(table, layers, TableLayout("cube", size), normal);
}

}  // namespace prt
