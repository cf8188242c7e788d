// Environments that are blended by weight and rotated about the up axis at run time; makes the tables of a
// technique.
#pragma once

#include <string>
#include <vector>

#include "compress/tables/fast_tables.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/environment.h"

namespace prt {

/// Not for several threads at once: all tables are made by one builder.
class LiveLight {
  public:
    /// Projects each environment once, to the order tables need for visibility of shOrder bands.
    LiveLight(const std::vector<Environment>& environments, int shOrder, int tableSize);

    /// Light-cosine table of Σ weight_k · environment_k turned by rotationRad.
    NormalTable lightCosineTable(const std::vector<double>& weights, double rotationRad) const;
    /// Triple-product table of the same light for a PCA basis.
    NormalTable tripleProductTable(const std::vector<double>& weights, double rotationRad,
                                   const PcaMap& pca) const;

  private:
    std::vector<EnvironmentSh> environments_;
    std::vector<std::string> names_, hashes_;
    int shOrder_, tableSize_;
    mutable LightTableBuilder builder_;  // only its scratch changes
};

}  // namespace prt
