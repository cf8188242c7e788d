// Conversion matrices against the tables of the errata, closed forms of the papers, brute quadrature and
// projection.
#include "precompute/math/basis_conversion.h"

#include <cmath>
#include <numbers>

#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "tests/math/basis_reference.h"

namespace prt {
namespace {

using test::evaluate;

std::vector<double> apply(const std::vector<double>& matrix, const std::vector<double>& v) {
    std::vector<double> result(matrix.size() / v.size(), 0.0);
    for (size_t i = 0; i < result.size(); ++i)
        for (size_t j = 0; j < v.size(); ++j) result[i] += matrix[i * v.size() + j] * v[j];
    return result;
}

/// ∫_{z≥0} B_i Y_j by Gauss-Legendre in z, whose error on √z falls with the cube of the nodes, and midpoints.
std::vector<double> bruteMatrix(const Basis& basis, int shOrder) {
    const size_t rows = size_t(basis.count()), columns = size_t(shCount(shOrder));
    std::vector<double> matrix(rows * columns, 0.0), y(columns);
    const int steps = 2 * std::max(basis.order(), shOrder);
    for (const LineNode& node : gaussLegendre(400))
        for (int k = 0; k < steps; ++k) {
            const Vec3d d = test::directionOf((node.z + 1) / 2, 2 * std::numbers::pi * (k + 0.25) / steps);
            const std::vector<double> b = evaluate(basis, d);
            evalSh(shOrder, d, std::span<double>(y));
            for (size_t i = 0; i < rows; ++i)
                for (size_t j = 0; j < columns; ++j)
                    matrix[i * columns + j] += node.weight * std::numbers::pi / steps * b[i] * y[j];
        }
    return matrix;
}

void expectMatrix(const std::vector<double>& matrix, const std::vector<double>& expected, double tolerance) {
    ASSERT_EQ(matrix.size(), expected.size());
    for (size_t i = 0; i < matrix.size(); ++i) EXPECT_NEAR(matrix[i], expected[i], tolerance) << i;
}

TEST(ShToH, IsTheTableOfTheErrata) {
    const double a = 0.7071, b = 0.6124, c = 0.5929, d = 0.3536, e = 0.6847;
    expectMatrix(shToHMatrix(3), {a, 0, b, 0, 0, 0, 0, 0, 0,  //
                                  0, a, 0, 0, 0, c, 0, 0, 0,  //
                                  0, 0, d, 0, 0, 0, e, 0, 0,  //
                                  0, 0, 0, a, 0, 0, 0, c, 0,  //
                                  0, 0, 0, 0, a, 0, 0, 0, 0,  //
                                  0, 0, 0, 0, 0, 0, 0, 0, a},
                 5e-5);
}

TEST(ShToH, HasTheClosedFormOfTheFifthBand) {
    // [HabelWimmer2010, Eq. 17]
    const std::vector<double> matrix = shToHMatrix(5);
    for (int row = 0; row < 6; ++row)
        for (int m = -4; m <= 4; ++m) {
            double expected = 0;
            if ((row == 1 && m == -1) || (row == 3 && m == 1)) expected = -std::sqrt(15.0) / 16;
            if (row == 2 && m == 0) expected = -std::sqrt(1.5) / 8;
            EXPECT_NEAR(matrix[size_t(row * 25 + shIndex(4, m))], expected, 4e-15) << row << ' ' << m;
        }
}

TEST(ShToH, EqualsBruteQuadratureAndProjection) {
    const std::unique_ptr<Basis> h = makeBasis("h", 3);
    for (const int shOrder : {1, 2, 3, 7, 24}) {
        const std::vector<double> matrix = shToHMatrix(shOrder);
        if (shOrder < 8) expectMatrix(matrix, bruteMatrix(*h, shOrder), 1e-12);
        test::RandomInput random(51);
        const std::unique_ptr<Basis> sh = makeBasis("sh", shOrder);
        const std::vector<double> c = random.coefficients<double>(sh->count());
        expectMatrix(apply(matrix, c),
                     h->project([&](const Vec3d& d) { return sh->evalExpansion(c, d); }, 2 + shOrder), 1e-12);
    }
}

TEST(ShToHsh, IsTheTableOfTheErrata) {
    std::vector<double> expected(81, 0.0);
    const auto set = [&](int l, int m, int band, double value) {
        expected[size_t(shIndex(l, m) * 9 + shIndex(band, m))] = value;
    };
    set(0, 0, 0, 0.71), set(0, 0, 1, 0.61), set(1, 0, 1, 0.35), set(1, 0, 2, 0.68), set(2, 0, 2, 0.18);
    for (const int m : {-1, 1}) {
        set(1, m, 1, 0.67), set(1, m, 2, 0.67), set(2, m, 1, -0.16), set(2, m, 2, 0.21);
        set(2, 2 * m, 2, 0.62);
    }
    expectMatrix(shToHshMatrix(3, 3), expected, 5.5e-3);
}

TEST(ShToHsh, HasClosedForms) {
    // rows 0 and 2 are functions of the H-basis too
    const std::vector<double> hsh = shToHshMatrix(2, 9), h = shToHMatrix(9);
    for (size_t j = 0; j < 81; ++j) {
        EXPECT_NEAR(hsh[j], h[j], 4e-15);
        EXPECT_NEAR(hsh[2 * 81 + j], h[2 * 81 + j], 4e-15);
    }
    EXPECT_NEAR(hsh[0], std::numbers::sqrt2 / 2, 4e-15);
    EXPECT_NEAR(hsh[2], std::sqrt(6.0) / 4, 4e-15);
}

TEST(ShToHsh, EqualsBruteQuadratureForAnyTwoOrders) {
    for (const auto& [hshOrder, shOrder] : {std::pair(1, 1), {1, 6}, {6, 1}, {3, 3}, {4, 7}, {7, 4}})
        expectMatrix(shToHshMatrix(hshOrder, shOrder), bruteMatrix(*makeBasis("hsh", hshOrder), shOrder),
                     1e-6);
}

TEST(ShToHsh, EqualsProjectingTheExpansion) {
    test::RandomInput random(52);
    for (const int hshOrder : {1, 2, 5, 10, 24})
        for (const int shOrder : {1, 3, 10, 24}) {
            const std::unique_ptr<Basis> hsh = makeBasis("hsh", hshOrder), sh = makeBasis("sh", shOrder);
            const std::vector<double> c = random.coefficients<double>(sh->count());
            const std::vector<double> matrix = shToHshMatrix(hshOrder, shOrder);
            ASSERT_EQ(matrix.size(), size_t(hsh->count() * sh->count()));
            expectMatrix(apply(matrix, c),
                         hsh->project([&](const Vec3d& d) { return sh->evalExpansion(c, d); },
                                      hshOrder + shOrder + 30),
                         1e-12);
        }
}

TEST(ShToHsh, ConvergesInItsNodes) {
    // H_i Y_j against the sum that twice as many nodes give: m odd, where the integrand is no polynomial
    for (const int m : {1, 13, 23}) {
        const int l = 23, order = 24;
        double fine = 0;
        for (const LineNode& node : gaussLegendre(400)) {
            const double t = (node.z + 1) / 2, z = t * t;
            std::vector<double> shifted(size_t(legendreCount(order))), plain(shifted.size());
            evalShLegendre(order, 2 * z - 1, shifted);
            evalShLegendre(order, z, plain);
            const size_t i = size_t(legendreIndex(l, m));
            fine += node.weight * t * std::numbers::pi * std::numbers::sqrt2 * shifted[i] * plain[i];
        }
        EXPECT_NEAR(shToHshMatrix(order, order)[size_t(shIndex(l, m) * shCount(order) + shIndex(l, m))], fine,
                    1e-13);
    }
}

TEST(ShToHsh, CouplesOnlyEqualM) {
    const std::vector<double> matrix = shToHshMatrix(5, 7);
    double others = 0;
    for (int l = 0; l < 5; ++l)
        for (int m = -l; m <= l; ++m)
            for (int k = 0; k < 7; ++k)
                for (int q = -k; q <= k; ++q)
                    others += m == q ? 0 : std::abs(matrix[size_t(shIndex(l, m) * 49 + shIndex(k, q))]);
    EXPECT_EQ(others, 0);
}

TEST(ShToHsh, TransposeContinuesByZero) {
    // Through more and more spherical harmonics and back nothing is lost: C Cᵀ tends to unity.
    double before = 1;
    for (const int shOrder : {4, 8, 16, 24}) {
        const std::vector<double> matrix = shToHshMatrix(3, shOrder);
        const size_t columns = size_t(shCount(shOrder));
        double worst = 0;
        for (size_t i = 0; i < 9; ++i)
            for (size_t k = 0; k < 9; ++k) {
                double sum = 0;
                for (size_t j = 0; j < columns; ++j) sum += matrix[i * columns + j] * matrix[k * columns + j];
                worst = std::max(worst, std::abs(sum - (i == k ? 1 : 0)));
            }
        EXPECT_LT(worst, 0.8 * before) << shOrder;
        before = worst;
    }
    EXPECT_LT(before, 0.1);
}

TEST(ConversionDeath, OrdersOutOfRangeAbort) {
    EXPECT_DEATH(shToHMatrix(0), "");
    EXPECT_DEATH(shToHMatrix(25), "");
    EXPECT_DEATH(shToHshMatrix(0, 3), "");
    EXPECT_DEATH(shToHshMatrix(3, 25), "");
}

}  // namespace
}  // namespace prt
