// Half-edge pairing over welded positions. Edges are found by counting sort on their lower vertex, so the
// cost is linear in the triangles whatever the valence. The idea of a triangle soup with per-corner links is
// that of J. Rossignac, "3D compression made simple: Edgebreaker with Zip & Wrap on a corner-table", SMI
// 2001.
#include "precompute/mesh/topology.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/base/parallel.h"
#include "precompute/mesh/index_table.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

constexpr size_t kFacesPerBlock = 1 << 15;

/// Half-edges between one pair of vertices.
struct EdgeGroup {
    std::span<const uint32_t> halfEdges;
    std::span<const uint32_t> corners;
    std::span<const Vec3f> normals;

    bool sameDirection(uint32_t a, uint32_t b) const { return corners[a] == corners[b]; }
    float flatness(uint32_t a, uint32_t b) const { return normals[a / 3].dot(normals[b / 3]); }
};

/// Groups larger than this (a book of pages, say) stay unpaired: pairing is quadratic in them.
constexpr size_t kLargestPairedGroup = 64;

void pairNonManifold(const EdgeGroup& group, std::vector<uint32_t>& twin) {
    const auto& edges = group.halfEdges;
    if (edges.size() > kLargestPairedGroup) return;
    for (;;) {
        float best = -2;
        uint32_t bestA = kNone, bestB = kNone;
        for (size_t i = 0; i < edges.size(); ++i)
            for (size_t j = i + 1; j < edges.size(); ++j) {
                const uint32_t a = edges[i], b = edges[j];
                if (twin[a] != kNone || twin[b] != kNone || group.sameDirection(a, b)) continue;
                const float flat = group.flatness(a, b);
                if (flat > best) best = flat, bestA = a, bestB = b;
            }
        // Sheets that fold back onto themselves are two sides of one wall, not neighbours.
        if (bestA == kNone || best < -0.5f) return;
        twin[bestA] = bestB;
        twin[bestB] = bestA;
    }
}

}  // namespace

std::vector<uint32_t> weldPositions(std::span<const Vec3f> positions, uint32_t& count) {
    std::vector<uint32_t> id(positions.size());
    std::vector<uint32_t> firstOf;
    IndexTable table(positions.size() / 2);
    for (size_t i = 0; i < positions.size(); ++i) {
        throwIfInterruptedAt(i);
        const Vec3f& p = positions[i];
        const uint64_t hash = mixHash(mixHash(floatKey(p.x()), floatKey(p.y())), floatKey(p.z()));
        const auto next = uint32_t(firstOf.size());
        id[i] =
            table.findOrInsert(hash, next, [&](uint32_t other) { return positions[firstOf[other]] == p; });
        if (id[i] == next) firstOf.push_back(uint32_t(i));
    }
    count = uint32_t(firstOf.size());
    return id;
}

Vec3d triangleCross(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d origin = a.cast<double>();
    return (b.cast<double>() - origin).cross(c.cast<double>() - origin);
}

std::vector<Vec3f> faceNormals(std::span<const Vec3f> positions, std::span<const uint32_t> corners) {
    std::vector<Vec3f> normals(corners.size() / 3);
    parallelFor(normals.size(), kFacesPerBlock, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            const Vec3d cross = triangleCross(positions[corners[3 * t]], positions[corners[3 * t + 1]],
                                              positions[corners[3 * t + 2]]);
            const double length = cross.norm();
            normals[t] = length > 0 ? Vec3f((cross / length).cast<float>()) : Vec3f(0, 0, 0);
        }
    });
    return normals;
}

Adjacency pairHalfEdges(std::span<const uint32_t> corners, uint32_t vertexCount,
                        std::span<const Vec3f> normals) {
    Adjacency result;
    const auto count = uint32_t(corners.size());
    result.twin.assign(count, kNone);
    const auto lower = [&](uint32_t h) { return std::min(corners[h], corners[nextCorner(h)]); };
    const auto upper = [&](uint32_t h) { return std::max(corners[h], corners[nextCorner(h)]); };

    std::vector<uint32_t> first(size_t(vertexCount) + 1, 0);
    for (uint32_t h = 0; h < count; ++h) ++first[lower(h) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<uint32_t> byLower(count);
    {
        std::vector<uint32_t> cursor(first.begin(), first.end() - 1);
        for (uint32_t h = 0; h < count; ++h) byLower[cursor[lower(h)]++] = h;
    }
    for (uint32_t v = 0; v < vertexCount; ++v) {
        throwIfInterruptedAt(v);
        const auto begin = byLower.begin() + first[v], end = byLower.begin() + first[v + 1];
        std::sort(begin, end, [&](uint32_t a, uint32_t b) {
            const uint32_t ua = upper(a), ub = upper(b);
            return ua != ub ? ua < ub : a < b;
        });
        for (auto it = begin; it != end;) {
            auto stop = it + 1;
            while (stop != end && upper(*stop) == upper(*it)) ++stop;
            const EdgeGroup group{{it, stop}, corners, normals};
            if (group.halfEdges.size() == 1) {
                ++result.boundaryEdges;
            } else if (group.halfEdges.size() > 2) {
                ++result.nonManifoldEdges;
                pairNonManifold(group, result.twin);
            } else if (group.sameDirection(it[0], it[1])) {
                ++result.inconsistentEdges;
            } else {
                result.twin[it[0]] = it[1];
                result.twin[it[1]] = it[0];
            }
            it = stop;
        }
    }
    return result;
}

void cutCreases(std::vector<uint32_t>& twin, std::span<const Vec3f> normals, float cosine) {
    for (uint32_t h = 0; h < twin.size(); ++h) {
        const uint32_t other = twin[h];
        if (other == kNone || h > other || normals[h / 3].dot(normals[other / 3]) >= cosine) continue;
        twin[h] = twin[other] = kNone;
    }
}

DisjointSets::DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

uint32_t DisjointSets::find(uint32_t item) {
    while (parent_[item] != item) {
        parent_[item] = parent_[parent_[item]];
        item = parent_[item];
    }
    return item;
}

void DisjointSets::unite(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
}

}  // namespace prt
