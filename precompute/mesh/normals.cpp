// Vertex normals weighted by the angle at the vertex: G. Thürmer and C. Wüthrich, "Computing vertex normals
// from polygonal facets", JGT 3(1), 1998, within fans bounded by creases.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/parallel.h"
#include "precompute/mesh/corner_mesh.h"
#include "precompute/mesh/half_edge_mesh.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Renormalises the pool; entries that cannot be are marked unusable.
std::vector<uint8_t> normalisePool(std::vector<Vec3f>& normals, LoadMeshReport& report) {
    std::vector<uint8_t> usable(normals.size(), 1);
    size_t changed = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        const double length = normals[i].cast<double>().norm();
        if (!(length > 1e-12) || !std::isfinite(length)) {
            usable[i] = 0;
            continue;
        }
        // Decimals of text files leave a per mille; more than a percent is worth a count.
        if (std::abs(length - 1) > 1e-2) ++changed;
        if (std::abs(length - 1) > 1e-6) normals[i] = (normals[i].cast<double>() / length).cast<float>();
    }
    countRepair(report, "normals_normalised", changed);
    return usable;
}

/// Cut along creases, so that its vertices are the fans of faces that follow each other smoothly.
HalfEdgeMesh smoothFans(const Adjacency& adjacency, const std::vector<Vec3f>& faceNormal,
                        double creaseAngleDeg) {
    std::vector<uint32_t> twin = adjacency.twin;
    cutCreases(twin, faceNormal,
               float(std::cos(std::clamp(creaseAngleDeg, 0.0, 180.0) * std::numbers::pi / 180) - 1e-6));
    return HalfEdgeMesh(twin);
}

}  // namespace

double cornerAngle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const Vec3d e = (b - a).cast<double>(), f = (c - a).cast<double>();
    return std::atan2(e.cross(f).norm(), e.dot(f));
}

void makeNormals(CornerMesh& mesh, const Adjacency& adjacency, const std::vector<Vec3f>& faceNormal,
                 double creaseAngleDeg, LoadMeshReport& report) {
    const std::vector<uint8_t> usable = normalisePool(mesh.normals, report);
    if (mesh.normal.empty()) mesh.normal.assign(mesh.position.size(), kNone);
    bool complete = true;
    for (uint32_t& n : mesh.normal) {
        if (n != kNone && !usable[n]) n = kNone;
        complete = complete && n != kNone;
    }
    if (complete) return;

    const HalfEdgeMesh fans = smoothFans(adjacency, faceNormal, creaseAngleDeg);
    const std::vector<uint32_t> fanOf = fans.cornerVertices();
    std::vector<uint32_t> normalOfFan(fans.vertexCount(), kNone);
    std::vector<Vec3d> sums;
    for (uint32_t h = 0; h < mesh.position.size(); ++h) {
        throwIfInterruptedAt(h);
        uint32_t& slot = normalOfFan[fanOf[h]];
        if (slot == kNone) {
            slot = uint32_t(sums.size());
            sums.emplace_back(0, 0, 0);
        }
        const auto at = [&](uint32_t corner) -> const Vec3f& {
            return mesh.positions[mesh.position[corner]];
        };
        sums[slot] +=
            cornerAngle(at(h), at(nextCorner(h)), at(previousCorner(h))) * faceNormal[h / 3].cast<double>();
    }
    const auto base = uint32_t(mesh.normals.size());
    for (const Vec3d& sum : sums) mesh.normals.push_back(sum.normalized().cast<float>());
    for (uint32_t h = 0; h < mesh.position.size(); ++h) {
        if (mesh.normal[h] != kNone) continue;
        const uint32_t slot = normalOfFan[fanOf[h]];
        // A fan that wraps round to cancel itself (a fin seen from both sides) keeps the normals of its
        // faces.
        if (sums[slot].norm() < 1e-9) {
            mesh.normal[h] = uint32_t(mesh.normals.size());
            mesh.normals.push_back(faceNormal[h / 3]);
        } else {
            mesh.normal[h] = base + slot;
        }
    }
}

}  // namespace prt
