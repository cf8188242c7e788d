// Tripling coefficients, products and product matrices.
#include "precompute/math/sh_product.h"

#include <cmath>
#include <numbers>
#include <thread>
#include <tuple>

#include "precompute/math/sh.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

/// ∫ Y_i Y_j Y_k for all i, j, k of the orders by quadrature, [k][i][j].
std::vector<double> denseTripling(int orderI, int orderJ, int orderK) {
    const size_t ni = size_t(shCount(orderI)), nj = size_t(shCount(orderJ)), nk = size_t(shCount(orderK));
    const int highest = std::max({orderI, orderJ, orderK});
    std::vector<double> y(size_t(shCount(highest))), result(ni * nj * nk, 0.0);
    for (const SphereNode& node : sphereQuadrature(orderI + orderJ + orderK - 3)) {
        evalSh(highest, node.direction, std::span<double>(y));
        for (size_t k = 0; k < nk; ++k)
            for (size_t i = 0; i < ni; ++i)
                for (size_t j = 0; j < nj; ++j)
                    result[(k * ni + i) * nj + j] += node.weightSr * y[k] * y[i] * y[j];
    }
    return result;
}

class TriplingOrders : public testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(TriplingOrders, AreExactlyTheNonZeroIntegralsInOrder) {
    const auto [orderI, orderJ, orderK] = GetParam();
    std::vector<double> dense = denseTripling(orderI, orderJ, orderK);
    const size_t ni = size_t(shCount(orderI)), nj = size_t(shCount(orderJ));
    std::tuple<int, int, int> previous{-1, -1, -1};
    for (const TriplingCoefficient& t : triplingCoefficients(orderI, orderJ, orderK)) {
        const std::tuple<int, int, int> key{t.k, t.i, t.j};
        ASSERT_LT(previous, key);
        previous = key;
        double& expected = dense[(t.k * ni + t.i) * nj + t.j];
        EXPECT_NEAR(double(t.value), expected, 1e-7);
        EXPECT_GT(std::abs(expected), 1e-11);
        expected = 0;
    }
    for (const double left : dense) EXPECT_NEAR(left, 0, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(All, TriplingOrders,
                         testing::Values(std::tuple{1, 1, 1}, std::tuple{3, 3, 3}, std::tuple{4, 4, 7},
                                         std::tuple{2, 5, 3}, std::tuple{5, 2, 6}, std::tuple{1, 6, 6},
                                         std::tuple{6, 6, 6}, std::tuple{10, 3, 8}));

TEST(Tripling, CountsAreThePublishedOnes) {
    EXPECT_EQ(triplingCoefficients(3, 3, 3).size(), 83u);
    EXPECT_EQ(triplingCoefficients(4, 4, 4).size(), 353u);
    EXPECT_EQ(triplingCoefficients(5, 5, 5).size(), 1158u);
    EXPECT_EQ(triplingCoefficients(6, 6, 6).size(), 2907u);
}

TEST(Tripling, FirstUseFromManyThreadsGivesOneTable) {
    std::vector<const std::vector<TriplingCoefficient>*> seen(8);
    std::vector<std::thread> threads;
    for (size_t k = 0; k < seen.size(); ++k)
        threads.emplace_back([&, k] { seen[k] = &triplingCoefficients(7, 9, 8); });
    for (std::thread& thread : threads) thread.join();
    for (const auto* table : seen) EXPECT_EQ(table, seen[0]);
    EXPECT_EQ(&triplingCoefficients(7, 9, 8), seen[0]);
}

TEST(ShProduct, WithOneChangesNothing) {
    test::RandomInput random(41);
    const std::vector<float> f = random.coefficients<float>(100);
    const std::vector<float> one = {float(std::sqrt(4 * std::numbers::pi))};
    const std::vector<float> product = shProduct(f, one, 10);
    for (size_t i = 0; i < 100; ++i) EXPECT_NEAR(product[i], f[i], 1e-6f);
    const std::vector<float> shorter = shProduct(one, f, 4);
    ASSERT_EQ(shorter.size(), 16u);
    for (size_t i = 0; i < 16; ++i) EXPECT_NEAR(shorter[i], f[i], 1e-6f);
}

TEST(ShProduct, Commutes) {
    test::RandomInput random(42);
    const std::vector<float> f = random.coefficients<float>(36), g = random.coefficients<float>(64);
    const std::vector<float> fg = shProduct(f, g, 9), gf = shProduct(g, f, 9);
    for (size_t i = 0; i < fg.size(); ++i) EXPECT_NEAR(fg[i], gf[i], 1e-6f);
}

TEST(ProductMatrix, AppliedIsTheProductAndItsTransposeTheOther) {
    test::RandomInput random(43);
    const std::vector<float> f = random.coefficients<float>(shCount(15)), g = random.coefficients<float>(100);
    const std::vector<float> matrix = productMatrix(f, 6, 10), transposed = productMatrix(f, 10, 6);
    const std::vector<float> product = shProduct(f, g, 6);
    ASSERT_EQ(matrix.size(), 3600u);
    for (size_t r = 0; r < 36; ++r) {
        double sum = 0;
        for (size_t c = 0; c < 100; ++c) {
            sum += double(matrix[r * 100 + c]) * double(g[c]);
            EXPECT_NEAR(matrix[r * 100 + c], transposed[c * 36 + r], 1e-6f);
        }
        EXPECT_NEAR(sum, double(product[r]), 1e-5);
    }
}

TEST(ProductMatrix, BandsThatCannotReachItAreIgnored) {
    test::RandomInput random(44);
    std::vector<float> f = random.coefficients<float>(shCount(kMaxShOrder));
    const std::vector<float> a = productMatrix(f, 4, 3);
    f.resize(size_t(shCount(6)));
    EXPECT_EQ(productMatrix(f, 4, 3), a);
    f.resize(size_t(shCount(2)));
    EXPECT_NE(productMatrix(f, 4, 3), a);
}

TEST(ProductMatrixDeathTest, RefusesALengthThatIsNoSquare) {
    const std::vector<float> f(7);
    EXPECT_DEATH(productMatrix(f, 3, 3), "0 against 0");
}

}  // namespace
}  // namespace prt
