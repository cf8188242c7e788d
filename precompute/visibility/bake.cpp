// Visibility per texel and per vertex [IwanickiSloan2012, Sec. 3]. Angle weights of corners:
// [ThurmerWuthrich1998]. Sub-points that average over the corner of a face in place of rays from the vertex
// itself follow the aim of [Kavan2011] (a vertex stands for the surface around it), without its least
// squares.
#include "precompute/visibility/bake.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/visibility/find_inside.h"
#include "precompute/visibility/orientations.h"
#include "precompute/visibility/surely_outside.h"
#include "precompute/visibility/trace_blocks.h"

namespace prt {
namespace {

// How far a sub-point lies from its vertex towards the centroid of the face.
constexpr double kInset = 0.3;

// Where a corner of a face touches a vertex.
struct Corner {
    uint32_t triangle;
    double angleRad;
    Vec3d position, normal;
};

using VertexKey = std::array<uint32_t, 6>;
struct VertexKeyHash {
    size_t operator()(const VertexKey& key) const {
        uint64_t hash = 0xcbf29ce484222325ull;
        for (const uint32_t word : key) hash = (hash ^ word) * 0x100000001b3ull;
        return size_t(hash ^ hash >> 32);
    }
};

std::vector<uint32_t> findSameVertices(const Scene& scene) {
    std::unordered_map<VertexKey, uint32_t, VertexKeyHash> first;
    std::vector<uint32_t> sameAs(scene.vertexCount());
    for (uint32_t v = 0; v < scene.vertexCount(); ++v) {
        VertexKey key{};
        for (int k = 0; k < 3; ++k) {  // + 0 turns −0 into 0
            key[size_t(k)] = std::bit_cast<uint32_t>(scene.positions[v][k] + 0.0f);
            if (!scene.normals.empty())
                key[size_t(k) + 3] = std::bit_cast<uint32_t>(scene.normals[v][k] + 0.0f);
        }
        sameAs[v] = first.emplace(key, v).first->second;
    }
    return sameAs;
}

// Corners of every vertex that stands for itself, in order of triangles.
std::vector<std::vector<Corner>> collectCorners(const Scene& scene, const std::vector<uint32_t>& sameAs) {
    std::vector<std::vector<Corner>> corners(scene.vertexCount());
    for (uint32_t t = 0; t < scene.triangleCount(); ++t) {
        std::array<Vec3d, 3> p;
        for (size_t k = 0; k < 3; ++k) p[k] = scene.positions[scene.indices[3 * t + k]].cast<double>();
        const Vec3d cross = (p[1] - p[0]).cross(p[2] - p[0]);
        if (!(cross.norm() > 0)) continue;
        const Vec3d centroid = (p[0] + p[1] + p[2]) / 3;
        for (size_t k = 0; k < 3; ++k) {
            const Vec3d a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
            const double angle = std::atan2(cross.norm(), a.dot(b));
            corners[sameAs[scene.indices[3 * t + k]]].push_back(
                {t, angle, p[k] + kInset * (centroid - p[k]), cross.normalized()});
        }
    }
    return corners;
}

// Of more corners than kMaxSubPoints, those that stand at even steps of the summed angle, all alike.
std::vector<Corner> thinned(const std::vector<Corner>& corners, double sum) {
    if (corners.size() <= size_t(kMaxSubPoints)) return corners;
    std::vector<Corner> kept;
    double passed = 0;
    size_t next = 0;
    for (const Corner& corner : corners) {
        passed += corner.angleRad;
        bool taken = false;
        while (next < size_t(kMaxSubPoints) && passed >= (double(next) + 0.5) / kMaxSubPoints * sum) {
            if (!taken) kept.push_back({corner.triangle, 0, corner.position, corner.normal});
            taken = true;
            kept.back().angleRad += 1;
            ++next;
        }
    }
    return kept;
}

// Directions over the sphere that tell whether a sub-point is inside geometry; half lie above the horizon.
constexpr int kHiddenDirections = 64;

// Non-zero for sub-points inside geometry: as for whole items, with fewer rays.
std::vector<uint8_t> findHiddenParts(const RayCaster& caster, const TexelSurface& surface,
                                     const BakeOptions& options, std::span<const uint8_t> outside) {
    std::vector<uint8_t> hidden(surface.subPoints.size(), 0);
    if (!options.findInside) return hidden;
    std::vector<SurfacePoint> doubtful;
    std::vector<size_t> places;
    for (size_t p = 0; p < hidden.size(); ++p) {
        if (!outside.empty() && outside[surface.subPoints[p].triangle]) continue;
        doubtful.push_back(surface.subPoints[p]);
        places.push_back(p);
    }
    const std::vector<uint8_t> inside =
        findInsidePoints(caster, doubtful, spreadDirections(kHiddenDirections), options.doubleSided);
    for (size_t i = 0; i < places.size(); ++i) hidden[places[i]] = inside[i];
    return hidden;
}

// What the texels' items own.
struct TexelItems {
    std::vector<SurfacePoint> points;
    std::vector<uint32_t> firstPoint, shareEnd;
    std::vector<uint8_t> hidden;  // those that nothing sees
};

// Parts of each texel that can be seen, all where none can; whole texels that nothing hides keep one point.
TexelItems makeTexelItems(const TexelSurface& surface, const std::vector<uint8_t>& hidden) {
    TexelItems items;
    items.points.reserve(surface.parts.size());
    items.shareEnd.reserve(surface.parts.size());
    items.firstPoint.reserve(surface.points.size() + 1);
    for (size_t i = 0; i < surface.points.size(); ++i) {
        items.firstPoint.push_back(uint32_t(items.points.size()));
        const std::span parts(&surface.parts[surface.firstPart[i]],
                              surface.firstPart[i + 1] - surface.firstPart[i]);
        double all = 0, seen = 0;
        size_t seenCount = 0;
        for (const TexelPart& part : parts) {
            all += double(part.share);
            if (hidden[part.subPoint]) continue;
            seen += double(part.share);
            ++seenCount;
        }
        items.hidden.push_back(seenCount == 0);
        if (seenCount == parts.size() && surface.whole[i]) {
            items.points.push_back(surface.points[i]);
            items.shareEnd.push_back(0xffffffffu);
            continue;
        }
        ShareEnds ends(seenCount ? seen : all);
        for (const TexelPart& part : parts) {
            if (seenCount && hidden[part.subPoint]) continue;
            items.points.push_back(surface.subPoints[part.subPoint]);
            items.shareEnd.push_back(ends.next(double(part.share)));
        }
    }
    items.firstPoint.push_back(uint32_t(items.points.size()));
    return items;
}

std::vector<uint8_t> texelOrientations(const TexelSurface& surface) {
    std::vector<uint8_t> orientations(surface.points.size());
    for (size_t t = 0; t < surface.pointOfTexel.size(); ++t) {
        const auto x = uint32_t(t % size_t(surface.width)), y = uint32_t(t / size_t(surface.width));
        if (surface.pointOfTexel[t] != kNoPoint)
            orientations[surface.pointOfTexel[t]] = texelOrientation(x, y);
    }
    return orientations;
}

}  // namespace

BakeResult bakeVisibility(const RayCaster& caster, std::span<const SurfacePoint> points,
                          const BakeOptions& options) {
    BakeItems items;
    items.points = points;
    return bakeItems(caster, items, options, "points");
}

BakeResult bakeTexelVisibility(const RayCaster& caster, const TexelSurface& surface,
                               const BakeOptions& options) {
    const size_t count = surface.points.size();
    PRT_CHECK_EQ(surface.firstPart.size(), count + 1);
    PRT_CHECK_EQ(surface.firstPart.back(), surface.parts.size());
    PRT_CHECK_EQ(surface.whole.size(), count);
    // Looking at faces pays where there are fewer of them than sub-points.
    std::vector<uint8_t> outside;
    if (options.findInside && caster.triangleCount() < surface.subPoints.size())
        outside = findSurelyOutside(caster, options.doubleSided, surface.subPoints.size() / kFacePrice);
    const TexelItems texels = makeTexelItems(surface, findHiddenParts(caster, surface, options, outside));
    BakeItems items;
    if (options.findInside) items.hidden = texels.hidden;
    items.points = texels.points;
    items.firstPoint = texels.firstPoint;
    items.shareEnd = texels.shareEnd;
    std::vector<Vec3f> normals(count);
    std::transform(surface.points.begin(), surface.points.end(), normals.begin(),
                   [](const SurfacePoint& point) { return point.normal; });
    items.normals = normals;
    const std::vector<uint8_t> orientations = texelOrientations(surface);
    items.orientations = orientations;
    return bakeItems(caster, items, options, "points");
}

VertexPoints makeVertexPoints(const Scene& scene) {
    VertexPoints result;
    result.sameAs = findSameVertices(scene);
    const std::vector<std::vector<Corner>> corners = collectCorners(scene, result.sameAs);
    result.firstPoint.reserve(scene.vertexCount() + 1);
    result.normals.assign(scene.vertexCount(), Vec3f::Zero());
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        result.firstPoint.push_back(uint32_t(result.points.size()));
        if (result.sameAs[v] != v) {
            result.normals[v] = result.normals[result.sameAs[v]];
            continue;
        }
        double sum = 0;
        Vec3d normal = Vec3d::Zero();
        for (const Corner& corner : corners[v]) {
            sum += corner.angleRad;
            normal += corner.angleRad * corner.normal;
        }
        if (corners[v].empty()) continue;
        // Faces that cancel each other (two sides of a sheet) leave no mean: the first one's then.
        if (!(normal.norm() > 1e-9)) normal = corners[v][0].normal;
        result.normals[v] = normal.normalized().cast<float>();
        const std::vector<Corner> kept = thinned(corners[v], sum);
        double keptSum = 0;
        for (const Corner& corner : kept) keptSum += corner.angleRad;
        for (const Corner& corner : kept) {
            result.points.push_back(
                {corner.position.cast<float>(), corner.normal.cast<float>(), corner.triangle});
            result.share.push_back(float(corner.angleRad / keptSum));
        }
    }
    result.firstPoint.push_back(uint32_t(result.points.size()));
    return result;
}

