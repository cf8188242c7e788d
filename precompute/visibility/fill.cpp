// Values for points that have none: nearest-neighbour dilation per texel, inverse-distance weights
// [Shepard1968] per vertex.
#include "precompute/visibility/fill.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr int kVertexRounds = 32;

VisibilityMap emptyMap(const PointGrid& grid, int shOrder) {
    VisibilityMap map;
    map.grid = grid;
    map.shOrder = shOrder;
    map.coefficients.assign(grid.count * size_t(shCount(shOrder)), 0.0f);
    map.validity.assign(grid.count, Validity::Empty);
    map.ao.assign(grid.count, 0.0f);
    map.error.assign(grid.count, 0.0f);
    map.normals.assign(grid.count, Vec3f::Zero());
    return map;
}

void copyValue(VisibilityMap& map, size_t from, size_t to) {
    const size_t columns = size_t(shCount(map.shOrder));
    std::copy_n(&map.coefficients[from * columns], columns, &map.coefficients[to * columns]);
    map.ao[to] = map.ao[from];
    map.error[to] = map.error[from];
}

// Neighbour along an edge.
struct Link {
    uint32_t vertex;
    float weight;
};

std::vector<std::vector<Link>> linksOfInside(const Scene& scene, const VertexPoints& vertices,
                                             const std::vector<uint8_t>& inside) {
    std::vector<std::vector<Link>> links(scene.vertexCount());
    for (size_t t = 0; t < scene.triangleCount(); ++t)
        for (size_t k = 0; k < 3; ++k)
            for (const size_t other : {(k + 1) % 3, (k + 2) % 3}) {
                const uint32_t a = vertices.sameAs[scene.indices[3 * t + k]];
                const uint32_t b = vertices.sameAs[scene.indices[3 * t + other]];
                if (!inside[a] || a == b) continue;
                const float length = (scene.positions[a] - scene.positions[b]).norm();
                if (length > 0) links[a].push_back({b, 1 / length});
            }
    return links;
}

}  // namespace

VisibilityMap fillTexels(const TexelSurface& surface, const BakeResult& baked, int shOrder) {
    const size_t texels = size_t(surface.width) * size_t(surface.height);
    const size_t columns = size_t(shCount(shOrder));
    PRT_CHECK_EQ(surface.pointOfTexel.size(), texels);
    PRT_CHECK_EQ(baked.coefficients.size(), surface.points.size() * columns);
    PRT_CHECK_EQ(baked.error.size(), surface.points.size());
    VisibilityMap map = emptyMap({PointDomain::Texel, surface.width, surface.height, texels}, shOrder);
    std::vector<uint8_t> has(texels, 0);
    for (size_t t = 0; t < texels; ++t) {
        const uint32_t point = surface.pointOfTexel[t];
        if (point == kNoPoint) continue;
        std::copy_n(&baked.coefficients[point * columns], columns, &map.coefficients[t * columns]);
        map.ao[t] = baked.ao[point];
        map.error[t] = baked.error[point];
        map.normals[t] = surface.points[point].normal;
        map.validity[t] = baked.inside[point] ? Validity::Inside : Validity::Valid;
        has[t] = map.validity[t] == Validity::Valid;
    }

    const std::vector<uint32_t> fromChart =
        nearestFilledTexel(has, surface.chartOfTexel, surface.width, surface.height, kInsideReachTexels);
    for (size_t t = 0; t < texels; ++t) {
        if (map.validity[t] != Validity::Inside || fromChart[t] == kNoPoint) continue;
        copyValue(map, fromChart[t], t);
        map.validity[t] = Validity::InsideFilled;
        has[t] = 1;
    }

    const std::vector<uint32_t> fromAny =
        nearestFilledTexel(has, {}, surface.width, surface.height, kGutterReachTexels);
    for (size_t t = 0; t < texels; ++t) {
        if (map.validity[t] != Validity::Empty || fromAny[t] == kNoPoint) continue;
        copyValue(map, fromAny[t], t);
        map.normals[t] = map.normals[fromAny[t]];
        map.validity[t] = Validity::GutterFilled;
    }
    return map;
}

VisibilityMap fillVertices(const Scene& scene, const VertexPoints& vertices, const BakeResult& baked,
                           int shOrder) {
    const size_t count = scene.vertexCount(), columns = size_t(shCount(shOrder));
    PRT_CHECK_EQ(baked.coefficients.size(), count * columns);
    PRT_CHECK_EQ(baked.error.size(), count);
    VisibilityMap map = emptyMap(vertexGrid(count), shOrder);
    map.coefficients = baked.coefficients;
    map.ao = baked.ao;
    map.error = baked.error;
    map.normals = vertices.normals;
    for (size_t v = 0; v < count; ++v) map.validity[v] = baked.inside[v] ? Validity::Inside : Validity::Valid;

    const std::vector<std::vector<Link>> links = linksOfInside(scene, vertices, baked.inside);
    for (int round = 0; round < kVertexRounds; ++round) {
        std::vector<size_t> filled;
        for (size_t v = 0; v < count; ++v) {
            if (map.validity[v] != Validity::Inside || vertices.sameAs[v] != v) continue;
            std::vector<float> sum(columns, 0.0f);
            float ao = 0, error = 0, weights = 0;
            for (const Link& link : links[v]) {
                if (map.validity[link.vertex] == Validity::Inside) continue;
                for (size_t c = 0; c < columns; ++c)
                    sum[c] += link.weight * map.coefficients[link.vertex * columns + c];
                ao += link.weight * map.ao[link.vertex];
                error += link.weight * map.error[link.vertex];
                weights += link.weight;
            }
            if (!(weights > 0)) continue;
            for (size_t c = 0; c < columns; ++c) map.coefficients[v * columns + c] = sum[c] / weights;
            map.ao[v] = ao / weights;
            map.error[v] = error / weights;
            filled.push_back(v);
        }
        if (filled.empty()) break;
        for (const size_t v : filled) map.validity[v] = Validity::InsideFilled;
    }
    for (size_t v = 0; v < count; ++v)
        if (const uint32_t same = vertices.sameAs[v]; same != v) {
            copyValue(map, same, v);
            map.validity[v] = map.validity[same];
        }
    return map;
}

}  // namespace prt
