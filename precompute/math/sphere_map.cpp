// Parameterizations of the sphere: the interface, and the list of those there are. [IwanickiSloan2012,
// Appendix A] compares the first four.
#include "precompute/math/sphere_map.h"

#include <fmt/format.h>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

struct Maker {
    SphereMapFamily family;
    std::unique_ptr<SphereMap> (*make)(const std::string& name, int size);
};

const std::vector<Maker>& makers() {
    static const std::vector<Maker> all = {
        {{"cube", "cube, faces apart (DX9)", 1},
         [](const std::string& name, int size) { return makeCubeMap(name, size, false); }},
        {{"cube-seamless", "cube, seamless (DX10)", 1},
         [](const std::string& name, int size) { return makeCubeMap(name, size, true); }},
        {{"dual-paraboloid", "dual paraboloid", 2}, makeDualParaboloidMap},
        {{"dual-orthographic", "dual orthographic", 2}, makeDualOrthographicMap},
        {{"octahedral", "octahedral", 1}, makeOctahedralMap},
        {{"equal-area-octahedral", "equal-area octahedral", 1}, makeEqualAreaOctahedralMap},
        {{"latitude-longitude", "latitude-longitude", 1}, makeLatLongMap},
        {{"healpix", "HEALPix", 1}, makeHealpixMap}};
    return all;
}

}  // namespace

SphereMap::SphereMap(std::string name, int faceCount, int faceWidth, int faceHeight)
    : name_(std::move(name)), faceCount_(faceCount), faceWidth_(faceWidth), faceHeight_(faceHeight) {}

SpherePoint SphereMap::texelCentre(int texel) const {
    PRT_CHECK(texel >= 0 && texel < texelCount());
    const int row = texel / faceWidth_;
    return {row / faceHeight_, texel % faceWidth_ + 0.5, row % faceHeight_ + 0.5};
}

Vec3d SphereMap::texelDirection(int texel) const { return directionFromPoint(texelCentre(texel)); }

const std::vector<SphereMapFamily>& sphereMapFamilies() {
    static const std::vector<SphereMapFamily> families = [] {
        std::vector<SphereMapFamily> list;
        for (const Maker& maker : makers()) list.push_back(maker.family);
        return list;
    }();
    return families;
}

std::unique_ptr<SphereMap> makeSphereMap(const std::string& name, int size) {
    std::string names;
    for (const Maker& maker : makers()) {
        if (maker.family.name == name) {
            if (size < maker.family.minSize || size > kMaxSphereMapSize)
                throw InputError(
                    fmt::format("sphere map {}", name),
                    fmt::format("size {} is outside {}..{}", size, maker.family.minSize, kMaxSphereMapSize));
            return maker.make(name, size);
        }
        names += (names.empty() ? "" : ", ") + maker.family.name;
    }
    throw InputError(fmt::format("sphere map '{}'", name), "there is none of this name",
                     fmt::format("one of {}", names));
}

}  // namespace prt
