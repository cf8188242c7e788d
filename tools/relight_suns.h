// Suns of relit environments, with shadows from the bundle where it has them, else traced.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/math/extract_sun.h"
#include "precompute/rays/ray_caster.h"
#include "runtime/renderer.h"

namespace prt::tools {

class RelightSuns {
  public:
    /// All arguments but the last must outlive the object.
    RelightSuns(const Bundle& bundle, const Scene& scene, const std::vector<Environment>& environments,
                double rotationRad);

    /// Those of environments of weight > 0, turned and weighted; the first call finds them.
    /// @throws InputError  visibility.exr missing or stale
    std::vector<SunLight> make(const std::vector<double>& weights);
    /// Of the points of the shadows; after make().
    const PointGrid& grid() const { return grid_; }

  private:
    void find();
    const std::vector<float>& shadow(size_t environment);

    const Bundle& bundle_;
    const Scene& scene_;
    const std::vector<Environment>& environments_;
    double rotationRad_;
    std::vector<ExtractedSun> suns_;           // turned; empty: not looked for yet
    std::vector<std::vector<float>> shadows_;  // empty: not made yet
    PointGrid grid_;
    std::optional<RayCaster> caster_;
    std::vector<Validity> validity_;
};

}  // namespace prt::tools
