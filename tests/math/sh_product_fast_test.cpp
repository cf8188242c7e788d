// Products of one order: straight-line code, lanes and prebuilt matrices, against quadrature and plain sums.
#include <cmath>

#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sh_product_generated.h"
#include "tests/math/allocation_counter.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr float kGuard = 12345;

/// (f·g)_k by an exact quadrature of the definition.
template <typename T>
std::vector<double> quadratureProduct(int shOrder, const std::vector<T>& f, const std::vector<T>& g) {
    const size_t count = size_t(shCount(shOrder));
    std::vector<double> result(count, 0.0), y(count);
    for (const SphereNode& node : sphereQuadrature(3 * (shOrder - 1))) {
        evalSh(shOrder, node.direction, std::span<double>(y));
        double valueF = 0, valueG = 0;
        for (size_t i = 0; i < count; ++i) {
            valueF += double(f[i]) * y[i];
            valueG += double(g[i]) * y[i];
        }
        for (size_t i = 0; i < count; ++i) result[i] += node.weightSr * valueF * valueG * y[i];
    }
    return result;
}

template <typename T>
double norm(const std::vector<T>& v) {
    double sum = 0;
    for (const T x : v) sum += double(x) * double(x);
    return std::sqrt(sum);
}

/// What the header promises to 6 bands; errors of the table's floats add up as their number's root.
double tolerance(int shOrder) { return shOrder <= 6 ? 3e-6 : 3e-5; }

template <int N>
void expectCodeIsExactInDouble() {
    test::RandomInput random(45);
    for (int round = 0; round < 3; ++round) {
        const std::vector<double> f = random.coefficients<double>(N * N),
                                  g = random.coefficients<double>(N * N);
        std::vector<double> product(N * N);
        double* out = product.data();
        detail::ShProductCode<N>::template run<double>(f, g, out);
        const std::vector<double> expected = quadratureProduct(N, f, g);
        for (size_t i = 0; i < expected.size(); ++i)
            EXPECT_NEAR(product[i], expected[i], 1e-14 * norm(f) * norm(g)) << N << ": " << i;
    }
}

TEST(ShProductCode, IsExactInDouble) {
    expectCodeIsExactInDouble<1>();
    expectCodeIsExactInDouble<2>();
    expectCodeIsExactInDouble<3>();
    expectCodeIsExactInDouble<4>();
    expectCodeIsExactInDouble<5>();
    expectCodeIsExactInDouble<6>();
}

TEST(ShProductCode, EveryPairOfBasisFunctionsMultipliesToItsTriplingCoefficients) {
    std::vector<float> expected(36 * 36 * 36, 0.0f);
    for (const TriplingCoefficient& t : triplingCoefficients(6, 6, 6))
        expected[size_t(t.i * 36 + t.j) * 36 + t.k] = t.value;
    for (size_t i = 0; i < 36; ++i)
        for (size_t j = 0; j < 36; ++j) {
            std::vector<float> f(36, 0.0f), g(36, 0.0f), product(36);
            f[i] = g[j] = 1;
            shProduct(6, f, g, product);
            for (size_t k = 0; k < 36; ++k)
                ASSERT_NEAR(product[k], expected[(i * 36 + j) * 36 + k], 1e-7f) << i << ' ' << j << ' ' << k;
        }
}

TEST(ShProductInto, EqualsQuadratureAndWorksInPlace) {
    test::RandomInput random(46);
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 10, 24}) {
        const std::vector<float> f = random.coefficients<float>(shCount(n)),
                                 g = random.coefficients<float>(shCount(n));
        std::vector<float> product(f.size()), first = f, second = g;
        shProduct(n, f, g, product);
        const std::vector<double> expected = quadratureProduct(n, f, g);
        for (size_t i = 0; i < expected.size(); ++i)
            ASSERT_NEAR(double(product[i]), expected[i], tolerance(n) * norm(f) * norm(g)) << n << ": " << i;
        shProduct(n, first, g, first);
        shProduct(n, f, second, second);
        EXPECT_EQ(first, product) << n;
        EXPECT_EQ(second, product) << n;
    }
}

