// Rotations allocate no memory.
#include "precompute/math/hsh_rotation.h"
#include "precompute/math/sh_rotation_soa.h"
#include "precompute/math/sh_rotation_taylor.h"
#include "tests/math/allocation_counter.h"
#include "tests/math/sh_rotation_input.h"

namespace prt {
namespace {

using test::allocationsOf;

TEST(RotationAllocations, OfSphericalHarmonicsAreNone) {
    for (const int n : {6, 24}) {
        test::SoaInput input(n, 40, 48, 76);
        const Mat3d& r = input.rotations[0];
        const ShRotationMatrix matrix(r, n);
        const std::span<float> v(input.soaVectors), one = v.first(size_t(shCount(n)));
        rotateSh(r, n, std::span<const float>(one), one);  // tables of the higher bands are made once
        EXPECT_EQ(allocationsOf([&] { rotateSh(r, n, std::span<const float>(one), one); }), 0u);
        EXPECT_EQ(allocationsOf(
                      [&] { rotateShTaylor(r, ShTaylorOrder::Two, n, std::span<const float>(one), one); }),
                  0u);
        EXPECT_EQ(allocationsOf([&] { matrix.apply(std::span<const float>(one), one); }), 0u);
        EXPECT_EQ(allocationsOf([&] { rotateShSoa(input.soaRotations, n, 40, 48, v, v); }), 0u);
        EXPECT_EQ(allocationsOf([&] { rotateShSoa(r, n, 40, 48, v, v); }), 0u);
        EXPECT_EQ(allocationsOf([&] {
                      rotateShTaylorSoa(input.soaRotations, ShTaylorOrder::OneAndHalf, n, 40, 48, v, v);
                  }),
                  0u);
        EXPECT_EQ(allocationsOf([&] { matrix.applySoa(40, 48, v, v); }), 0u);
    }
}

TEST(RotationAllocations, OfHemisphericalHarmonicsAreNone) {
    const HshRotationTable table(6, 5);
    const HshRotationThroughSh through(6, 10);
    const Mat3d r = rotationFromZyz({1, 0.5, -1});
    std::vector<float> v(36, 1.0f);
    EXPECT_EQ(allocationsOf([&] { table.rotateByTable(r, v, v); }), 0u);
    EXPECT_EQ(allocationsOf([&] { table.rotateByDigonRemoval(r, v, v); }), 0u);
    through.rotate(r, v, v);  // tables of the higher bands are made once
    EXPECT_EQ(allocationsOf([&] { through.rotate(r, v, v); }), 0u);
}

}  // namespace
}  // namespace prt
