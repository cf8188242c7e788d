// The cube map: orientation, solid angles, neighbours and seamless filtering.
#include "precompute/math/sphere_map.h"

#include <cmath>
#include <numbers>

#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// Table 8.19 of the OpenGL 4.5 core specification: s = (sc/|ma| + 1)/2, t = (tc/|ma| + 1)/2. A coordinate is
/// +1 + axis or −1 − axis.
struct SpecRow {
    int major, sc, tc;
};
constexpr SpecRow kSpec[6] = {{+1, -3, -2}, {-1, +3, -2}, {+2, +1, +3},
                              {-2, +1, -3}, {+3, +1, -2}, {-3, -1, -2}};
double signedCoordinate(const Vec3d& d, int code) { return code > 0 ? d[code - 1] : -d[-code - 1]; }

TEST(CubeMap, FacesAreThoseOfTheOpenGlSpecification) {
    test::RandomInput random(61);
    for (int k = 0; k < 20000; ++k) {
        const Vec3d d = random.direction() * random.uniform(0.1, 10);
        int face = 0;
        for (int f = 1; f < 6; ++f)
            if (signedCoordinate(d, kSpec[f].major) > signedCoordinate(d, kSpec[face].major)) face = f;
        const double ma = signedCoordinate(d, kSpec[face].major);
        const CubePoint point = cubePointFromDirection(d, 32);
        ASSERT_EQ(point.face, face);
        EXPECT_NEAR(point.x, 16 * (signedCoordinate(d, kSpec[face].sc) / ma + 1), 1e-12);
        EXPECT_NEAR(point.y, 16 * (signedCoordinate(d, kSpec[face].tc) / ma + 1), 1e-12);
    }
}

TEST(CubeMap, FaceCentresAreTheAxes) {
    const Vec3d axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int face = 0; face < 6; ++face) {
        EXPECT_LT((cubeDirection({face, 4, 4}, 8) - axes[face]).norm(), 1e-15);
        EXPECT_LT((cubeTexelDirection(face, 0, 0, 1) - axes[face].cast<float>()).norm(), 1e-7f);
    }
}

TEST(CubeMap, DirectionAndPointRoundTrip) {
    test::RandomInput random(62);
    for (int face = 0; face < 6; ++face)
        for (const int size : {1, 2, 7, 64}) {
            for (int k = 0; k < 500; ++k) {
                const CubePoint point{face, random.uniform(0.001, 0.999) * size,
                                      random.uniform(0.001, 0.999) * size};
                const Vec3d d = cubeDirection(point, size);
                EXPECT_NEAR(d.norm(), 1, 1e-15);
                const CubePoint back = cubePointFromDirection(3 * d, size);
                EXPECT_EQ(back.face, face);
                EXPECT_NEAR(back.x, point.x, 1e-12 * size);
                EXPECT_NEAR(back.y, point.y, 1e-12 * size);
            }
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const CubePoint p =
                        cubePointFromDirection(cubeTexelDirection(face, x, y, size).cast<double>(), size);
                    EXPECT_EQ(p.face, face);
                    EXPECT_NEAR(p.x, x + 0.5, 1e-5 * size);
                    EXPECT_NEAR(p.y, y + 0.5, 1e-5 * size);
                }
        }
}

TEST(CubeMap, PointsStayOnTheirFace) {
    // edges and corners, also where rounding could step over
    for (const double a : {-1.0, -1 + 1e-16, 0.0, 1 - 1e-16, 1.0})
        for (const double b : {-1.0, 1.0})
            for (const double c : {-1.0, 1.0 / 3, 1.0})
                for (const Vec3d& d : {Vec3d(a, b, c), Vec3d(b, c, a), Vec3d(c, a, b)}) {
                    const CubePoint p = cubePointFromDirection(d, 5);
                    EXPECT_GE(p.x, 0);
                    EXPECT_LE(p.x, 5);
                    EXPECT_GE(p.y, 0);
                    EXPECT_LE(p.y, 5);
                    EXPECT_LT((cubeDirection(p, 5) - d.normalized()).norm(), 1e-14);
                }
}

TEST(CubeMap, SolidAnglesAreExact) {
    for (const int size : {1, 2, 3, 8, 33, 256}) {
        double sum = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const double omega = cubeTexelSolidAngle(x, y, size);
                EXPECT_GT(omega, 0);
                sum += omega;
            }
        EXPECT_NEAR(6 * sum, 4 * kPi, 1e-11) << size;
    }
    // one texel by quadrature of dΩ = ds dt / (1 + s² + t²)^3/2
    const int size = 4;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            double sum = 0;
            const int steps = 200;
            for (int j = 0; j < steps; ++j)
                for (int i = 0; i < steps; ++i) {
                    const double s = 2 * (x + (i + 0.5) / steps) / size - 1,
                                 t = 2 * (y + (j + 0.5) / steps) / size - 1;
                    sum += std::pow(1 + s * s + t * t, -1.5);
                }
            const double texel = 2.0 / size / steps;
            EXPECT_NEAR(cubeTexelSolidAngle(x, y, size), sum * texel * texel, 1e-6);
        }
}

