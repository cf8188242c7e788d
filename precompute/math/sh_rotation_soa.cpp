// Rotation of spherical-harmonic expansions, sixteen at a time: the bands of sh_rotation_bands.h on vectors
// of sixteen floats [Kautz2002], [Krivanek2006, Sec. 2.2], [PinchonHoggan2007].
#include "precompute/math/sh_rotation_soa.h"

#include "precompute/base/parallel.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/math/sh_rotation_lanes.h"

namespace prt {
namespace {

using namespace detail;

PRT_TARGET_CLONES void rotateEach(int shOrder, const ConstLaneRows& rotations, const ConstLaneRows& in,
                                  const LaneRows& out, LaneBits& allRotations) {
    Lanes r[9];
    loadRotations(rotations, r, allRotations);
    LaneTurns turns;
    decompose(r, turns);
    ZyzMultiples<Lanes> angles;
    fillLaneMultiples(turns, shOrder, angles);
    rotateLanes(shOrder, angles, in, out);
}

PRT_TARGET_CLONES void rotateAll(int shOrder, const ZyzMultiples<float>& angles, const ConstLaneRows& in,
                                 const LaneRows& out) {
    rotateLanes(shOrder, angles, in, out);
}

}  // namespace

void rotateShSoa(std::span<const float> rotations, int shOrder, size_t count, size_t stride,
                 std::span<const float> in, std::span<float> out) {
    LaneBits allRotations = ~LaneBits{};
    if (count > 0) PRT_CHECK(!rotations.empty());
    forEachLanes(rotations, shOrder, count, stride, in, out,
                 [&](const ConstLaneRows& r, const ConstLaneRows& from, const LaneRows& to) {
                     rotateEach(shOrder, r, from, to, allRotations);
                 });
    checkAllRotations(allRotations);
}

void rotateShSoa(const Mat3d& targetFromSource, int shOrder, size_t count, size_t stride,
                 std::span<const float> in, std::span<float> out) {
    const ZyzAngles angles = zyzFromRotation(targetFromSource);
    ZyzMultiples<float> multiples;
    for (int m = 1; m < shOrder; ++m) {
        const double a[3] = {angles.alphaRad, angles.betaRad, angles.gammaRad};
        for (int i = 0; i < 3; ++i) {
            multiples.cosine[m][i] = float(std::cos(m * a[i]));
            multiples.sine[m][i] = float(std::sin(m * a[i]));
        }
    }
    forEachLanes({}, shOrder, count, stride, in, out,
                 [&](const ConstLaneRows&, const ConstLaneRows& from, const LaneRows& to) {
                     rotateAll(shOrder, multiples, from, to);
                 });
}

}  // namespace prt
