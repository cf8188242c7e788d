// Layouts of the sphere: where they put what, as the table in the header says, and what they refuse.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/error.h"
#include "precompute/math/environment.h"
#include "precompute/math/sphere_map.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d directionAt(const std::string& name, int face, double x, double y) {
    return makeSphereMap(name, 8)->directionFromPoint({face, x, y});
}

TEST(SphereMapLayouts, AreEightAndNamed) {
    std::vector<std::string> names;
    for (const SphereMapFamily& family : sphereMapFamilies()) {
        names.push_back(family.name);
        EXPECT_FALSE(family.title.empty());
        EXPECT_EQ(makeSphereMap(family.name, 4)->name(), family.name);
    }
    EXPECT_THAT(names,
                testing::ElementsAre("cube", "cube-seamless", "dual-paraboloid", "dual-orthographic",
                                     "octahedral", "equal-area-octahedral", "latitude-longitude", "healpix"));
}

TEST(SphereMapLayouts, TexelsAreCountedWithDuplicates) {
    const std::vector<std::pair<std::string, int>> counts = {{"cube", 384},
                                                             {"cube-seamless", 384},
                                                             {"dual-paraboloid", 128},
                                                             {"dual-orthographic", 128},
                                                             {"octahedral", 64},
                                                             {"equal-area-octahedral", 64},
                                                             {"latitude-longitude", 128},
                                                             {"healpix", 768}};
    for (const auto& [name, count] : counts) EXPECT_EQ(makeSphereMap(name, 8)->texelCount(), count) << name;
}

TEST(SphereMapLayouts, SizesOutOfRangeAndUnknownNamesAreInputErrors) {
    for (const SphereMapFamily& family : sphereMapFamilies()) {
        EXPECT_NO_THROW(makeSphereMap(family.name, family.minSize));
        EXPECT_NO_THROW(makeSphereMap(family.name, kMaxSphereMapSize));
        for (const int size : {-1, 0, family.minSize - 1, kMaxSphereMapSize + 1})
            EXPECT_THROW(makeSphereMap(family.name, size), InputError) << family.name << ' ' << size;
    }
    EXPECT_THROW(makeSphereMap("", 8), InputError);
    try {
        makeSphereMap("mercator", 8);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("mercator"), std::string::npos);
        EXPECT_NE(error.remedy().find("dual-paraboloid"), std::string::npos);
    }
}

TEST(DualMaps, PlusZIsTheFirstFaceAndBothMeetAtPlusX) {
    for (const std::string name : {"dual-paraboloid", "dual-orthographic"}) {
        EXPECT_LT((directionAt(name, 0, 4, 4) - Vec3d(0, 0, 1)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 1, 4, 4) - Vec3d(0, 0, -1)).norm(), 1e-15);
        // middles of the ring: right and top
        EXPECT_LT((directionAt(name, 0, 7.5, 4) - Vec3d(1, 0, 0)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 0, 4, 0.5) - Vec3d(0, 1, 0)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 1, 0.5, 4) - Vec3d(1, 0, 0)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 1, 4, 0.5) - Vec3d(0, 1, 0)).norm(), 1e-15);
    }
}

TEST(DualMaps, TheOuterRingOfCentresIsTheEquatorOnBothHalves) {
    for (const std::string name : {"dual-paraboloid", "dual-orthographic"})
        for (const int size : {2, 3, 8}) {
            const auto map = makeSphereMap(name, size);
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const Vec3d d = map->texelDirection(y * size + x);
                    const bool ring = x == 0 || y == 0 || x == size - 1 || y == size - 1;
                    EXPECT_EQ(d.z() == 0, ring);
                    EXPECT_GE(d.z(), 0);
                    const Vec3d other = map->texelDirection((size + y) * size + size - 1 - x);
                    EXPECT_LT((other - Vec3d(d.x(), d.y(), -d.z())).norm(), 1e-15);
                }
            // beyond the ring: the equator
            EXPECT_LT((map->directionFromPoint({0, double(size), 0.5 * size}) - Vec3d(1, 0, 0)).norm(),
                      1e-15);
        }
}

