// Suns of relit environments, with shadows from the bundle where it has them, else traced.
#pragma once

#include <map>
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
    /// Arguments must outlive the object.
    RelightSuns(const Bundle& bundle, const Scene& scene, const std::vector<Environment>& environments);

    /// Those of environments of weight > 0, turned and weighted; the first call finds them. Shadows of the
    /// unturned suns and of the last turn are kept, others are traced.
    /// @param weights      [environments]
    /// @param rotationRad  turn of the environments about the up axis
    /// @throws InputError  visibility.exr missing or stale
    std::vector<SunLight> make(const std::vector<double>& weights, double rotationRad);
    /// Gives the renderer, which outlives the object, the suns of make(); does nothing where it was given
    /// just these last.
    /// @return suns that it has now
    size_t setTo(Renderer& renderer, const std::vector<double>& weights, double rotationRad);
    /// Of the points of the shadows; after make().
    const PointGrid& grid() const { return grid_; }

  private:
    // Shadows of one turn of the environments.
    struct Turn {
        double rotationRad = 0;
        std::vector<std::vector<float>> shadows;  // [environments] empty: not made yet
    };
    struct Given {
        std::vector<double> weights;
        double rotationRad = 0;
        size_t suns = 0;
    };
    void find();
    const std::vector<float>& shadow(size_t environment, const ExtractedSun& turned, Turn& turn);

    const Bundle& bundle_;
    const Scene& scene_;
    const std::vector<Environment>& environments_;
    std::vector<ExtractedSun> suns_;  // as the environments have them; empty: not looked for yet
    Turn unturned_, turned_;
    std::map<const Renderer*, Given> given_;
    PointGrid grid_;
    std::optional<RayCaster> caster_;
    std::vector<Validity> validity_;
};

}  // namespace prt::tools
