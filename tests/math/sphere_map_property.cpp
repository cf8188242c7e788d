// One battery over every layout of the sphere at several sizes.
#include "precompute/math/sphere_map.h"

#include <cmath>
#include <numbers>

#include "precompute/math/directions.h"
#include "tests/math/random_input.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

bool isDual(const std::string& name) { return name.starts_with("dual"); }

/// Where the orthographic projection is steep, at the equator, a coordinate's rounding ε is √(2ε) of angle.
double directionTolerance(const std::string& name) { return name == "dual-orthographic" ? 3e-8 : 2e-15; }

/// Where a map is most likely to go wrong: axes, diagonals, and next to each of these; poles and caps' rims.
std::vector<Vec3d> specialDirections() {
    std::vector<Vec3d> list;
    const double values[] = {-1, -1e-300, -0.0, 0.0, 1e-17, 1, 1 - 1e-16};
    for (const double x : values)
        for (const double y : values)
            for (const double z : values)
                if (std::abs(x) + std::abs(y) + std::abs(z) > 1e-20) list.emplace_back(x, y, z);
    for (const double height : {2.0 / 3, -2.0 / 3, 0.0, 1 - 1e-15, -1 + 1e-15})
        for (int k = 0; k < 16; ++k) {
            const double angle = k * kPi / 8, radius = std::sqrt(1 - height * height);
            list.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
        }
    return list;
}

std::vector<Vec3d> someDirections(int count, uint64_t seed) {
    std::vector<Vec3d> list = specialDirections();
    test::RandomInput random(seed);
    for (int k = 0; k < count; ++k) list.push_back(random.direction() * random.uniform(0.1, 10));
    return list;
}

double angleBetween(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

double triangleSolidAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return 2 * std::atan2((b - a).cross(c - a).dot(a), 1 + a.dot(b) + b.dot(c) + c.dot(a));
}

/// A function that no map of these sizes resolves: neighbouring texels have unrelated values. Texels of one
/// direction have one value.
double rough(const Vec3d& d) {
    return std::sin(97 * d.x() + 1) + std::sin(89 * d.y() + 2) + std::sin(101 * d.z() + 3);
}

template <typename Function>
std::vector<double> tabulate(const SphereMap& map, const Function& function) {
    std::vector<double> table;
    for (int texel = 0; texel < map.texelCount(); ++texel)
        table.push_back(function(map.texelDirection(texel)));
    return table;
}

double lookUp(const SphereMap& map, const std::vector<double>& table, const Vec3d& direction) {
    double sum = 0;
    for (const SphereTap& tap : map.taps(direction)) sum += double(tap.weight) * table[size_t(tap.texel)];
    return sum;
}

struct Case {
    std::string name;
    int size;
};

std::vector<Case> allCases() {
    std::vector<Case> cases;
    for (const SphereMapFamily& family : sphereMapFamilies())
        for (const int size : {1, 2, 3, 4, 7, 16, 33})
            if (size >= family.minSize) cases.push_back({family.name, size});
    return cases;
}