TEST(DualMaps, ProjectionsAreTheParaboloidAndTheOrthographicOne) {
    // on the x axis the concentric map is the identity
    const Vec3d d = Vec3d(std::sin(0.7), 0, std::cos(0.7));
    const double size = 101;
    EXPECT_NEAR(makeSphereMap("dual-paraboloid", 101)->pointFromDirection(d).x,
                0.5 + (size - 1) * (1 + std::tan(0.35)) / 2, 1e-12);
    EXPECT_NEAR(makeSphereMap("dual-orthographic", 101)->pointFromDirection(d).x,
                0.5 + (size - 1) * (1 + std::sin(0.7)) / 2, 1e-12);
    // and circles become squares, angles within an eighth proportional to the way along the side
    const double azimuth = kPi / 4 * 0.3;
    const Vec3d e(std::sin(0.7) * std::cos(azimuth), std::sin(0.7) * std::sin(azimuth), std::cos(0.7));
    const SpherePoint p = makeSphereMap("dual-paraboloid", 101)->pointFromDirection(e);
    EXPECT_NEAR(p.x, 0.5 + (size - 1) * (1 + std::tan(0.35)) / 2, 1e-12);
    EXPECT_NEAR(p.y, 0.5 + (size - 1) * (1 - 0.3 * std::tan(0.35)) / 2, 1e-12);
}

TEST(OctahedralMaps, PlusZIsTheCentreAndMinusZTheCorners) {
    for (const std::string name : {"octahedral", "equal-area-octahedral"}) {
        EXPECT_LT((directionAt(name, 0, 4, 4) - Vec3d(0, 0, 1)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 0, 8, 4) - Vec3d(1, 0, 0)).norm(), 1e-15);
        EXPECT_LT((directionAt(name, 0, 4, 0) - Vec3d(0, 1, 0)).norm(), 1e-15);
        for (const double x : {0, 8})
            for (const double y : {0, 8})
                EXPECT_LT((directionAt(name, 0, x, y) - Vec3d(0, 0, -1)).norm(), 1e-15);
    }
    // the middle of a face of the octahedron, and its mirror image below
    const double third = 8.0 / 6;
    EXPECT_LT((directionAt("octahedral", 0, 4 + third, 4 - third) - Vec3d(1, 1, 1).normalized()).norm(),
              1e-15);
    EXPECT_LT((directionAt("octahedral", 0, 8 - third, third) - Vec3d(1, 1, -1).normalized()).norm(), 1e-15);
    // rings of the equal-area map: 1 − z = r²
    EXPECT_NEAR(directionAt("equal-area-octahedral", 0, 5, 5).z(), 1 - 0.25, 1e-15);
}

TEST(OctahedralMaps, LookupsGoOutOverAnEdgeAndBackInMirrored) {
    for (const std::string name : {"octahedral", "equal-area-octahedral"}) {
        const auto map = makeSphereMap(name, 8);
        for (const SphereTap& tap : map->taps({0, 0, -1})) {  // four corners
            EXPECT_TRUE((tap.texel % 8 == 0 || tap.texel % 8 == 7) &&
                        (tap.texel / 8 == 0 || tap.texel / 8 == 7));
            EXPECT_EQ(tap.weight, 0.25f);
        }
        std::vector<int> texels;
        for (const SphereTap& tap : map->taps(map->directionFromPoint({0, 8, 2.5})))
            if (tap.weight > 1e-6f) texels.push_back(tap.texel);
        EXPECT_THAT(texels, testing::UnorderedElementsAre(2 * 8 + 7, 5 * 8 + 7));
    }
}

