// Environments that are blended by weight and rotated about the up axis at run time; makes the tables of a
// technique.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "compress/tables/fast_tables.h"
#include "compress/tables/table_options.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/environment.h"

namespace prt {

/// Not for several threads at once: builders of tables are shared.
class LiveLight {
  public:
    /// Projects each environment once, to the order tables need for visibility of shOrder bands; takes out
    /// suns and applies the window that the options ask for.
    LiveLight(const std::vector<Environment>& environments, int shOrder, const TableOptions& options);

    /// Σ weight_k · environment_k turned by rotationRad, of all bands that were projected.
    EnvironmentSh blend(const std::vector<double>& weights, double rotationRad) const;
    /// Light-cosine table of that light.
    /// @param shOrder  of the visibility, at most that of the constructor; 0: just that
    NormalTable lightCosineTable(const std::vector<double>& weights, double rotationRad,
                                 int shOrder = 0) const;
    /// Triple-product table of the same light for a PCA basis.
    NormalTable tripleProductTable(const std::vector<double>& weights, double rotationRad,
                                   const PcaMap& pca) const;
    /// Irradiance of unoccluded surfaces of the same light, as the mean of a triple-product table of order 1
    /// without vectors: technique PreconvolvedAo. With the exact cosine it holds every band that was
    /// projected, shOrder + kTableCosineBands − 1.
    /// @source [IwanickiSloan2012, Sec. 5]
    NormalTable preconvolvedTable(const std::vector<double>& weights, double rotationRad) const;

    /// Different for lights that were made by different constructors; copies are equal.
    uint64_t id() const { return id_; }
    size_t environmentCount() const { return environments_.size(); }
    int cosineBands() const { return options_.cosineBands(); }  ///< of the tables
    /// What was taken out of each environment; not found unless the options ask for it.
    const std::vector<ExtractedSun>& suns() const { return suns_; }

  private:
    NormalTable emptyTable(const LightTableBuilder& builder, TableKind kind, int layers,
                           const std::vector<double>& weights, double rotationRad) const;
    LightTableBuilder& builder(int shOrder, int cosineBands) const;

    std::vector<EnvironmentSh> environments_;
    std::vector<ExtractedSun> suns_;
    std::vector<std::string> names_, hashes_;
    int shOrder_;
    TableOptions options_;
    uint64_t id_;
    /// By order of the visibility and bands of the cosine, made when first asked for; only scratch changes.
    mutable std::map<std::pair<int, int>, LightTableBuilder> builders_;
};

}  // namespace prt
