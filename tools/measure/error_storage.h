// Visibility as a bundle compresses and stores it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compress/pca.h"
#include "compress/quantize.h"
#include "tools/measure/error_points.h"

namespace prt::tools {

/// From coefficients to weights, to what a reader of the stored weights gets, and back. A bundle that is not
/// compressed has its coefficients for weights, a unit matrix for vectors, and no mean.
class BundleStorage {
  public:
    /// @param bundle   must outlive the object
    /// @param weights  "float", "half", "unorm16", "unorm8"; of coefficients that are not compressed anything
    /// but "float" is half
    /// @throws InputError  a weight in use that is not finite
    BundleStorage(const JudgedBundle& bundle, const std::string& weights);

    const PcaResult& pca() const { return pca_; }
    size_t components() const { return size_t(pca_.components); }

    /// The bundle's weights.
    /// @param places  [points] index into VisibilityMap
    /// @return        [points×M]
    std::vector<float> shipped(std::span<const uint32_t> places) const;
    /// Weights as prt compress finds them, with the bundle's vectors.
    /// @param rows  [points×n²]   @param normals  [points] geometric, unit
    /// @return      [points×M]
    std::vector<float> fit(const std::vector<float>& rows, std::span<const Vec3f> normals) const;
    /// What a reader of stored weights gets; the ranges of UNORM formats are those of all valid points.
    /// @param weights  [points×M]
    std::vector<float> store(std::vector<float> weights) const;
    /// mean + Σ_m w_m basis_m
    /// @param weights  [points×M]
    /// @return         [points×n²]
    std::vector<float> expand(const std::vector<float>& weights) const;

  private:
    const JudgedBundle& bundle_;
    int shOrder_, dimension_, bits_ = 0;
    std::string format_;
    PcaResult pca_;
    std::vector<UnormRange> ranges_;
};

/// Weights of points: stored, and the expansions before and after.
struct StoredExpansion {
    std::vector<float> stored;           ///< [points×M]
    std::vector<float> fittedExpansion;  ///< [points×n²] of the weights given
    std::vector<float> storedExpansion;  ///< [points×n²] of the stored ones

    /// @param weights  [points×M]
    StoredExpansion(const BundleStorage& storage, const std::vector<float>& weights)
        : stored(storage.store(weights)),
          fittedExpansion(storage.expand(weights)),
          storedExpansion(storage.expand(stored)) {}
};

}  // namespace prt::tools
