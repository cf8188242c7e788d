// Points of a bundle as the bake saw them [IwanickiSloan2012, Sec. 3].
#include "tools/measure/error_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/base/error.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/visibility/bake_items.h"
#include "precompute/visibility/find_inside.h"
#include "tools/measure/surface_points.h"

namespace prt::tools {
namespace {

constexpr const char *kVisibility = "visibility.exr", *kPca = "pca.exr", *kMesh = "mesh.glb";
// Directions that tell which parts of a texel are inside geometry, as the bake has it.
constexpr int kHiddenDirections = 64;
// Share of points whose normal may differ from the file's: rounding of a rasteriser, no other mesh.
constexpr double kOtherNormals = 0.01;

bool lessByNormal(const Vec3f& a, const Vec3f& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// Evenly spread over the candidates, then in the order of their normals.
std::vector<uint32_t> choose(const std::vector<uint32_t>& candidates, const std::vector<Vec3f>& normals,
                             size_t most) {
    const size_t count = most == 0 ? candidates.size() : std::min(most, candidates.size());
    std::vector<uint32_t> places;
    for (size_t k = 0; k < count; ++k) places.push_back(candidates[k * candidates.size() / count]);
    std::stable_sort(places.begin(), places.end(),
                     [&](uint32_t a, uint32_t b) { return lessByNormal(normals[a], normals[b]); });
    return places;
}

// Appends parts as a point of its own, with the shares that the bake rounds them to.
class PartList {
  public:
    explicit PartList(VertexPoints& parts) : parts_(parts) { parts_.firstPoint = {0}; }

    void add(const Vec3f& normal, std::span<const SurfacePoint> points, std::span<const double> shares) {
        double sum = 0;
        for (const double share : shares) sum += share;
        ShareEnds ends(sum);
        double passed = 0;
        for (size_t k = 0; k < points.size(); ++k) {
            const double upTo = k + 1 < points.size() ? double(ends.next(shares[k])) * 0x1p-32 : 1.0;
            parts_.points.push_back(points[k]);
            parts_.share.push_back(float(upTo - passed));
            passed = upTo;
        }
        parts_.firstPoint.push_back(uint32_t(parts_.points.size()));
        parts_.sameAs.push_back(uint32_t(parts_.sameAs.size()));
        parts_.normals.push_back(normal);
    }

  private:
    VertexPoints& parts_;
};

void checkMesh(size_t others, size_t candidates, size_t valid) {
    if (valid == 0)
        throw InputError(kVisibility, "has no valid point", "bake a mesh with faces that can be seen");
    if (candidates == 0 || double(others) > kOtherNormals * double(valid))
        throw InputError(
            kMesh,
            fmt::format("{} of {} points lie elsewhere on the mesh than when it was baked", others, valid),
            "renew the bundle with prt precompute");
}

// Valid points whose normal on the mesh is that of the file.
template <class NormalOf>
std::vector<uint32_t> candidates(const VisibilityMap& map, const NormalOf& normalOf) {
    std::vector<uint32_t> result;
    size_t valid = 0;
    for (uint32_t i = 0; i < map.validity.size(); ++i) {
        if (map.validity[i] != Validity::Valid || map.normals[i].squaredNorm() < 0.5f) continue;
        ++valid;
        if (normalOf(i).dot(map.normals[i]) > 0.9999f) result.push_back(i);
    }
    checkMesh(valid - result.size(), result.size(), valid);
    return result;
}

JudgedPoints judgedTexels(const JudgedBundle& bundle, const RayCaster& caster, size_t most) {
    const VisibilityMap& map = bundle.visibility;
    const TexelSurface surface = rasterizeTexels(bundle.scene, map.grid.width, map.grid.height);
    const auto normalOf = [&](uint32_t texel) -> Vec3f {
        const uint32_t point = surface.pointOfTexel[texel];
        return point == kNoPoint ? Vec3f::Zero() : surface.points[point].normal;
    };
    JudgedPoints result;
    result.place = choose(candidates(map, normalOf), map.normals, most);
    result.chart = surface.chartOfTexel;

    std::vector<SurfacePoint> parts;
    std::vector<double> shares;
    std::vector<size_t> first{0};
    for (const uint32_t texel : result.place) {
        const uint32_t point = surface.pointOfTexel[texel];
        for (uint32_t p = surface.firstPart[point]; p < surface.firstPart[point + 1]; ++p) {
            parts.push_back(surface.subPoints[surface.parts[p].subPoint]);
            shares.push_back(double(surface.parts[p].share));
        }
        first.push_back(parts.size());
    }
    const std::vector<uint8_t> hidden = findInsidePoints(caster, parts, spreadDirections(kHiddenDirections),
                                                         doubleSidedTriangles(bundle.scene));
    PartList list(result.parts);
    std::vector<SurfacePoint> seen;
    std::vector<double> seenShares;
    for (size_t k = 0; k < result.place.size(); ++k) {
        const uint32_t point = surface.pointOfTexel[result.place[k]];
        seen.clear();
        seenShares.clear();
        for (size_t p = first[k]; p < first[k + 1]; ++p) {
            if (hidden[p]) continue;
            seen.push_back(parts[p]);
            seenShares.push_back(shares[p]);
        }
        const bool isWhole = surface.whole[point] && seen.size() == first[k + 1] - first[k];
        if (isWhole || seen.empty()) {  // valid, so that its own point is outside
            seen = {surface.points[point]};
            seenShares = {1};
        }
        list.add(surface.points[point].normal, seen, seenShares);
    }
    return result;
}

JudgedPoints judgedVertices(const JudgedBundle& bundle, size_t most) {
    const VertexPoints vertices = makeVertexPoints(bundle.scene);
    const VisibilityMap& map = bundle.visibility;
    if (vertices.sameAs.size() != map.grid.count)
        throw InputError(
            kMesh,
            fmt::format("has {} vertices, {} has {}", vertices.sameAs.size(), kVisibility, map.grid.count),
            "renew the bundle with prt precompute");
    const auto normalOf = [&](uint32_t vertex) { return vertices.normals[vertex]; };
    JudgedPoints result;
    result.place = choose(candidates(map, normalOf), map.normals, most);
    PartList list(result.parts);
    for (const uint32_t vertex : result.place) {
        const uint32_t owner = vertices.sameAs[vertex], begin = vertices.firstPoint[owner],
                       count = vertices.firstPoint[owner + 1] - begin;
        const std::vector<double> shares(vertices.share.begin() + begin,
                                         vertices.share.begin() + begin + count);
        list.add(vertices.normals[vertex], std::span(vertices.points).subspan(begin, count), shares);
    }
    return result;
}

}  // namespace

JudgedBundle readJudgedBundle(const std::string& path) {
    const Bundle bundle = Bundle::open(path);
    for (const char* name : {kMesh, kVisibility}) bundle.require(name, "prt precompute");
    JudgedBundle result;
    result.scene = readGltf(bundle.pathOf(kMesh).string());
    result.visibility = readVisibilityFile(bundle.pathOf(kVisibility).string());
    result.bakeCommand = bundle.find(kVisibility)->madeBy;
    if (!bundle.find(kPca)) return result;
    bundle.require(kPca, fmt::format("prt compress {}", path));
    result.pca = readPcaFile(bundle.pathOf(kPca).string());
    const auto fit = result.pca->attributes.find("weightsFit");
    result.compressedWith = fit == result.pca->attributes.end() ? "plain" : fit->second;
    return result;
}

JudgedPoints judgedPoints(const JudgedBundle& bundle, const RayCaster& caster, size_t most) {
    return bundle.visibility.grid.domain == PointDomain::Texel ? judgedTexels(bundle, caster, most)
                                                               : judgedVertices(bundle, most);
}

std::vector<float> bakeJudgedPoints(const RayCaster& caster, const JudgedPoints& points, int shOrder,
                                    int rays, const Projection& projection) {
    BakeOptions options;
    options.shOrder = shOrder;
    options.rays = rays;
    options.projection = projection;
    options.findInside = false;
    return bakeVertexVisibility(caster, points.parts, options).coefficients;
}

std::vector<float> traceJudgedPoint(const RayCaster& caster, const JudgedPoints& points, size_t point,
                                    std::span<const Vec3f> directions) {
    const uint32_t begin = points.parts.firstPoint[point], end = points.parts.firstPoint[point + 1];
    std::vector<float> sum(directions.size(), 0.0f);
    for (uint32_t p = begin; p < end; ++p) {
        const std::vector<float> visible = traceVisibility(caster, points.parts.points[p], directions);
        for (size_t k = 0; k < sum.size(); ++k) sum[k] += points.parts.share[p] * visible[k];
    }
    return sum;
}

}  // namespace prt::tools