TEST(CubeNeighbour, LiesNextToTheTexelAndStepsBack) {
    for (const int size : {1, 2, 3, 4, 16})
        for (int face = 0; face < 6; ++face)
            for (int side = 0; side < 4; ++side)
                for (int k = 0; k < size; ++k) {
                    const int inX = side == 0 ? 0 : side == 1 ? size - 1 : k;
                    const int inY = side == 2 ? 0 : side == 3 ? size - 1 : k;
                    const int outX = inX + (side == 0 ? -1 : side == 1 ? 1 : 0);
                    const int outY = inY + (side == 2 ? -1 : side == 3 ? 1 : 0);
                    const CubeTap across = cubeTexelAcrossEdge(face, outX, outY, size);
                    ASSERT_NE(across.face, face);
                    // mirror images in the plane through the edge: the same distance from the middle of their
                    // side
                    const Vec3d a = cubeTexelDirection(face, inX, inY, size).cast<double>();
                    const Vec3d b = cubeTexelDirection(across.face, across.x, across.y, size).cast<double>();
                    const Vec3d edge =
                        cubeDirection({face, 0.5 * (inX + outX + 1), 0.5 * (inY + outY + 1)}, size);
                    EXPECT_NEAR(a.dot(edge), b.dot(edge), 1e-6);
                    EXPECT_NEAR((a + b).normalized().dot(edge), 1, 0.5 / size / size + 1e-6);
                    EXPECT_LT((a - b).norm(), 1.5 / size);
                    // from there the same step leads back
                    bool found = false;
                    for (const auto& step : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
                        const int x = across.x + step[0], y = across.y + step[1];
                        if (x >= 0 && x < size && y >= 0 && y < size) continue;
                        const CubeTap back = cubeTexelAcrossEdge(across.face, x, y, size);
                        found = found || (back.face == face && back.x == inX && back.y == inY);
                    }
                    EXPECT_TRUE(found) << size << ' ' << face << ' ' << side << ' ' << k;
                }
}

TEST(CubeNeighbour, InsideIsTheTexelItself) {
    const CubeTap tap = cubeTexelAcrossEdge(3, 2, 1, 4);
    EXPECT_EQ(tap.face, 3);
    EXPECT_EQ(tap.x, 2);
    EXPECT_EQ(tap.y, 1);
}

TEST(SeamlessTaps, WeightsSumToOneAndTexelsExist) {
    test::RandomInput random(63);
    for (const int size : {1, 2, 3, 8, 64})
        for (int k = 0; k < 20000; ++k) {
            Vec3d d = random.direction();
            if (k % 4 == 0) d = Vec3d(d.array().sign() + 0.2 / size * d.array());  // crowd the corners
            double sum = 0;
            for (const CubeTap& tap : cubeSeamlessTaps(d, size)) {
                EXPECT_TRUE(tap.face >= 0 && tap.face < 6);
                EXPECT_TRUE(tap.x >= 0 && tap.x < size && tap.y >= 0 && tap.y < size);
                EXPECT_GE(tap.weight, 0);
                sum += double(tap.weight);
            }
            ASSERT_NEAR(sum, 1, 2e-7);
        }
}

TEST(SeamlessTaps, InsideAFaceTheyArePlainBilinear) {
    const CubePoint point{4, 2.75, 5.1};
    const std::array<CubeTap, 4> taps = cubeSeamlessTaps(cubeDirection(point, 8), 8);
    const int x[] = {2, 3, 2, 3}, y[] = {4, 4, 5, 5};
    const double weight[] = {0.75 * 0.4, 0.25 * 0.4, 0.75 * 0.6, 0.25 * 0.6};
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(taps[i].face, 4);
        EXPECT_EQ(taps[i].x, x[i]);
        EXPECT_EQ(taps[i].y, y[i]);
        EXPECT_NEAR(double(taps[i].weight), weight[i], 1e-7);
    }
}

TEST(SeamlessTaps, AtCornersThreeTexelsMeet) {
    for (const int size : {1, 2, 8})
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3d d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            std::vector<int> faces;
            for (const CubeTap& tap : cubeSeamlessTaps(d, size)) {
                if (tap.weight == 0) continue;
                EXPECT_NEAR(tap.weight, 1.0f / 3, 1e-6f);
                faces.push_back(tap.face);
                EXPECT_GT(cubeTexelDirection(tap.face, tap.x, tap.y, size).cast<double>().dot(d), 0.99);
            }
            std::sort(faces.begin(), faces.end());
            const std::vector<int> expected = {corner & 1 ? 0 : 1, corner & 2 ? 2 : 3, corner & 4 ? 4 : 5};
            EXPECT_EQ(faces, expected);
        }
}

double lookUp(const std::vector<double>& table, int size, const Vec3d& d) {
    double sum = 0;
    for (const CubeTap& tap : cubeSeamlessTaps(d, size))
        sum += double(tap.weight) * table[size_t((tap.face * size + tap.y) * size + tap.x)];
    return sum;
}

TEST(SeamlessTaps, LookupIsContinuousAcrossEdges) {
    test::RandomInput random(64);
    for (const int size : {1, 2, 4, 16}) {
        std::vector<double> linear, noise;
        const Vec3d gradient(0.3, -0.7, 0.9);
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    linear.push_back(gradient.dot(cubeTexelDirection(face, x, y, size).cast<double>()));
                    noise.push_back(random.uniform(0, 1));
                }
        for (int k = 0; k < 3000; ++k) {
            // a point of an edge: two coordinates of magnitude 1, of which now one and now the other is
            // larger
            const int free = k % 3;
            Vec3d a, b;
            a[free] = b[free] = k % 7 == 0 ? random.uniform(0.98, 1.0) : random.uniform(-1, 1);
            const int i = (free + 1) % 3, j = (free + 2) % 3;
            const double si = k & 8 ? 1 : -1, sj = k & 16 ? 1 : -1;
            a[i] = si;
            a[j] = sj * (1 - 1e-9);
            b[i] = si * (1 - 1e-9);
            b[j] = sj;
            ASSERT_NE(cubePointFromDirection(a, size).face, cubePointFromDirection(b, size).face);
            EXPECT_NEAR(lookUp(linear, size, a), lookUp(linear, size, b), 1e-6);
            EXPECT_NEAR(lookUp(noise, size, a), lookUp(noise, size, b), 1e-6);
        }
    }
}

}  // namespace
}  // namespace prt
