// A bundle's mesh with its visibility at any order, compressed to any number of vectors.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compress/compress_visibility.h"
#include "precompute/io/scene.h"
#include "precompute/io/visibility_file.h"
#include "precompute/mesh/texel_raster.h"
#include "precompute/rays/ray_caster.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {

/// Holds every order that was asked for. Not for several threads at once.
class CompressionScene {
  public:
    /// @param bundlePath  of prt precompute; only its mesh and its visibility are read
    /// @param plain       expansions and weights as the paper has them, whatever the bundle's projection
    /// @param mostBands   highest order that will be asked for, 1..kMaxBundleShOrder
    /// @throws InputError  the bundle is damaged or stale
    CompressionScene(const std::string& bundlePath, bool plain, int mostBands);

    const Scene& scene() const { return scene_; }
    const RayCaster& caster() const { return caster_; }
    /// Of all maps.
    const Projection& projection() const { return projection_; }
    WeightsFit fit() const;

    /// Visibility of n bands: what the bundle holds where it has that order; else baked with the bundle's
    /// settings; plain expansions of fewer bands are the beginning of those of more, by definition.
    /// @param shOrder  1..mostBands
    /// @throws InputError, Interrupted
    const VisibilityMap& visibility(int shOrder);
    /// Visibility of points, with the same settings.
    /// @return [points×n²]
    std::vector<float> bakePoints(std::span<const SurfacePoint> points, int shOrder) const;

  private:
    BakeOptions options(int shOrder) const;
    VisibilityMap bake(int shOrder) const;

    VisibilityMap stored_;
    Scene scene_;
    RayCaster caster_;
    bool plain_;
    int mostBands_;
    Projection projection_;
    std::vector<uint8_t> doubleSided_;
    std::map<int, VisibilityMap> maps_;
};

/// Non-zero for the points that were baked, and count.
std::vector<uint8_t> validPoints(const VisibilityMap& visibility);

/// @param components  M, 1..n²
/// @return weights in float, of all points
PcaMap compressMap(const VisibilityMap& visibility, int components, WeightsFit fit);

/// Weights as they come back from a texture.
/// @param encoding  one of pointEncodings()
/// @return [count×M]
std::vector<float> shippedWeights(const PcaMap& pca, std::span<const uint8_t> valid,
                                  const std::string& encoding);

/// Values of points of the grid as the runtime's shader interpolates them at points of the surface: bilinear
/// in the atlas, clamped at its edges, or over the triangle.
/// @param values  [grid.count×perPoint]
/// @return [points×perPoint]
std::vector<float> interpolate(const Scene& scene, const PointGrid& grid,
                               std::span<const SurfacePoint> points, std::span<const float> values,
                               size_t perPoint);

/// mean + Σ_m w_m basis_m.
/// @param weights  [N×M]   @return [N×n²]
std::vector<float> reconstruct(const PcaMap& pca, std::span<const float> weights);

}  // namespace prt::tools
