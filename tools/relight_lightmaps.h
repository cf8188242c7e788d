// Lightmaps of a bundle for the environments that are relit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/lightmap_file.h"
#include "tools/relight_arguments.h"

namespace prt::tools {

/// Reads each environment's lightmap when it is first asked for.
class RelightLightmaps {
  public:
    RelightLightmaps(const Bundle& bundle, const RelightArguments& arguments,
                     const std::vector<Environment>& environments);

    /// That there is one which is current and of just this image and turn, for every environment of weight
    /// > 0.
    /// @param weights      [environments]
    /// @param rotationRad  turn of the environments about the up axis
    /// @throws InputError  says which command makes what is missing; all weights are 0
    void check(const std::vector<double>& weights, double rotationRad);
    /// Σ weight · lightmap; its bounces are the fewest of all.
    /// @throws InputError  as check()
    Lightmap blend(const std::vector<double>& weights, double rotationRad);

  private:
    struct Entry {
        std::string name, hash, source;  // of the environment
        bool read = false;
        std::optional<Lightmap> map;
        std::string problem;  // why there is none
    };
    void read(Entry& entry) const;
    const Lightmap& require(size_t environment, double rotationDeg);

    Bundle bundle_;
    EnvironmentOptions environmentOptions_;
    std::string bundlePath_;
    std::vector<Entry> entries_;  // [environments]
};

}  // namespace prt::tools
