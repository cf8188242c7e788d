// Environments that are blended by weight and rotated about the up axis at run time; makes the tables of a
// technique.
#pragma once

#include <string>
#include <vector>

#include "compress/tables/fast_tables.h"
#include "compress/tables/table_options.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/environment.h"

namespace prt {

/// Not for several threads at once: all tables are made by one builder.
class LiveLight {
  public:
    /// Projects each environment once, to the order tables need for visibility of shOrder bands; takes out
    /// suns and applies the window that the options ask for.
    LiveLight(const std::vector<Environment>& environments, int shOrder, const TableOptions& options);

    /// Light-cosine table of Σ weight_k · environment_k turned by rotationRad.
    NormalTable lightCosineTable(const std::vector<double>& weights, double rotationRad) const;
    /// Triple-product table of the same light for a PCA basis.
    NormalTable tripleProductTable(const std::vector<double>& weights, double rotationRad,
                                   const PcaMap& pca) const;

    /// What was taken out of each environment; not found unless the options ask for it.
    const std::vector<ExtractedSun>& suns() const { return suns_; }

  private:
    EnvironmentSh blend(const std::vector<double>& weights, double rotationRad) const;
    NormalTable emptyTable(TableKind kind, int layers, const std::vector<double>& weights,
                           double rotationRad) const;

    std::vector<EnvironmentSh> environments_;
    std::vector<ExtractedSun> suns_;
    std::vector<std::string> names_, hashes_;
    int shOrder_;
    TableOptions options_;
    mutable LightTableBuilder builder_;  // only its scratch changes
};

}  // namespace prt
