// Tables against exact quadrature, and the properties every table must have.
#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "compress/tables/normal_tables.h"
#include "precompute/base/parallel.h"
#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"
#include "precompute/math/sphere_map.h"
#include "tests/base/sanitized.h"
#include "tests/compress/table_lights.h"

namespace prt {
namespace {

// Gauss-Legendre on [0, 1], by Newton's iteration.
std::vector<std::array<double, 2>> gaussLegendreUnit(int count) {
    std::vector<std::array<double, 2>> nodes;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 0;
        for (int step = 0; step < 50; ++step) {
            double p0 = 1, p1 = x;
            for (int k = 2; k <= count; ++k) {
                const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = count * (x * p1 - p0) / (x * x - 1);
            x -= p1 / slope;
        }
        nodes.push_back({(x + 1) / 2, 1 / ((1 - x * x) * slope * slope)});
    }
    return nodes;
}

// ∫ L max(0, n·ω) Y_i over the hemisphere about n, in whose frame the integrand is a polynomial: exact for an
// L of up to 24 bands and n <= 10.
std::vector<double> quadrature(std::span<const float> light, int lightOrder, int shOrder,
                               const Vec3d& normal) {
    static const auto heights = gaussLegendreUnit(20);
    constexpr int kAzimuths = 40;
    const Vec3d tangent = normal.unitOrthogonal(), bitangent = normal.cross(tangent);
    std::vector<double> result(size_t(shCount(shOrder)), 0.0),
        y(size_t(shCount(std::max(lightOrder, shOrder))));
    for (const auto& [z, weight] : heights)
        for (int a = 0; a < kAzimuths; ++a) {
            const double phi = 2 * std::numbers::pi * a / kAzimuths, r = std::sqrt(1 - z * z);
            const Vec3d direction = r * std::cos(phi) * tangent + r * std::sin(phi) * bitangent + z * normal;
            evalSh(std::max(lightOrder, shOrder), direction, y);
            double radiance = 0;
            for (int i = 0; i < shCount(lightOrder); ++i) radiance += double(light[size_t(i)]) * y[size_t(i)];
            const double factor = radiance * z * weight * 2 * std::numbers::pi / kAzimuths;
            for (size_t i = 0; i < result.size(); ++i) result[i] += factor * y[i];
        }
    return result;
}

// What a cosine of so few bands leaves out of each R_i, at most:
// Σ_l |A_l| √((2l+1)/4π) |(L·Y_i)_l| over the bands beyond.
std::vector<double> truncationBounds(std::span<const float> light, int shOrder, int cosineBands) {
    const size_t n2 = size_t(shCount(shOrder));
    const std::vector<float> products = productMatrix(light, kMaxShOrder, shOrder);  // columns: L·Y_i
    std::vector<double> bounds(n2, 0.0);
    for (size_t i = 0; i < n2; ++i)
        for (int band = cosineBands; band < kMaxShOrder; ++band) {
            double square = 0;
            for (int m = -band; m <= band; ++m)
                square += std::pow(double(products[size_t(shIndex(band, m)) * n2 + i]), 2);
            bounds[i] += std::abs(clampedCosineBand(band)) *
                         std::sqrt((2 * band + 1) / (4 * std::numbers::pi) * square);
        }
    return bounds;
}

class LightCosine : public testing::TestWithParam<int> {};

TEST_P(LightCosine, EqualsQuadratureWhereTheCosineHasAllBands) {
    // Bands of L·Y_i end at 12, where the cosine's next one (13) is zero.
    const int shOrder = GetParam(), lightOrder = 14 - shOrder;
    const EnvironmentSh light = randomLight(lightOrder, tableEnvironmentShOrder(shOrder, 13), 1);
    std::mt19937 random(2);
    std::vector<Vec3f> normals;
    for (int k = 0; k < 40; ++k) normals.push_back(randomDirection(random).cast<float>());
    for (const Vec3f& axis : {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(0, 1, 0), Vec3f(-1, 0, 0)})
        normals.push_back(axis);
    const std::vector<float> values = evalLightCosine(light, shOrder, normals, 13);
    const size_t n2 = size_t(shCount(shOrder));
    ASSERT_EQ(values.size(), 3 * n2 * normals.size());
    const double scale = largest(values);
    for (size_t k = 0; k < normals.size(); ++k)
        for (size_t colour = 0; colour < 3; ++colour) {
            const Vec3d normal = normals[k].cast<double>().normalized();
            const std::vector<double> expected = quadrature(light.rgb[colour], lightOrder, shOrder, normal);
            for (size_t i = 0; i < n2; ++i)
                ASSERT_NEAR(values[(colour * n2 + i) * normals.size() + k], expected[i], 3e-6 * scale)
                    << "coefficient " << i << " normal " << normal.transpose();
        }
}
INSTANTIATE_TEST_SUITE_P(ShOrder, LightCosine, testing::Range(1, 11));

TEST(LightCosineTable, ConstantAndSingleFunctionLights) {
    // 1 + ½ Y_lm for every l, m of the order that order 6 takes in, at the texels of a cube of odd size.
    const int shOrder = 6, lightOrder = tableEnvironmentShOrder(shOrder), size = 3;
    for (int i = 0; i < shCount(lightOrder); ++i) {
        const EnvironmentSh light = basisLight(i, lightOrder);
        const std::vector<float> table = buildLightCosineTable(light, shOrder, size);
        ASSERT_EQ(table.size(), size_t(3 * 36 * 54));
        const std::vector<double> bounds = truncationBounds(light.rgb[0], shOrder, kTableCosineBands);
        for (const int texel : {0, 17, 31, 53}) {
            const Vec3d normal =
                cubeTexelDirection(texel / 9, texel % 3, texel / 3 % 3, size).cast<double>().normalized();
            const std::vector<double> expected = quadrature(light.rgb[0], lightOrder, shOrder, normal);
            for (int c = 0; c < 36; ++c) {
                ASSERT_NEAR(table[size_t(c * 54 + texel)], expected[size_t(c)], bounds[size_t(c)] + 1e-5)
                    << "light " << i << " coefficient " << c << " texel " << texel;
                ASSERT_EQ(table[size_t(c * 54 + texel)], table[size_t((36 + c) * 54 + texel)]);
                ASSERT_EQ(table[size_t(c * 54 + texel)], table[size_t((72 + c) * 54 + texel)]);
            }
        }
    }
}

TEST(LightCosineTable, UniformLightGivesTheCosineItself) {
    // R_i = A_l Y_i(n) for L = 1, and irradiance π of an open point: Σ_i V_i R_i with V = √4π δ_i0.
    const int size = 8;
    const std::vector<float> table =
        buildLightCosineTable(basisLight(0, tableEnvironmentShOrder(4)), 4, size);
    std::vector<double> y(16);
    for (size_t texel = 0; texel < 384; ++texel) {
        const Vec3d normal = cubeTexelDirection(int(texel) / 64, int(texel) % 8, int(texel) / 8 % 8, size)
                                 .cast<double>()
                                 .normalized();
        evalSh(4, normal, y);
        for (int band = 0; band < 4; ++band)
            for (int m = -band; m <= band; ++m) {
                const size_t i = size_t(shIndex(band, m));
                EXPECT_NEAR(table[i * 384 + texel], clampedCosineBand(band) * y[i], 2e-6);
            }
        EXPECT_NEAR(std::sqrt(4 * std::numbers::pi) * double(table[texel]), std::numbers::pi, 1e-5);
    }
}

TEST(LightCosineTable, CosineBandsBeyondTheDefaultAreSmall) {
    const int shOrder = 6, most = kMaxShOrder - shOrder + 1;
    for (const double sun : {0.0, 300.0}) {
        const EnvironmentSh light = skyLight(kMaxShOrder, sun);
        const std::vector<float> all = buildLightCosineTable(light, shOrder, 9, most);
        double square = 0;
        for (const float value : all) square += double(value) * double(value);
        double previous = 1;
        for (const int bands : {2, 3, 5, 7, 9, 11, kTableCosineBands + 1}) {
            const std::vector<float> table = buildLightCosineTable(light, shOrder, 9, bands);
            double error = 0;
            for (size_t k = 0; k < all.size(); ++k) error += std::pow(double(table[k] - all[k]), 2);
            EXPECT_LT(error / square, previous) << bands << " bands";
            previous = error / square;
        }
        const std::vector<float> table = buildLightCosineTable(light, shOrder, 9);
        double error = 0;
        for (size_t colour = 0; colour < 3; ++colour) {
            const std::vector<double> bounds =
                truncationBounds(light.rgb[colour], shOrder, kTableCosineBands);
            for (size_t k = 0; k < 36 * 486; ++k) {
                const double difference = double(table[colour * 36 * 486 + k] - all[colour * 36 * 486 + k]);
                ASSERT_LE(std::abs(difference), bounds[k / 486] + 1e-6);
                error += difference * difference;
            }
        }
        std::printf("sun of radiance %3.0f: cosine of %d bands against %d, relative RMS %.2e\n", sun,
                    kTableCosineBands, most, std::sqrt(error / square));
    }
}

TEST(LightCosineTable, LinearInTheLight) {
    const int order = tableEnvironmentShOrder(5), size = 5;
    const EnvironmentSh a = randomLight(order, order, 3), b = randomLight(order, order, 4);
    const EnvironmentSh sum = blendEnvironments(std::array{a, b}, std::array{0.3, -1.7});
    const std::vector<float> tableA = buildLightCosineTable(a, 5, size),
                             tableB = buildLightCosineTable(b, 5, size),
                             tableSum = buildLightCosineTable(sum, 5, size);
    const double scale = largest(tableA) + largest(tableB);
    for (size_t k = 0; k < tableSum.size(); ++k)
        ASSERT_NEAR(tableSum[k], 0.3 * double(tableA[k]) - 1.7 * double(tableB[k]), 1e-6 * scale);
}

TEST(LightCosineTable, MoreBandsOfLightThanNeededChangeNothing) {
    const EnvironmentSh wide = randomLight(kMaxShOrder, kMaxShOrder, 5);
    EnvironmentSh narrow = wide;
    narrow.shOrder = tableEnvironmentShOrder(3);
    for (std::vector<float>& colour : narrow.rgb) colour.resize(size_t(shCount(narrow.shOrder)));
    EXPECT_EQ(buildLightCosineTable(wide, 3, 4), buildLightCosineTable(narrow, 3, 4));
}

TEST(LightCosineTable, DoesNotDependOnThreads) {
    const EnvironmentSh light = skyLight(tableEnvironmentShOrder(6));
    const std::vector<float> all = buildLightCosineTable(light, 6, 17);
    setThreadCount(1);
    EXPECT_EQ(buildLightCosineTable(light, 6, 17), all);
    setThreadCount(0);
}

TEST(LightCosineTable, EverySizeHasItsTexelsAtTheirCentres) {
    const EnvironmentSh light = skyLight(tableEnvironmentShOrder(3));
    for (const int size : {1, 2, 3, 7, 16}) {
        const std::vector<float> table = buildLightCosineTable(light, 3, size);
        const size_t texels = size_t(6 * size * size);
        ASSERT_EQ(table.size(), 27 * texels);
        const double scale = largest(table);
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const Vec3d normal = cubeDirection({face, x + 0.5, y + 0.5}, size);
                    const std::vector<float> exact =
                        evalLightCosine(light, 3, std::array{Vec3f(normal.cast<float>())});
                    const std::vector<float> found = lookUpTable(table, 9, size, normal);
                    for (size_t layer = 0; layer < 27; ++layer) {
                        const size_t texel = size_t((face * size + y) * size + x);
                        ASSERT_NEAR(table[layer * texels + texel], exact[layer], 1e-6 * scale);
                        // At a texel centre the lookup returns the texel; a cube of one texel per face too.
                        ASSERT_NEAR(found[layer], exact[layer], 2e-6 * scale);
                    }
                }
    }
}

TEST(TripleProductTable, EqualsTheSumOverTheBasis) {
    const int shOrder = 4, size = 5, components = 3;
    const size_t texels = 150;
    const EnvironmentSh light = randomLight(15, 15, 6);
    const std::vector<float> lightCosine = buildLightCosineTable(light, shOrder, size);
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    std::vector<float> mean(16), basis(16 * components);
    for (float& value : mean) value = normal(random);
    for (float& value : basis) value = normal(random);
    const std::vector<float> table = buildTripleProductTable(lightCosine, shOrder, size, mean, basis);
    ASSERT_EQ(table.size(), 3 * (components + 1) * texels);
    for (size_t colour = 0; colour < 3; ++colour)
        for (size_t m = 0; m <= components; ++m)
            for (size_t texel = 0; texel < texels; ++texel) {
                double expected = 0, magnitude = 0;
                for (size_t i = 0; i < 16; ++i) {
                    const double b = m == components ? mean[i] : basis[m * 16 + i];
                    const double term = b * double(lightCosine[(colour * 16 + i) * texels + texel]);
                    expected += term;
                    magnitude += std::abs(term);
                }
                ASSERT_NEAR(table[(colour * (components + 1) + m) * texels + texel], expected,
                            1e-6 * magnitude);
            }
}

TEST(TripleProductTable, FullBasisLightsAsTheCoefficientsThemselves) {
    const int shOrder = 6, size = 8;
    const EnvironmentSh light = skyLight(tableEnvironmentShOrder(shOrder));
    const std::vector<float> lightCosine = buildLightCosineTable(light, shOrder, size);
    std::mt19937 random(8);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd axes(36, 36);
    for (double& value : axes.reshaped()) value = normal(random);
    for (int k = 0; k < 36; ++k) {
        for (int pass = 0; pass < 2; ++pass)
            for (int j = 0; j < k; ++j) axes.col(k) -= axes.col(j).dot(axes.col(k)) * axes.col(j);
        axes.col(k).normalize();
    }
    const Eigen::MatrixXf basis = axes.cast<float>();  // columns: rows of the basis
    Eigen::VectorXf mean(36), visibility(36);
    for (float& value : mean) value = float(normal(random));
    for (float& value : visibility) value = float(normal(random));
    const Eigen::VectorXf weights = basis.transpose() * (visibility - mean);
    const std::vector<float> triple = buildTripleProductTable(lightCosine, shOrder, size, {mean.data(), 36},
                                                              {basis.data(), size_t(basis.size())});
    double scale = 0, error = 0;
    for (int k = 0; k < 500; ++k) {
        const Vec3d direction = randomDirection(random);
        const std::vector<float> full = lookUpTable(lightCosine, 36, size, direction),
                                 reduced = lookUpTable(triple, 37, size, direction);
        for (size_t colour = 0; colour < 3; ++colour) {
            double a = 0, b = reduced[colour * 37 + 36];
            for (size_t i = 0; i < 36; ++i) {
                a += double(visibility[Eigen::Index(i)]) * full[colour * 36 + i];
                b += double(weights[Eigen::Index(i)]) * reduced[colour * 37 + i];
            }
            scale = std::max(scale, std::abs(a));
            error = std::max(error, std::abs(a - b));
        }
    }
    EXPECT_LT(error, 1e-5 * scale);
}

TEST(TripleProductTable, MeanAlone) {
    const std::vector<float> lightCosine = buildLightCosineTable(basisLight(0, 12), 1, 2);
    const std::vector<float> table = buildTripleProductTable(lightCosine, 1, 2, std::array{2.0f}, {});
    ASSERT_EQ(table.size(), lightCosine.size());
    for (size_t k = 0; k < table.size(); ++k) EXPECT_EQ(table[k], 2 * lightCosine[k]);
}

TEST(LookUp, NoJumpAcrossEdgesOfTheCube) {
    // Both sides of each edge, 1e-7 off it: the table changes by at most a few times that over such a step.
    const EnvironmentSh light = skyLight(tableEnvironmentShOrder(6));
    for (const int size : {1, 2, 5, 32}) {
        const std::vector<float> table = buildLightCosineTable(light, 6, size);
        const double scale = largest(table);
        double jump = 0;
        std::mt19937 random(9);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (int k = 0; k < 3000; ++k) {
            // |a| = |b| > |c| for axes a, b of the cube.
            const int a = k % 3, b = (a + 1 + k / 3 % 2) % 3;
            Vec3d edge(uniform(random), uniform(random), uniform(random));
            if (k % 10 == 0) edge *= 0.9999999 / edge.cwiseAbs().maxCoeff();  // at corners
            edge[a] = edge[a] < 0 ? -1 : 1;
            edge[b] = edge[b] < 0 ? -1 : 1;
            Vec3d first = edge, second = edge;
            first[a] *= 1 + 1e-7;
            second[b] *= 1 + 1e-7;
            ASSERT_NE(cubePointFromDirection(first, size).face, cubePointFromDirection(second, size).face);
            const std::vector<float> u = lookUpTable(table, 36, size, first.normalized()),
                                     v = lookUpTable(table, 36, size, second.normalized());
            for (size_t layer = 0; layer < u.size(); ++layer)
                jump = std::max(jump, std::abs(double(u[layer]) - double(v[layer])) / scale);
        }
        std::printf("size %2d: largest jump across an edge %.1e of the table's maximum\n", size, jump);
        EXPECT_LT(jump, 1e-4) << "size " << size;
    }
}

constexpr size_t kLookUps = test::kSanitized ? 50000 : 1000000;

// Relative RMS of all coefficients of one colour, looked up in tables of several sizes.
std::vector<double> lookUpErrors(const EnvironmentSh& light, int shOrder, std::span<const int> sizes) {
    const size_t n2 = size_t(shCount(shOrder)), block = 2000;
    std::vector<std::vector<float>> tables;  // [texel][n²], the order that is quick to gather from
    for (const int size : sizes) {
        const std::vector<float> table = buildLightCosineTable(light, shOrder, size);
        const size_t texels = size_t(6 * size * size);
        std::vector<float> gathered(texels * n2);
        for (size_t i = 0; i < n2; ++i)
            for (size_t t = 0; t < texels; ++t) gathered[t * n2 + i] = table[i * texels + t];
        tables.push_back(std::move(gathered));
    }
    std::vector<double> error(sizes.size(), 0.0);
    double square = 0;
    std::mt19937 random(10);
    for (size_t first = 0; first < kLookUps; first += block) {
        std::vector<Vec3f> normals(block);
        for (Vec3f& normal : normals) normal = randomDirection(random).cast<float>();
        const std::vector<float> exact = evalLightCosine(light, shOrder, normals);
        for (size_t i = 0; i < n2 * block; ++i) square += double(exact[i]) * double(exact[i]);
        for (size_t s = 0; s < sizes.size(); ++s)
            for (size_t k = 0; k < block; ++k) {
                const auto taps = cubeSeamlessTaps(normals[k].cast<double>(), sizes[s]);
                std::array<const float*, 4> texel;
                for (size_t t = 0; t < 4; ++t)
                    texel[t] = tables[s].data() +
                               size_t((taps[t].face * sizes[s] + taps[t].y) * sizes[s] + taps[t].x) * n2;
                for (size_t i = 0; i < n2; ++i) {
                    float value = 0;
                    for (size_t t = 0; t < 4; ++t) value += taps[t].weight * texel[t][i];
                    error[s] += std::pow(double(value) - double(exact[i * block + k]), 2);
                }
            }
    }
    for (double& e : error) e = std::sqrt(e / square);
    return error;
}

TEST(LookUp, ErrorOfEverySizeFallsWithItsSquare) {
    const std::array sizes = {4, 8, 16, 32, 64};
    for (const int shOrder : {3, 6}) {
        const std::vector<double> error =
            lookUpErrors(skyLight(tableEnvironmentShOrder(shOrder)), shOrder, sizes);
        for (size_t s = 0; s < sizes.size(); ++s) {
            std::printf("order %d, size %2d: relative RMS %.2e over %zu normals\n", shOrder, sizes[s],
                        error[s], kLookUps);
            // Bilinear interpolation: halving the texels quarters the error (between 3 and 5 times here).
            if (s > 0) {
                EXPECT_GT(error[s - 1] / error[s], 3.0);
                EXPECT_LT(error[s - 1] / error[s], 5.0);
            }
        }
        EXPECT_LT(error[3], 1.5e-3);
    }
}

TEST(NormalTablesDeath, LightOfTooFewBandsOrSizeOutOfRange) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const EnvironmentSh light = basisLight(0, 4);
    EXPECT_DEATH(buildLightCosineTable(light, 3, 4), "shOrder");
    EXPECT_DEATH(buildLightCosineTable(basisLight(0, 14), 3, 0), "size");
    EXPECT_DEATH(buildLightCosineTable(basisLight(0, 14), 3, 1025), "size");
}

}  // namespace
}  // namespace prt
