// Repair of faces: what is damaged without harm is dropped and counted, what would make wrong pictures is
// refused. Kinds of damage after M. Attene, M. Campen, L. Kobbelt, "Polygon Mesh Repairing", ACM CSUR 45(2),
// 2013.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/corner_mesh.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

constexpr size_t kBlock = 1 << 15;

/// No height, measured against the longest edge and against the rounding of the coordinates: such a triangle
/// has no normal worth the name.
bool isDegenerate(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const double doubleArea = triangleCross(a, b, c).norm();
    const double longest = std::sqrt(double(std::max({(b.cast<double>() - a.cast<double>()).squaredNorm(),
                                                      (c.cast<double>() - b.cast<double>()).squaredNorm(),
                                                      (a.cast<double>() - c.cast<double>()).squaredNorm()})));
    const float largest =
        std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
    constexpr double kHalfUlp = 1.0 / (1 << 25);
    return !(doubleArea > longest * (1e-7 * longest + kHalfUlp * double(largest)));
}

/// Keeps the triangles that are marked, in order.
template <class T>
void compact(std::vector<T>& values, const std::vector<uint8_t>& drop, size_t perTriangle) {
    if (values.empty()) return;
    size_t to = 0;
    for (size_t t = 0; t < drop.size(); ++t) {
        if (drop[t]) continue;
        for (size_t k = 0; k < perTriangle; ++k) values[to++] = values[t * perTriangle + k];
    }
    values.resize(to);
}

void dropTriangles(CornerMesh& mesh, const std::vector<uint8_t>& drop) {
    compact(mesh.position, drop, 3);
    compact(mesh.normal, drop, 3);
    compact(mesh.texcoord, drop, 3);
    compact(mesh.uv1Index, drop, 3);
    compact(mesh.tangent, drop, 3);
    compact(mesh.material, drop, 1);
}

void checkPositions(const CornerMesh& mesh, const std::string& where) {
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const Vec3f& p = mesh.positions[v];
        if (!p.allFinite())
            throw InputError(where,
                             fmt::format("vertex {} has a position that is not finite ({}, {}, {})", v, p.x(),
                                         p.y(), p.z()),
                             "re-export the mesh");
    }
}

void weld(CornerMesh& mesh) {
    uint32_t count = 0;
    const std::vector<uint32_t> id = weldPositions(mesh.positions, count);
    std::vector<Vec3f> unique(count);
    for (size_t v = mesh.positions.size(); v-- > 0;) unique[id[v]] = mesh.positions[v];
    mesh.positions.swap(unique);
    for (uint32_t& p : mesh.position) p = id[p];
}

void dropDegenerate(CornerMesh& mesh, const std::string& where, LoadMeshReport& report) {
    const size_t triangles = mesh.triangleCount();
    std::vector<uint8_t> drop(triangles, 0);
    parallelFor(triangles, kBlock, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            const uint32_t a = mesh.position[3 * t], b = mesh.position[3 * t + 1],
                           c = mesh.position[3 * t + 2];
            drop[t] = a == b || b == c || c == a ||
                      isDegenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
        }
    });
    const auto dropped = size_t(std::count(drop.begin(), drop.end(), uint8_t(1)));
    if (dropped == triangles)
        throw InputError(where, fmt::format("none of its {} triangles has an area", triangles),
                         "check the scale and the export of the mesh");
    if (dropped > 0) dropTriangles(mesh, drop);
    countRepair(report, "degenerate_faces_dropped", dropped);
}

/// A triangle by its corners from the lowest one on, and whether that reverses nothing.
struct FaceKey {
    uint32_t low, middle, high;
    bool even;  ///< winding: low, middle, high is a rotation of the corners
    uint32_t triangle;
    bool sameFace(const FaceKey& o) const { return low == o.low && middle == o.middle && high == o.high; }
};

FaceKey faceKey(const CornerMesh& mesh, uint32_t triangle) {
    std::array<uint32_t, 3> c{mesh.position[3 * size_t(triangle)], mesh.position[3 * size_t(triangle) + 1],
                              mesh.position[3 * size_t(triangle) + 2]};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    const bool even = c[1] < c[2];
    return {c[0], std::min(c[1], c[2]), std::max(c[1], c[2]), even, triangle};
}

void dropDuplicates(CornerMesh& mesh, LoadMeshReport& report) {
    const size_t triangles = mesh.triangleCount();
    std::vector<uint32_t> first(mesh.positions.size() + 1, 0), byLow(triangles);
    const auto lowOf = [&](size_t t) {
        return std::min({mesh.position[3 * t], mesh.position[3 * t + 1], mesh.position[3 * t + 2]});
    };
    for (size_t t = 0; t < triangles; ++t) ++first[lowOf(t) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<uint32_t> cursor(first.begin(), first.end() - 1);
    for (size_t t = 0; t < triangles; ++t) byLow[cursor[lowOf(t)]++] = uint32_t(t);

    std::vector<uint8_t> drop(triangles, 0);
    size_t dropped = 0, pairs = 0;
    std::vector<FaceKey> keys;
    for (size_t v = 0; v + 1 < first.size(); ++v) {
        throwIfInterruptedAt(v);
        if (first[v + 1] - first[v] < 2) continue;
        keys.clear();
        for (uint32_t i = first[v]; i < first[v + 1]; ++i) keys.push_back(faceKey(mesh, byLow[i]));
        std::sort(keys.begin(), keys.end(), [](const FaceKey& a, const FaceKey& b) {
            if (a.middle != b.middle) return a.middle < b.middle;
            if (a.high != b.high) return a.high < b.high;
            if (a.even != b.even) return a.even;
            return a.triangle < b.triangle;
        });
        for (size_t i = 1; i < keys.size(); ++i) {
            if (!keys[i].sameFace(keys[i - 1])) continue;
            if (keys[i].even != keys[i - 1].even) {
                ++pairs;
            } else {
                drop[keys[i].triangle] = 1;
                ++dropped;
            }
        }
    }
    if (dropped > 0) dropTriangles(mesh, drop);
    countRepair(report, "duplicate_faces_dropped", dropped);
    countRepair(report, "double_sided_face_pairs", pairs);
}

}  // namespace

void countRepair(LoadMeshReport& report, const char* kind, size_t count) {
    if (count > 0) report.counts[kind] += count;
}

void repairFaces(CornerMesh& mesh, const std::string& where, LoadMeshReport& report) {
    checkPositions(mesh, where);
    if (mesh.triangleCount() == 0)
        throw InputError(where, "has no faces", "export it as a polygon mesh, not as points or curves");
    std::vector<uint8_t> used(mesh.positions.size(), 0);
    for (uint32_t p : mesh.position) used[p] = 1;
    countRepair(report, "isolated_vertices_dropped",
                size_t(std::count(used.begin(), used.end(), uint8_t(0))));
    weld(mesh);
    dropDegenerate(mesh, where, report);
    dropDuplicates(mesh, report);
}

}  // namespace prt