TEST(ShProductSoa, EqualsTheSingleProductForEveryOrderLengthAndStride) {
    test::RandomInput random(47);
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 10})
        for (const size_t count : {0u, 1u, 15u, 16u, 17u, 37u})
            for (const size_t gap : {0u, 3u}) {
                const size_t rows = size_t(shCount(n)), stride = count + gap;
                const size_t size = rows * stride - (count > 0 ? gap : 0);
                std::vector<float> f = random.coefficients<float>(int(size));
                const std::vector<float> g = random.coefficients<float>(int(size));
                std::vector<float> out(size, kGuard);
                shProductSoa(n, f, g, out, count, stride);
                for (size_t k = 0; k < count; ++k) {
                    std::vector<float> oneF(rows), oneG(rows), expected(rows);
                    for (size_t i = 0; i < rows; ++i) {
                        oneF[i] = f[i * stride + k];
                        oneG[i] = g[i * stride + k];
                    }
                    shProduct(n, oneF, oneG, expected);
                    for (size_t i = 0; i < rows; ++i)
                        ASSERT_NEAR(out[i * stride + k], expected[i], tolerance(n) * norm(oneF) * norm(oneG))
                            << n << ' ' << count << ' ' << i << ' ' << k;
                }
                for (size_t j = 0; j < size; ++j)
                    if (j % stride >= count) {
                        ASSERT_EQ(out[j], kGuard);
                        out[j] = f[j];
                    }
                shProductSoa(n, f, g, f, count, stride);
                ASSERT_EQ(f, out) << n << ' ' << count;
            }
}

TEST(ApplyProductMatrix, IsTheMatrixTimesTheVector) {
    test::RandomInput random(48);
    for (const auto& [rowsOrder, columnsOrder] : {std::array{1, 1},
                                                  {2, 2},
                                                  {3, 3},
                                                  {4, 4},
                                                  {5, 5},
                                                  {6, 6},
                                                  {10, 10},
                                                  {3, 6},
                                                  {6, 3},
                                                  {12, 5},
                                                  {1, 24}}) {
        const std::vector<float> f = random.coefficients<float>(shCount(6));
        const std::vector<float> matrix = productMatrix(f, rowsOrder, columnsOrder);
        const size_t rows = size_t(shCount(rowsOrder)), columns = size_t(shCount(columnsOrder));
        for (const size_t count : {1u, 16u, 21u}) {
            const size_t stride = count + 2;
            const std::vector<float> g = random.coefficients<float>(int(columns * stride));
            std::vector<float> out(rows * stride, kGuard), one(rows);
            applyProductMatrixSoa(matrix, rowsOrder, columnsOrder, g, out, count, stride);
            for (size_t k = 0; k < stride; ++k) {
                std::vector<float> oneG(columns);
                for (size_t c = 0; c < columns; ++c) oneG[c] = g[c * stride + k];
                applyProductMatrix(matrix, oneG, one);
                for (size_t r = 0; r < rows; ++r) {
                    double expected = 0, sumOfSizes = 0;
                    for (size_t c = 0; c < columns; ++c) {
                        const double term = double(matrix[r * columns + c]) * double(oneG[c]);
                        expected += term;
                        sumOfSizes += std::abs(term);
                    }
                    // Few terms are not zero; at most columns roundings of 2^-24 each. The symmetric path
                    // reads the transposed entry, which differs by one more.
                    const double bound = (double(columns) + 2) * 0x1p-24 * sumOfSizes + 1e-9;
                    ASSERT_NEAR(double(one[r]), expected, bound) << rowsOrder << ' ' << columnsOrder;
                    if (k < count)
                        ASSERT_NEAR(double(out[r * stride + k]), expected, bound)
                            << rowsOrder << ' ' << columnsOrder;
                    else
                        ASSERT_EQ(out[r * stride + k], kGuard);
                }
            }
        }
    }
}

