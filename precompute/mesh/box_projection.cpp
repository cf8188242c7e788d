// Texture coordinates by box projection: each triangle onto the side of a box that its normal points to most.
#include <array>
#include <cmath>

#include "precompute/base/parallel.h"
#include "precompute/mesh/corner_mesh.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Right and up of the image on a side of the box, as seen from outside.
struct BoxSide {
    Vec3d right, up;
};

BoxSide boxSide(const Vec3f& normal) {
    // The up axis wins ties, then x: slopes of exactly 45° must not flicker with rounding.
    constexpr float kTie = 1e-4f;
    const float x = std::abs(normal.x()), y = std::abs(normal.y()), z = std::abs(normal.z());
    const auto sign = [](float value) { return value < 0 ? -1.0 : 1.0; };
    if (y + kTie >= x && y + kTie >= z) return {{1, 0, 0}, {0, 0, -sign(normal.y())}};
    if (x + kTie >= z) return {{0, 0, -sign(normal.x())}, {0, 1, 0}};
    return {{sign(normal.z()), 0, 0}, {0, 1, 0}};
}

}  // namespace

void makeTexcoords(CornerMesh& mesh, const std::vector<Vec3f>& faceNormal, double uvScale) {
    if (mesh.texcoord.empty()) mesh.texcoord.assign(mesh.position.size(), kNone);
    Vec3f low = mesh.positions[mesh.position[0]];
    for (uint32_t p : mesh.position) low = low.cwiseMin(mesh.positions[p]);
    // Whole tiles towards the origin of texture space: far from the world's, float coordinates would be
    // coarse.
    const Vec3d origin = (low.cast<double>() / uvScale).array().floor();

    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        throwIfInterruptedAt(t);
        uint32_t* index = mesh.texcoord.data() + 3 * t;
        bool complete = true;
        for (size_t k = 0; k < 3; ++k)
            complete = complete && index[k] != kNone && mesh.uv0[index[k]].allFinite();
        if (complete) continue;
        const BoxSide side = boxSide(faceNormal[t]);
        for (size_t k = 0; k < 3; ++k) {
            const Vec3d p = mesh.positions[mesh.position[3 * t + k]].cast<double>() / uvScale - origin;
            index[k] = uint32_t(mesh.uv0.size());
            mesh.uv0.emplace_back(float(side.right.dot(p)), float(-side.up.dot(p)));
        }
    }
}

}  // namespace prt
