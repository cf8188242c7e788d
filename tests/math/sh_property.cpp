// Orthonormality, product and rotation against brute-force quadrature over many orders.
#include <cmath>

#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

TEST(ShOrthonormality, HoldsForAllPairsToTheLastBand) {
    constexpr size_t kCount = size_t(shCount(kMaxShOrder));
    std::vector<double> gram(kCount * kCount, 0.0), y(kCount);
    for (const SphereNode& node : sphereQuadrature(2 * (kMaxShOrder - 1))) {
        evalSh(kMaxShOrder, node.direction, std::span<double>(y));
        for (size_t i = 0; i < kCount; ++i)
            for (size_t j = 0; j <= i; ++j) gram[i * kCount + j] += node.weightSr * y[i] * y[j];
    }
    for (size_t i = 0; i < kCount; ++i)
        for (size_t j = 0; j <= i; ++j)
            ASSERT_NEAR(gram[i * kCount + j], i == j ? 1 : 0, 1e-13) << i << ' ' << j;
}

TEST(ShProductProperty, EqualsQuadratureForManyOrders) {
    test::RandomInput random(81);
    for (const int orderF : {1, 2, 3, 6, 10, 17, 24})
        for (const int orderG : {1, 3, 6, 12, 24})
            for (const int orderOut : {1, 4, 10, 24}) {
                const std::vector<float> f = random.coefficients<float>(shCount(orderF));
                const std::vector<float> g = random.coefficients<float>(shCount(orderG));
                const std::vector<float> product = shProduct(f, g, orderOut);
                const std::vector<double> expected = projectSh(
                    orderOut,
                    [&](const Vec3d& d) {
                        return evalShExpansion(orderF, f, d) * evalShExpansion(orderG, g, d);
                    },
                    orderF + orderG + orderOut - 3);
                ASSERT_EQ(product.size(), expected.size());
                double scale = 1;
                for (const double e : expected) scale = std::max(scale, std::abs(e));
                for (size_t i = 0; i < expected.size(); ++i)
                    ASSERT_NEAR(double(product[i]), expected[i], 1e-6 * scale)
                        << orderF << ' ' << orderG << ' ' << orderOut << ": " << i;
            }
}

TEST(ProductMatrixProperty, EqualsQuadratureEntryByEntry) {
    test::RandomInput random(82);
    for (const auto& [orderF, rows, columns] :
         {std::array{5, 3, 3}, {9, 6, 4}, {9, 4, 6}, {17, 12, 6}, {21, 12, 10}, {4, 6, 6}, {24, 3, 3}}) {
        const std::vector<float> f = random.coefficients<float>(shCount(orderF));
        const std::vector<float> matrix = productMatrix(f, rows, columns);
        const size_t r = size_t(shCount(rows)), c = size_t(shCount(columns));
        const int highest = std::max(rows, columns);
        std::vector<double> expected(r * c, 0.0), y(size_t(shCount(highest)));
        for (const SphereNode& node : sphereQuadrature(orderF + rows + columns - 3)) {
            evalSh(highest, node.direction, std::span<double>(y));
            const double value = node.weightSr * evalShExpansion(orderF, f, node.direction);
            for (size_t i = 0; i < r; ++i)
                for (size_t j = 0; j < c; ++j) expected[i * c + j] += value * y[i] * y[j];
        }
        ASSERT_EQ(matrix.size(), expected.size());
        for (size_t i = 0; i < matrix.size(); ++i) ASSERT_NEAR(double(matrix[i]), expected[i], 1e-5);
    }
}

TEST(ShRotationProperty, EqualsProjectingTheTurnedFunction) {
    test::RandomInput random(83);
    for (int n = 1; n <= kMaxShOrder; ++n)
        for (int k = 0; k < 4; ++k) {
            // the last one is a half turn about a horizontal axis, where the Euler angles degenerate
            const Mat3d r = k < 3 ? random.rotation()
                                  : Mat3d(Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d(0.6, 0.8, 0))
                                              .toRotationMatrix());
            const std::vector<float> c = random.coefficients<float>(shCount(n));
            std::vector<float> turned(c.size());
            rotateSh(r, n, std::span<const float>(c), std::span<float>(turned));
            const std::vector<double> expected = projectSh(
                n, [&](const Vec3d& d) { return evalShExpansion(n, c, r.transpose() * d); }, 2 * (n - 1));
            for (size_t i = 0; i < expected.size(); ++i)
                ASSERT_NEAR(double(turned[i]), expected[i], 1e-6) << n;
        }
}

}  // namespace
}  // namespace prt