TEST(ShProductCost, CountsWhatThePapersCount) {
    EXPECT_EQ(shProductNonZeros(3), 83);
    EXPECT_EQ(shProductNonZeros(4), 353);
    EXPECT_EQ(shProductNonZeros(5), 1158);
    EXPECT_EQ(shProductNonZeros(6), 2907);
    EXPECT_EQ(shProductCost(ShProductMethod::kTable, 6).multiplications, 2 * 2907);
    EXPECT_EQ(shProductCost(ShProductMethod::kTable, 3).additions, 83 - 9);
    EXPECT_EQ(shProductCost(ShProductMethod::kMatrix, 6).multiplications, 36 * 36);
    EXPECT_EQ(shProductCost(ShProductMethod::kMatrix, 2).additions, 12);
    EXPECT_EQ(shProductCost(ShProductMethod::kMatrixBuild, 6).multiplications, 2907);
    // f_0 g_0 c; every f_i g_i, two products with the scaled f_0 and g_0, and one of the sum
    EXPECT_EQ(shProductCost(ShProductMethod::kStraightLine, 1).multiplications, 2);
    EXPECT_EQ(shProductCost(ShProductMethod::kStraightLine, 2).multiplications, 3 + 3 * 3 + 1);
    EXPECT_EQ(shProductCost(ShProductMethod::kStraightLine, 2).additions, 3 + 2 + 1);
    for (int n = 3; n <= kMaxProductCodeOrder; ++n) {
        const ShProductCost code = shProductCost(ShProductMethod::kStraightLine, n);
        const ShProductCost table = shProductCost(ShProductMethod::kTable, n);
        EXPECT_LT(code.multiplications + code.additions, table.multiplications + table.additions) << n;
    }
    EXPECT_EQ(detail::ShProductCode<6>::kNonZeros, 2907);
}

TEST(ShAllocations, EvaluationAndProductsMakeNone) {
    test::RandomInput random(49);
    const size_t count = 37;
    std::vector<Vec3f> directions;
    std::vector<float> axes[3];
    for (size_t k = 0; k < count; ++k) {
        directions.push_back(random.direction().cast<float>());
        for (int a = 0; a < 3; ++a) axes[a].push_back(directions.back()[a]);
    }
    for (const int n : {3, 6, 10, 12}) {
        const size_t rows = size_t(shCount(n));
        std::vector<float> f = random.coefficients<float>(int(rows * count)), g = f, out(rows * count);
        const auto one = [&](std::vector<float>& v) { return std::span(v).first(rows); };
        const std::vector<float> matrix = productMatrix(one(f), n, n);
        triplingCoefficients(n, n, n);
        EXPECT_EQ(test::allocationsOf([&] {
                      evalSh(n, directions[0], one(out));
                      evalShBatch(n, directions, out);
                      evalShSoa(n, axes[0], axes[1], axes[2], out, count);
                      shProduct(n, one(f), one(g), one(out));
                      shProductSoa(n, f, g, out, count, count);
                      applyProductMatrix(matrix, one(g), one(out));
                      applyProductMatrixSoa(matrix, n, n, g, out, count, count);
                  }),
                  0u)
            << n;
    }
    EXPECT_GT(test::allocationsOf([&] { std::vector<float>(10, 1.0f).swap(axes[0]); }), 0u);
}

TEST(ShProductFastDeathTest, RefusesLengthsThatDoNotFit) {
    std::vector<float> nine(9), ten(10), many(9 * 4);
    EXPECT_DEATH(shProduct(3, nine, ten, nine), "10 against 9");
    EXPECT_DEATH(shProduct(25, nine, nine, nine), "25 against 24");
    EXPECT_DEATH(shProductSoa(3, many, many, many, 5, 4), "5 against 4");
    EXPECT_DEATH(shProductSoa(3, many, many, nine, 4, 4), "36 against 9");
    EXPECT_DEATH(applyProductMatrix(many, nine, nine), "36 against 81");
    EXPECT_DEATH(applyProductMatrixSoa(many, 3, 2, many, nine, 4, 4), "36 against 9");
    EXPECT_DEATH(shProductCost(ShProductMethod::kStraightLine, 7), "7 against 6");
}

}  // namespace
}  // namespace prt