BakeResult bakeVertexVisibility(const RayCaster& caster, const VertexPoints& vertices,
                                const BakeOptions& options) {
    const size_t count = vertices.sameAs.size();
    PRT_CHECK_EQ(vertices.firstPoint.size(), count + 1);
    PRT_CHECK_EQ(vertices.share.size(), vertices.points.size());
    // Only vertices that stand for themselves are traced.
    std::vector<uint32_t> owner, first, itemOf(count), shareEnd(vertices.points.size());
    for (uint32_t v = 0; v < count; ++v) {
        if (vertices.sameAs[v] != v) {
            PRT_CHECK_LT(vertices.sameAs[v], v);
            itemOf[v] = itemOf[vertices.sameAs[v]];
            continue;
        }
        itemOf[v] = uint32_t(owner.size());
        owner.push_back(v);
        first.push_back(vertices.firstPoint[v]);
        ShareEnds ends(1);
        for (uint32_t p = vertices.firstPoint[v]; p < vertices.firstPoint[v + 1]; ++p)
            shareEnd[p] = ends.next(double(vertices.share[p]));
    }
    first.push_back(uint32_t(vertices.points.size()));
    std::vector<Vec3f> normals(owner.size());
    std::vector<uint8_t> orientations(owner.size());
    for (size_t i = 0; i < owner.size(); ++i) {
        normals[i] = vertices.normals[owner[i]];
        orientations[i] = vertexOrientation(owner[i]);
    }

    BakeItems items;
    items.points = vertices.points;
    items.firstPoint = first;
    items.shareEnd = shareEnd;
    items.normals = normals;
    items.orientations = orientations;
    const BakeResult baked = bakeItems(caster, items, options, "vertices");

    BakeResult result;
    result.windingSuspect = baked.windingSuspect;
    result.rays = baked.rays;
    result.traceSeconds = baked.traceSeconds;
    result.stages = baked.stages;
    const size_t columns = baked.coefficients.size() / std::max<size_t>(owner.size(), 1);
    result.coefficients.resize(count * columns);
    result.ao.resize(count);
    result.error.resize(count);
    result.inside.resize(count);
    for (size_t v = 0; v < count; ++v) {
        const size_t item = itemOf[v];
        std::copy_n(&baked.coefficients[item * columns], columns, &result.coefficients[v * columns]);
        result.ao[v] = baked.ao[item];
        result.error[v] = baked.error[item];
        result.inside[v] = baked.inside[item];
    }
    return result;
}

}  // namespace prt
