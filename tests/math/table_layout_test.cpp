// Layouts of tables: normals, mirror images, and lookups of smooth functions over the sphere and at seams.
#include "precompute/math/table_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "precompute/base/error.h"
#include "tests/compress/table_lights.h"

namespace prt {
namespace {

class TableLayouts : public testing::TestWithParam<std::string> {
  protected:
    static std::vector<int> sizes() {
        std::vector<int> all = {1, 2, 3, 4, 5, 8, 16, 17};
        std::erase_if(all, [](int size) { return size < TableLayout::minSize(GetParam()); });
        return all;
    }
};

TEST_P(TableLayouts, LookupAtANormalReturnsItsTexel) {
    for (const int size : sizes()) {
        const TableLayout layout(GetParam(), size);
        for (int texel = 0; texel < layout.texelCount(); ++texel) {
            const Vec3d normal = layout.normal(texel);
            ASSERT_NEAR(normal.norm(), 1, 1e-12);
            // All that weighs is the texel, or one that repeats it.
            double sum = 0;
            for (const SphereTap& tap : layout.taps(normal)) {
                ASSERT_TRUE(tap.texel >= 0 && tap.texel < layout.texelCount());
                sum += double(tap.weight);
                if (tap.weight > 1e-6f) {
                    ASSERT_LT((layout.normal(tap.texel) - normal).norm(), 1e-6) << size << ' ' << texel;
                }
            }
            ASSERT_NEAR(sum, 1, 1e-6);
        }
    }
}

TEST_P(TableLayouts, MirroredTexelsHaveMirroredNormals) {
    for (const int size : sizes()) {
        const TableLayout layout(GetParam(), size);
        for (const MirrorAxis axis : {MirrorAxis::X, MirrorAxis::Y, MirrorAxis::Z}) {
            std::vector<int> images;
            for (int texel = 0; texel < layout.texelCount(); ++texel) {
                const int image = layout.mirrored(texel, axis);
                images.push_back(image);
                if (image < 0) continue;
                Vec3d expected = layout.normal(texel);
                expected[int(axis)] = -expected[int(axis)];
                ASSERT_LT((layout.normal(image) - expected).norm(), 1e-15) << size << ' ' << texel;
                ASSERT_EQ(layout.mirrored(image, axis), texel);
            }
            // Either all texels have one, or none.
            const bool none = GetParam() == "octahedral" && axis == MirrorAxis::Z;
            std::sort(images.begin(), images.end());
            for (int texel = 0; texel < layout.texelCount(); ++texel)
                ASSERT_EQ(images[size_t(texel)], none ? -1 : texel);
        }
    }
}

/// A function of bands 0 to 4 with a value of its own in every direction.
double smooth(const Vec3d& n) {
    return 0.3 + 0.5 * n.x() - 0.7 * n.y() * n.z() + n.x() * n.y() * n.z() + 0.4 * std::pow(n.z(), 4) -
           0.6 * n.x() * n.x() * n.y() * n.y();
}

std::vector<float> tabulate(const TableLayout& layout) {
    std::vector<float> table;
    for (int texel = 0; texel < layout.texelCount(); ++texel)
        table.push_back(float(smooth(layout.normal(texel))));
    return table;
}

double lookUp(const TableLayout& layout, std::span<const float> table, const Vec3d& direction) {
    double value = 0;
    for (const SphereTap& tap : layout.taps(direction))
        value += double(tap.weight) * double(table[size_t(tap.texel)]);
    return value;
}

/// RMS error of lookups in the directions.
double lookUpError(const TableLayout& layout, std::span<const Vec3d> directions) {
    const std::vector<float> table = tabulate(layout);
    double sum = 0;
    for (const Vec3d& d : directions) sum += std::pow(lookUp(layout, table, d) - smooth(d), 2);
    return std::sqrt(sum / double(directions.size()));
}

std::vector<Vec3d> directions(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Vec3d> result;
    for (int k = 0; k < count; ++k) result.push_back(randomDirection(random));
    return result;
}

TEST_P(TableLayouts, ErrorFallsWithTheSquareOfTheSize) {
    const std::vector<Vec3d> everywhere = directions(20000, 1);
    double before = 0;
    for (const int size : {8, 16, 32, 64}) {
        const double error = lookUpError(TableLayout(GetParam(), size), everywhere);
        std::printf("%s, size %2d: RMS error %.2e\n", GetParam().c_str(), size, error);
        // Bilinear interpolation: a quarter at twice the size (3.4 to 4.5 here).
        if (before > 0) {
            EXPECT_GT(before / error, 3.0) << size;
            EXPECT_LT(before / error, 5.0) << size;
        }
        before = error;
    }
    EXPECT_LT(before, 1.5e-3);  // 1.2e-3 for the octahedron
}

/// Directions within half a texel of a seam: edges of the cube, the equator, the edges of the octahedron's
/// square.
std::vector<Vec3d> seamDirections(const std::string& layout, int size) {
    std::vector<Vec3d> result;
    for (const Vec3d& d : directions(200000, 2)) {
        std::array<double, 3> a = {std::abs(d.x()), std::abs(d.y()), std::abs(d.z())};
        bool near;
        if (layout == "cube") {
            std::sort(a.begin(), a.end());
            near = 1 - a[1] / a[2] < 1.0 / size;
        } else if (layout == "dual-paraboloid") {
            near = a[2] < 1.0 / size;
        } else {
            near = d.z() < 0 && std::min(a[0], a[1]) / (a[0] + a[1] + a[2]) < 1.0 / size;
        }
        if (near) result.push_back(d);
    }
    return result;
}

TEST_P(TableLayouts, ErrorAtSeams) {
    // Cube and octahedron have a bend at seams, where bilinear interpolation is only of first order: errors
    // of 1.4 and 1.2 times that everywhere at 16 texels, 2.7 and 2.0 at 32, 0.4 on the equator of the dual
    // map, which lies on texel centres.
    double before = 0;
    for (const int size : {8, 16, 32}) {
        const TableLayout layout(GetParam(), size);
        const std::vector<Vec3d> seam = seamDirections(GetParam(), size);
        ASSERT_GT(seam.size(), 1000u);
        const double error = lookUpError(layout, seam),
                     ratio = error / lookUpError(layout, directions(20000, 1));
        std::printf("%s, size %2d: RMS error %.2e at seams, %.2f of that everywhere\n", GetParam().c_str(),
                    size, error, ratio);
        EXPECT_LT(ratio, GetParam() == "dual-paraboloid" ? 0.5 : std::max(1.0, 0.1 * size)) << size;
        if (before > 0) {
            EXPECT_GT(before / error, 1.7) << size;
        }
        before = error;
    }
}

/// The nearest place on a seam, `over` beyond it.
Vec3d onSeam(const std::string& layout, Vec3d d, double over) {
    int large = 0;
    const double most = d.cwiseAbs().maxCoeff(&large);
    if (layout == "cube") {
        d[large] = 0;
        int second = 0;
        d.cwiseAbs().maxCoeff(&second);
        d[second] = std::copysign(most + over, d[second]);
        d[large] = most;
    } else if (layout == "dual-paraboloid") {
        d.z() = over;
    } else {
        d[std::abs(d.x()) < std::abs(d.y()) ? 0 : 1] = over;
    }
    return d;
}

TEST_P(TableLayouts, ContinuousAcrossSeams) {
    // 1e-8 beyond on either side; weights are float.
    const TableLayout layout(GetParam(), 9);
    const std::vector<float> table = tabulate(layout);
    for (const Vec3d& d : seamDirections(GetParam(), 9))
        ASSERT_NEAR(lookUp(layout, table, onSeam(GetParam(), d, 1e-8)),
                    lookUp(layout, table, onSeam(GetParam(), d, -1e-8)), 2e-6);
}
INSTANTIATE_TEST_SUITE_P(All, TableLayouts, testing::ValuesIn(TableLayout::names()), layoutTestName);

/// Plain bilinear lookup, clamped to the image, as a two-dimensional texture does it.
double plainLookUp(const TableLayout& layout, std::span<const float> table, double x, double y) {
    const int x0 = int(std::floor(x - 0.5)), y0 = int(std::floor(y - 0.5));
    const double fx = x - 0.5 - x0, fy = y - 0.5 - y0;
    double value = 0;
    for (int k = 0; k < 4; ++k) {
        const int column = std::clamp(x0 + k % 2, 0, layout.width() - 1),
                  row = std::clamp(y0 + k / 2, 0, layout.height() - 1);
        value += (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy) *
                 double(table[size_t(row * layout.width() + column)]);
    }
    return value;
}

TEST(OctahedralTable, BorderMakesPlainFilteringSeamless) {
    // The octahedral map as a shader writes it, into the image as the header describes it.
    for (const int size : {1, 4, 7, 16}) {
        const TableLayout layout("octahedral", size);
        const std::vector<float> table = tabulate(layout);
        ASSERT_EQ(layout.width(), size + 2);
        for (const Vec3d& d : directions(20000, 4)) {
            const double sum = std::abs(d.x()) + std::abs(d.y()) + std::abs(d.z());
            double u = std::abs(d.x()) / sum, v = std::abs(d.y()) / sum;
            if (d.z() < 0) {
                std::swap(u, v);
                u = 1 - u;
                v = 1 - v;
            }
            const double s = std::copysign(u, d.x()), t = std::copysign(v, -d.y());
            ASSERT_NEAR(plainLookUp(layout, table, 1 + (s + 1) / 2 * size, 1 + (t + 1) / 2 * size),
                        lookUp(layout, table, d), 1e-6);
        }
    }
}

TEST(DualParaboloidTable, SquaresSideBySideFilterPlainly) {
    // The concentric map by polar angle: on the square max(|s|, |t|) is the disc's radius, and the other
    // coordinate runs evenly with the angle along each side.
    for (const int size : {2, 5, 16}) {
        const TableLayout layout("dual-paraboloid", size);
        const std::vector<float> table = tabulate(layout);
        ASSERT_EQ(layout.width(), 2 * size);
        ASSERT_EQ(layout.height(), size);
        for (const Vec3d& d : directions(20000, 5)) {
            const double right = d.z() >= 0 ? d.x() : -d.x(), down = -d.y();
            const double r = std::tan(std::acos(std::min(1.0, std::abs(d.z()))) / 2);
            const double angle = std::atan2(down, right), quarter = std::numbers::pi / 4;
            double s, t;
            if (std::abs(right) >= std::abs(down)) {
                s = std::copysign(r, right);
                t = r * std::atan(down / std::abs(right)) / quarter;
            } else {
                t = std::copysign(r, down);
                s = r * (2 - std::abs(angle) / quarter);
            }
            const double x = 0.5 + (s + 1) / 2 * (size - 1) + (d.z() >= 0 ? 0 : size);
            const double y = 0.5 + (t + 1) / 2 * (size - 1);
            ASSERT_NEAR(plainLookUp(layout, table, x, y), lookUp(layout, table, d), 1e-6);
        }
    }
}

TEST(TableLayout, UnknownNamesAndSizes) {
    EXPECT_THROW(TableLayout("latitude", 8), InputError);
    EXPECT_THROW(TableLayout("cube", 0), InputError);
    EXPECT_THROW(TableLayout("dual-paraboloid", 1), InputError);
    EXPECT_THROW(TableLayout("octahedral", TableLayout::kMaxSize + 1), InputError);
}

TEST(TableLayout, CubeIsTheOneOfCubeTables) {
    const TableLayout layout("cube", 5);
    ASSERT_EQ(layout.texelCount(), 150);
    for (int texel = 0; texel < 150; ++texel)
        EXPECT_EQ(Vec3f(layout.normal(texel).cast<float>()),
                  cubeTexelDirection(texel / 25, texel % 5, texel / 5 % 5, 5));
    for (const Vec3d& d : directions(1000, 6)) {
        const SphereTaps taps = layout.taps(d);
        const auto expected = cubeSeamlessTaps(d, 5);
        for (size_t k = 0; k < 4; ++k) {
            EXPECT_EQ(taps[k].texel, (expected[k].face * 5 + expected[k].y) * 5 + expected[k].x);
            EXPECT_EQ(taps[k].weight, expected[k].weight);
        }
    }
}

}  // namespace
}  // namespace prt