TEST(LatLongMap, IsTheEnvironments) {
    const auto map = makeSphereMap("latitude-longitude", 8);
    EXPECT_EQ(map->faceWidth(), 16);
    EXPECT_LT((map->directionFromPoint({0, 8, 4}) - Vec3d(0, 0, 1)).norm(), 1e-15);
    EXPECT_LT((map->directionFromPoint({0, 3, 0}) - Vec3d(0, 1, 0)).norm(), 1e-15);
    EXPECT_LT((map->directionFromPoint({0, 12, 4}) - Vec3d(-1, 0, 0)).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(map->texelSolidAngle(3 * 16 + 5), latLongTexelSolidAngle(3, 16, 8));
    // repeats in longitude
    std::vector<int> texels;
    for (const SphereTap& tap : map->taps(map->directionFromPoint({0, 16, 2.5})))
        if (tap.weight > 1e-6f) texels.push_back(tap.texel);
    EXPECT_THAT(texels, testing::UnorderedElementsAre(2 * 16, 2 * 16 + 15));
}

/// Centres of HEALPix's pixels, ring by ring [Gorski2005, Eqs. 4, 5, 8, 9].
std::vector<Vec3d> healpixRings(int side) {
    std::vector<Vec3d> centres;
    const auto add = [&](double z, double azimuth) {
        const double radius = std::sqrt(1 - z * z);
        centres.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
    };
    for (int i = 1; i < side; ++i)
        for (int j = 1; j <= 4 * i; ++j)
            for (const double sign : {1.0, -1.0})
                add(sign * (1 - double(i * i) / (3.0 * side * side)), kPi / (2 * i) * (j - 0.5));
    for (int i = side; i <= 3 * side; ++i)
        for (int j = 1; j <= 4 * side; ++j)
            add(4.0 / 3 - 2.0 * i / (3.0 * side), kPi / (2 * side) * (j - 0.5 * ((i - side + 1) % 2)));
    return centres;
}

TEST(HealpixMap, PixelsAreThoseOfTheRingScheme) {
    for (const int side : {1, 2, 3, 8}) {
        const auto map = makeSphereMap("healpix", side);
        const std::vector<Vec3d> expected = healpixRings(side);
        ASSERT_EQ(int(expected.size()), map->texelCount());
        std::vector<int> hits(expected.size(), 0);
        for (int texel = 0; texel < map->texelCount(); ++texel) {
            const Vec3d d = map->texelDirection(texel);
            for (size_t k = 0; k < expected.size(); ++k)
                if ((expected[k] - d).norm() < 1e-14) ++hits[k];
        }
        EXPECT_THAT(hits, testing::Each(1)) << side;
    }
}

TEST(HealpixMap, FacesAndCoordinatesAreThoseOfTheNestedScheme) {
    // face 0 between longitudes 0 and 90°: south corner on the equator, x to the north-east, y to the
    // north-west
    EXPECT_LT((directionAt("healpix", 0, 0, 0) - Vec3d(1, 1, 0).normalized()).norm(), 1e-15);
    EXPECT_LT((directionAt("healpix", 0, 8, 8) - Vec3d(0, 0, 1)).norm(), 1e-15);
    const double rim = std::sqrt(5.0) / 3;
    EXPECT_LT((directionAt("healpix", 0, 8, 0) - Vec3d(0, rim, 2.0 / 3)).norm(), 1e-15);
    EXPECT_LT((directionAt("healpix", 0, 0, 8) - Vec3d(rim, 0, 2.0 / 3)).norm(), 1e-15);
    for (int k = 0; k < 4; ++k) {
        const double centred = kPi / 2 * k, between = centred + kPi / 4;
        EXPECT_LT(
            (directionAt("healpix", 4 + k, 4, 4) - Vec3d(std::cos(centred), std::sin(centred), 0)).norm(),
            1e-15);
        EXPECT_LT(
            (directionAt("healpix", 8 + k, 8, 8) - Vec3d(std::cos(between), std::sin(between), 0)).norm(),
            1e-15);
        EXPECT_LT((directionAt("healpix", 8 + k, 0, 0) - Vec3d(0, 0, -1)).norm(), 1e-15);
    }
}

TEST(HealpixMap, WhereThreeFacesMeetThreeTexelsCount) {
    const auto map = makeSphereMap("healpix", 8);
    std::vector<int> faces;
    for (const SphereTap& tap : map->taps(map->directionFromPoint({0, 8, 0}))) {
        if (tap.weight == 0) continue;
        EXPECT_NEAR(tap.weight, 1.0f / 3, 1e-6f);
        faces.push_back(tap.texel / 64);
    }
    EXPECT_THAT(faces, testing::UnorderedElementsAre(0, 1, 5));
    faces.clear();
    for (const SphereTap& tap : map->taps({0, 0, 1})) {
        EXPECT_EQ(tap.weight, 0.25f);
        faces.push_back(tap.texel / 64);
    }
    EXPECT_THAT(faces, testing::UnorderedElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace prt
