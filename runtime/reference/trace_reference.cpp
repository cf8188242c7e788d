// Irradiance by tracing every direction of the reference from every pixel: the rendering equation's direct
// term [Kajiya1986] by quadrature.
#include <algorithm>
#include <array>
#include <memory>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "runtime/reference/reference.h"

namespace prt {
namespace {

constexpr int kTile = 16;  // pixels along the edge of a tile: near points on the surface
constexpr size_t kTilePixels = size_t(kTile) * kTile;
constexpr size_t kRowsPerSum = 128;  // terms summed in float before they are added in double

// Radiance times solid angle, colours of all environments side by side: [K][columns].
struct LightMatrix {
    size_t columns = 0;
    std::vector<float> values;

    explicit LightMatrix(const ReferenceDirections& directions)
        : columns(directions.radiance.size() * 3), values(directions.direction.size() * columns) {
        for (size_t e = 0; e < directions.radiance.size(); ++e) {
            PRT_CHECK_EQ(directions.radiance[e].size(), directions.direction.size() * 3);
            for (size_t k = 0; k < directions.direction.size(); ++k)
                for (size_t c = 0; c < 3; ++c)
                    values[k * columns + e * 3 + c] =
                        directions.radiance[e][k * 3 + c] * directions.solidAngleSr[k];
        }
    }
};

// sum[c] += Σ_j weights[j]·matrix[rows[j]][c]
PRT_TARGET_CLONES
void addWeightedRows(const float* matrix, size_t columns, const uint32_t* rows, const float* weights,
                     size_t count, float* partial) {
    for (size_t j = 0; j < count; ++j) {
        const float* row = matrix + size_t(rows[j]) * columns;
        const float weight = weights[j];
        for (size_t c = 0; c < columns; ++c) partial[c] += weight * row[c];
    }
}

class TileTracer {
  public:
    TileTracer(const RayCaster& caster, const SurfaceImage& surface, const ReferenceDirections& directions)
        : caster_(caster), surface_(surface), directions_(directions) {}

    /// Pixels of the tile that show a surface.
    const std::vector<size_t>& gather(int tileX, int tileY) {
        pixels_.clear();
        origins_.clear();
        for (int y = tileY * kTile; y < std::min((tileY + 1) * kTile, surface_.height); ++y)
            for (int x = tileX * kTile; x < std::min((tileX + 1) * kTile, surface_.width); ++x) {
                const size_t pixel = size_t(y) * size_t(surface_.width) + size_t(x);
                if (surface_.triangle[pixel] == kNoTriangle) continue;
                const Vec3f position =
                    caster_.snapToPlane(surface_.position[pixel], surface_.triangle[pixel]);
                pixels_.push_back(pixel);
                origins_.push_back(caster_.offsetOrigin(position, surface_.geometricNormal[pixel]));
            }
        return pixels_;
    }

    void trace() {
        const size_t count = directions_.direction.size();
        visible_.assign(pixels_.size() * count, 0);
        for (size_t k = 0; k < count; ++k) {
            if (k % 256 == 0) throwIfInterrupted();
            const Vec3f& direction = directions_.direction[k];
            size_t rays = 0;
            for (size_t i = 0; i < pixels_.size(); ++i) {
                if (!(surface_.geometricNormal[pixels_[i]].dot(direction) > 0)) continue;
                facing_[rays] = uint16_t(i);
                rayOrigins_[rays++] = origins_[i];
            }
            caster_.occluded(std::span(rayOrigins_.data(), rays), direction,
                             std::span(blocked_.data(), rays));
            for (size_t j = 0; j < rays; ++j) visible_[facing_[j] * count + k] = !blocked_[j];
        }
    }

    std::span<const uint8_t> visible(size_t i) const {
        const size_t count = directions_.direction.size();
        return {visible_.data() + i * count, count};
    }

    /// @param sums  [columns] zeros in, irradiance out
    void shade(size_t i, const LightMatrix& light, std::vector<double>& sums) {
        const Vec3f& normal = surface_.shadingNormal[pixels_[i]];
        const std::span<const uint8_t> seen = visible(i);
        rows_.clear();
        weights_.clear();
        for (size_t k = 0; k < seen.size(); ++k) {
            const float cosine = normal.dot(directions_.direction[k]);
            if (!seen[k] || !(cosine > 0)) continue;
            rows_.push_back(uint32_t(k));
            weights_.push_back(cosine);
        }
        for (size_t begin = 0; begin < rows_.size(); begin += kRowsPerSum) {
            partial_.assign(light.columns, 0.0f);
            addWeightedRows(light.values.data(), light.columns, &rows_[begin], &weights_[begin],
                            std::min(kRowsPerSum, rows_.size() - begin), partial_.data());
            for (size_t c = 0; c < light.columns; ++c) sums[c] += double(partial_[c]);
        }
    }

  private:
    const RayCaster& caster_;
    const SurfaceImage& surface_;
    const ReferenceDirections& directions_;
    std::vector<size_t> pixels_;
    std::vector<Vec3f> origins_;
    std::vector<uint8_t> visible_;  // [pixels of the tile × K]
    std::vector<uint32_t> rows_;
    std::vector<float> weights_, partial_;
    std::array<Vec3f, kTilePixels> rayOrigins_;
    std::array<uint16_t, kTilePixels> facing_{};
    std::array<uint8_t, kTilePixels> blocked_{};
};

}  // namespace

std::vector<std::vector<float>> traceReference(const RayCaster& caster, const SurfaceImage& surface,
                                               const ReferenceDirections& directions,
                                               const ReferenceVisitor& visitor) {
    PRT_CHECK_EQ(surface.pixels(), size_t(surface.width) * size_t(surface.height));
    const LightMatrix light(directions);
    std::vector<std::vector<float>> irradiance(directions.radiance.size(),
                                               std::vector<float>(surface.pixels() * 3, 0.0f));
    const int tilesX = (surface.width + kTile - 1) / kTile, tilesY = (surface.height + kTile - 1) / kTile;
    Progress progress("reference", surface.pixels(), "pixels");
    parallelFor(size_t(tilesX) * size_t(tilesY), 1, [&](size_t tile, size_t) {
        const int tileX = int(tile) % tilesX, tileY = int(tile) / tilesX;
        const auto tracer = std::make_unique<TileTracer>(caster, surface, directions);
        const std::vector<size_t>& pixels = tracer->gather(tileX, tileY);
        tracer->trace();
        std::vector<double> sums;
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (visitor) visitor(pixels[i], tracer->visible(i));
            sums.assign(light.columns, 0.0);
            tracer->shade(i, light, sums);
            for (size_t e = 0; e < irradiance.size(); ++e)
                for (size_t c = 0; c < 3; ++c) irradiance[e][pixels[i] * 3 + c] = float(sums[e * 3 + c]);
        }
        progress.advance(uint64_t(std::min(kTile, surface.width - tileX * kTile)) *
                         uint64_t(std::min(kTile, surface.height - tileY * kTile)));
    });
    return irradiance;
}

}  // namespace prt