std::string identifier(std::string name) {
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

class EverySphereMap : public testing::TestWithParam<Case> {
  protected:
    const std::string& name() const { return GetParam().name; }
    int size() const { return GetParam().size; }
    /// A random point of a face at least `margin` texels inside what shows directions of its own.
    SpherePoint randomPoint(double margin) {
        const double low = (isDual(name()) ? 0.5 : 0.0) + margin;
        return {int(random_.uniform(0, map_->faceCount())), random_.uniform(low, map_->faceWidth() - low),
                random_.uniform(low, map_->faceHeight() - low)};
    }

    std::unique_ptr<SphereMap> map_ = makeSphereMap(GetParam().name, GetParam().size);
    test::RandomInput random_{uint64_t(GetParam().size)};
};

TEST_P(EverySphereMap, DirectionsRoundTrip) {
    for (const Vec3d& d : someDirections(5000, 31)) {
        const SpherePoint point = map_->pointFromDirection(d);
        ASSERT_TRUE(point.face >= 0 && point.face < map_->faceCount());
        ASSERT_TRUE(point.x >= 0 && point.x <= map_->faceWidth()) << d.transpose();
        ASSERT_TRUE(point.y >= 0 && point.y <= map_->faceHeight()) << d.transpose();
        const Vec3d back = map_->directionFromPoint(point);
        EXPECT_NEAR(back.norm(), 1, 1e-15);
        EXPECT_LT((back - d.stableNormalized()).norm(), directionTolerance(name())) << d.transpose();
    }
}

TEST_P(EverySphereMap, PointsRoundTrip) {
    for (int k = 0; k < 5000; ++k) {
        const SpherePoint point = randomPoint(1e-6);
        const SpherePoint back = map_->pointFromDirection(7 * map_->directionFromPoint(point));
        ASSERT_EQ(back.face, point.face);
        ASSERT_NEAR(back.x, point.x, 1e-8 * size());
        ASSERT_NEAR(back.y, point.y, 1e-8 * size());
    }
}

TEST_P(EverySphereMap, TexelCentresAreTheirOwn) {
    for (int texel = 0; texel < map_->texelCount(); ++texel) {
        const SpherePoint centre = map_->texelCentre(texel);
        ASSERT_EQ((centre.face * map_->faceHeight() + int(centre.y)) * map_->faceWidth() + int(centre.x),
                  texel);
        const Vec3d d = map_->texelDirection(texel);
        ASSERT_NEAR(d.norm(), 1, 1e-15);
        // on the equator of dual maps the texel of the other half may stand in
        const bool shared = isDual(name()) && std::abs(d.z()) < 1e-7;
        if (!shared) {
            const SpherePoint point = map_->pointFromDirection(d);
            EXPECT_EQ(point.face, centre.face);
            EXPECT_NEAR(point.x, centre.x, 1e-12 * size());
            EXPECT_NEAR(point.y, centre.y, 1e-12 * size());
        }
        double weight = 0;
        for (const SphereTap& tap : map_->taps(d)) {
            const bool same =
                shared ? angleBetween(map_->texelDirection(tap.texel), d) < 1e-7 : tap.texel == texel;
            if (same) weight += double(tap.weight);
        }
        EXPECT_NEAR(weight, 1, shared ? 1e-6 : 1e-12 * size() + 1e-7) << texel;
    }
}

TEST_P(EverySphereMap, WeightsAreAMeanOfTexelsNearby) {
    // the farthest that a point of a texel is from its centre; taps are at most twice that and a corner away
    double reach = 0;
    for (int texel = 0; texel < map_->texelCount(); ++texel) {
        const SpherePoint c = map_->texelCentre(texel);
        for (const double dx : {-0.5, 0.5})
            for (const double dy : {-0.5, 0.5})
                reach = std::max(reach, angleBetween(map_->texelDirection(texel),
                                                     map_->directionFromPoint({c.face, c.x + dx, c.y + dy})));
    }
    for (const Vec3d& d : someDirections(5000, 32)) {
        double sum = 0;
        for (const SphereTap& tap : map_->taps(d)) {
            ASSERT_TRUE(tap.texel >= 0 && tap.texel < map_->texelCount());
            ASSERT_GE(tap.weight, 0);
            sum += double(tap.weight);
            if (double(tap.weight) > 1e-6) {
                EXPECT_LT(angleBetween(map_->texelDirection(tap.texel), d), 2.5 * reach) << d.transpose();
            }
        }
        ASSERT_NEAR(sum, 1, 2e-7);
    }
}

TEST_P(EverySphereMap, BetweenTwoTexelsOfARowBothCountHalf) {
    // numbers rise by 1 along a row and by the width over rows: a map that swapped its axes would show here
    for (int k = 0; k < 300; ++k) {
        const int face = int(random_.uniform(0, map_->faceCount()));
        const int x = int(random_.uniform(0, map_->faceWidth())),
                  y = int(random_.uniform(0, map_->faceHeight()));
        const int texel = (face * map_->faceHeight() + y) * map_->faceWidth() + x;
        const auto half = [&](double dx, double dy, int step) {
            const Vec3d d = map_->directionFromPoint({face, x + dx, y + dy});
            if (isDual(name()) && std::abs(d.z()) < 1e-7) return;  // may fall on the other half
            double here = 0, there = 0;
            for (const SphereTap& tap : map_->taps(d)) {
                if (tap.texel == texel) here += double(tap.weight);
                if (tap.texel == texel + step) there += double(tap.weight);
            }
            EXPECT_NEAR(here, 0.5, 1e-6);
            EXPECT_NEAR(there, 0.5, 1e-6);
        };
        if (x + 1 < map_->faceWidth()) half(1, 0.5, 1);
        if (y + 1 < map_->faceHeight()) half(0.5, 1, map_->faceWidth());
    }
}

TEST_P(EverySphereMap, EveryFaceHasTheHandednessOfItsLayout) {
    const double expected = name() == "latitude-longitude" || name() == "healpix" ? 1 : -1;
    const double h = 1e-6 * size();
    for (int k = 0; k < 2000; ++k) {
        const SpherePoint p = randomPoint(2 * h);
        const auto at = [&](double dx, double dy) {
            return map_->directionFromPoint({p.face, p.x + dx * h, p.y + dy * h});
        };
        const double volume = (at(1, 0) - at(-1, 0)).cross(at(0, 1) - at(0, -1)).dot(at(0, 0));
        EXPECT_GT(expected * volume, 0) << p.face << ' ' << p.x << ' ' << p.y;
    }
}

TEST_P(EverySphereMap, LookupsAreContinuousAcrossEveryBorder) {
    const std::vector<double> table = tabulate(*map_, rough);
    constexpr double kStep = 1e-9;
    double worst = 0;
    for (int k = 0; k < 20000; ++k) {
        const int face = int(random_.uniform(0, map_->faceCount()));
        double along = random_.uniform(0, 1);
        if (k % 8 == 0) along *= 1e-6;  // crowd the corners
        if (k % 8 == 1) along = 1 - 1e-6 * along;
        const bool latLong = name() == "latitude-longitude";
        if (latLong) along = 0.02 + 0.96 * along;  // at the poles there is no limit
        const double end = random_.uniform(-1, 1) < 0 ? 0 : 1;
        const bool side = latLong || random_.uniform(-1, 1) < 0;
        const Vec3d d = map_->directionFromPoint(
            {face, (side ? end : along) * map_->faceWidth(), (side ? along : end) * map_->faceHeight()});
        const Vec3d a = d + kStep * random_.direction(), b = d + kStep * random_.direction();
        worst = std::max(worst, std::abs(lookUp(*map_, table, a) - lookUp(*map_, table, b)));
    }
    // A texel's width holds a change of up to 6, weights are rounded to float, and next to the poles of a
    // latitude-longitude map a step is 1 / sin(0.02π) wider.
    const double smooth = 6 * kStep * 4 * size() * (name() == "latitude-longitude" ? 16 : 1) + 6 * 2e-7;
    if (name() == "cube") {
        EXPECT_GT(worst, 0.1);  // the control: faces apart do jump
    } else {
        EXPECT_LT(worst, smooth);
    }
}

TEST_P(EverySphereMap, LookupsAreContinuousAlongRandomArcs) {
    const std::vector<double> table = tabulate(*map_, rough);
    double worst = 0;
    for (int k = 0; k < 500; ++k) {
        // Halve the arc, always keep the half that changes more: ends at a jump if there is one.
        Vec3d a = random_.direction(), b = random_.direction();
        double fa = lookUp(*map_, table, a), fb = lookUp(*map_, table, b);
        while ((a - b).norm() > kPi * 1e-9) {
            const Vec3d middle = (a + b).normalized();
            const double fm = lookUp(*map_, table, middle);
            const bool first = std::abs(fa - fm) > std::abs(fb - fm);
            (first ? b : a) = middle;
            (first ? fb : fa) = fm;
        }
        worst = std::max(worst, std::abs(fa - fb));
    }
    // Arcs come as near as 1e-3 to the poles of a latitude-longitude map, where all columns meet.
    const double steepness = name() == "latitude-longitude" ? 1000 : 1;
    if (name() == "cube") {
        EXPECT_GT(worst, 0.1);
    } else {
        EXPECT_LT(worst, 6 * 1e-8 * 4 * size() * steepness + 6 * 2e-7);
    }
}

TEST_P(EverySphereMap, SolidAnglesFillTheSphere) {
    double sum = 0, smallest = 100, largest = 0;
    for (int texel = 0; texel < map_->texelCount(); ++texel) {
        const double omega = map_->texelSolidAngle(texel);
        ASSERT_GT(omega, 0);
        sum += omega;
        smallest = std::min(smallest, omega);
        largest = std::max(largest, omega);
    }
    EXPECT_NEAR(sum, 4 * kPi, 1e-11);
    if (name() == "healpix" || name() == "equal-area-octahedral") {
        EXPECT_NEAR(smallest, largest, 1e-13);
    }
}

TEST_P(EverySphereMap, SolidAnglesAreThoseOfTheTexelsSquares) {
    // A grid of triangles on the sphere, exact where straight lines of the map are great circles; elsewhere
    // the bent outlines count, for 1/steps² or, where the orthographic projection is steep, a root of it.
    constexpr int kSteps = 24;
    double worst = 0;
    for (int k = 0; k < 40; ++k) {
        const int texel = int(random_.uniform(0, map_->texelCount()));
        const SpherePoint c = map_->texelCentre(texel);
        const auto corner = [&](int i, int j) {
            return map_->directionFromPoint(
                {c.face, c.x - 0.5 + i / double(kSteps), c.y - 0.5 + j / double(kSteps)});
        };
        double sum = 0;
        for (int j = 0; j < kSteps; ++j)
            for (int i = 0; i < kSteps; ++i) {
                const Vec3d a = corner(i, j), b = corner(i + 1, j), d = corner(i, j + 1),
                            e = corner(i + 1, j + 1);
                sum += 0.5 * std::abs(triangleSolidAngle(a, b, e) + triangleSolidAngle(a, e, d)) +
                       0.5 * std::abs(triangleSolidAngle(a, b, d) + triangleSolidAngle(b, e, d));
            }
        const double omega = map_->texelSolidAngle(texel);
        worst = std::max(worst, std::abs(sum / omega - 1));
    }
    const bool straight = name().starts_with("cube") || name() == "octahedral";
    EXPECT_LT(worst, straight ? 1e-12 : name() == "dual-orthographic" ? 0.01 : 1e-3);
}

TEST_P(EverySphereMap, SolidAnglesAreTheShareOfDirectionsThatFallOnTexels) {
    constexpr int kCount = 200000;
    std::vector<int> hits(size_t(map_->texelCount()), 0);
    for (const Vec3f& d : sphericalFibonacci(kCount)) {
        const SpherePoint p = map_->pointFromDirection(d.cast<double>());
        const int x = std::min(int(p.x), map_->faceWidth() - 1),
                  y = std::min(int(p.y), map_->faceHeight() - 1);
        ++hits[size_t((p.face * map_->faceHeight() + y) * map_->faceWidth() + x)];
    }
    for (int texel = 0; texel < map_->texelCount(); ++texel) {
        const double expected = map_->texelSolidAngle(texel) * kCount / (4 * kPi);
        // Nodes of a spiral are spread more evenly than random ones, whose deviation this is.
        EXPECT_NEAR(hits[size_t(texel)], expected, 1 + 2.5 * std::sqrt(expected)) << texel;
    }
}

INSTANTIATE_TEST_SUITE_P(Layouts, EverySphereMap, testing::ValuesIn(allCases()), [](const auto& test) {
    return identifier(test.param.name) + "_" + std::to_string(test.param.size);
});

/// Over sizes: how fast lookups of smooth functions become exact.
class EveryLayout : public testing::TestWithParam<std::string> {};

TEST_P(EveryLayout, ConstantsAreExactAndLinearFunctionsConverge) {
    const std::vector<Vec3f> directions = randomDirections(20000, 5);
    std::vector<double> rms;
    for (const int size : {8, 16, 32, 64}) {
        const auto map = makeSphereMap(GetParam(), size);
        std::array<std::vector<double>, 3> axes;
        for (int axis = 0; axis < 3; ++axis)
            axes[size_t(axis)] = tabulate(*map, [axis](const Vec3d& d) { return d[axis]; });
        const std::vector<double> ones = tabulate(*map, [](const Vec3d&) { return 1.0; });
        double sum = 0;
        for (const Vec3f& direction : directions) {
            const Vec3d d = direction.cast<double>();
            EXPECT_NEAR(lookUp(*map, ones, d), 1, 2e-7);
            for (int axis = 0; axis < 3; ++axis)
                sum += std::pow(lookUp(*map, axes[size_t(axis)], d) - d[axis], 2);
        }
        rms.push_back(std::sqrt(sum / double(3 * directions.size())));
        std::printf("%s, size %d: rms error of linear functions %.3g\n", GetParam().c_str(), size,
                    rms.back());
    }
    // h² inside; h on strips of width h at bends of the surface and where coordinates are clamped: h^1.5 in
    // the mean. The orthographic projection has √h in the outermost texels, which cover √h of the sphere:
    // h^0.75.
    const double exponent = GetParam() == "dual-orthographic" ? 0.74 : 1.4;
    for (size_t i = 1; i < rms.size(); ++i) EXPECT_GT(std::log2(rms[i - 1] / rms[i]), exponent);
}

std::vector<std::string> allNames() {
    std::vector<std::string> names;
    for (const SphereMapFamily& family : sphereMapFamilies()) names.push_back(family.name);
    return names;
}

INSTANTIATE_TEST_SUITE_P(Layouts, EveryLayout, testing::ValuesIn(allNames()),
                         [](const auto& test) { return identifier(test.param); });

}  // namespace
}  // namespace prt
