// Points uniform over triangles by the square root map [PharrJakobHumphreys2016, Sec. 13.6.5].
#include "tools/measure/surface_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "precompute/base/error.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {
namespace {

constexpr int kInsideRays = 64;  // tell which points are dark enough to be looked at

}  // namespace

std::vector<SurfacePoint> randomSurfacePoints(const Scene& scene, size_t count, uint64_t seed) {
    std::vector<double> area(scene.triangleCount());
    for (size_t t = 0; t < area.size(); ++t) {
        std::array<Vec3d, 3> p;
        for (size_t k = 0; k < 3; ++k) p[k] = scene.positions[scene.indices[3 * t + k]].cast<double>();
        area[t] = (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    }
    std::vector<double> sums(area.size());
    std::partial_sum(area.begin(), area.end(), sums.begin());
    if (sums.empty() || !(sums.back() > 0))
        throw InputError("the mesh", "has no area", "give a mesh with triangles");
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
    std::vector<SurfacePoint> points;
    while (points.size() < count) {
        const auto place = std::upper_bound(sums.begin(), sums.end(), uniform() * sums.back());
        const size_t t = std::min(size_t(place - sums.begin()), sums.size() - 1);
        const double root = std::sqrt(uniform()), v = uniform();
        Vec3d position = Vec3d::Zero();
        const std::array<double, 3> weights{1 - root, root * (1 - v), root * v};
        for (size_t k = 0; k < 3; ++k)
            position += weights[k] * scene.positions[scene.indices[3 * t + k]].cast<double>();
        const Vec3f normal = triangleNormal(scene, t);
        if (normal != Vec3f::Zero()) points.push_back({position.cast<float>(), normal, uint32_t(t)});
    }
    return points;
}

std::vector<SurfacePoint> outsidePoints(const RayCaster& caster, const Scene& scene, size_t count,
                                        uint64_t seed) {
    const std::vector<SurfacePoint> points = randomSurfacePoints(scene, count, seed);
    BakeOptions options;
    options.shOrder = 1;
    options.rays = kInsideRays;
    const BakeResult baked = bakeVisibility(caster, points, options);
    std::vector<SurfacePoint> outside;
    for (size_t i = 0; i < points.size(); ++i)
        if (!baked.inside[i]) outside.push_back(points[i]);
    if (outside.empty())
        throw InputError("the mesh", "has no point outside of itself", "turn its faces outwards");
    return outside;
}

std::vector<float> traceVisibility(const RayCaster& caster, const SurfacePoint& point,
                                   std::span<const Vec3f> directions) {
    std::vector<uint32_t> facing;
    std::vector<Vec3f> rays;
    for (size_t k = 0; k < directions.size(); ++k)
        if (point.normal.dot(directions[k]) > 0) {
            facing.push_back(uint32_t(k));
            rays.push_back(directions[k]);
        }
    std::vector<uint8_t> blocked(rays.size());
    caster.occluded(caster.offsetOrigin(point.position, point.normal), rays, blocked);
    std::vector<float> visible(directions.size(), 0.0f);
    for (size_t j = 0; j < facing.size(); ++j) visible[facing[j]] = blocked[j] ? 0.0f : 1.0f;
    return visible;
}

}  // namespace prt::tools
