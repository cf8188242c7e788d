// What prt relight draws: the data of a bundle that the techniques asked for need, and their light.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "runtime/live_light.h"
#include "runtime/renderer.h"
#include "runtime/technique.h"
#include "tools/relight_arguments.h"
#include "tools/relight_lightmaps.h"

namespace prt::tools {

/// What is read from the bundle for one run.
struct RelightData {
    Bundle bundle;
    Scene scene;
    std::optional<VisibilityMap> visibility;
    std::optional<PcaMap> pca;
    std::shared_ptr<RelightLightmaps> lightmaps;  ///< of the environments, read when asked for
    bool hasLightmaps = false;                    ///< all that the arguments' light takes; where asked for
    std::vector<Environment> environments;
    std::vector<double> weights;
    int shOrder = 0;                    ///< of visibility, or of the vectors
    std::vector<Technique> techniques;  ///< to be drawn, in the order in which they are listed

    TechniqueSource source() const;
    PointDomain domain() const;
};

/// Reads what the techniques need. Those are the ones named; all that the bundle can do where it was "all";
/// and unc, and pca where it is current, in a comparison.
/// @throws InputError  a technique that was named cannot be drawn
RelightData loadRelightData(const RelightArguments& arguments);

/// Adds the techniques to a renderer and gives each its light: tables from the bundle when all of them are
/// there, current and of the right environments; else made here. Where the GPU blends, all are made here.
class RelightTechniques {
  public:
    /// Arguments must outlive the object.
    RelightTechniques(const RelightArguments& arguments, const RelightData& data);

    /// Reduces visibility and weights to what each technique takes, and uploads them.
    void addTo(Renderer& renderer);
    /// Does nothing where the renderer's technique was given just this light last; so it may be called for
    /// every frame. The renderer's light must be set in no other way meanwhile.
    /// @param weights      [environments]
    /// @param rotationRad  turn of the environments about the up axis
    /// @return "bundle" or "built": where its tables came from; a lightmap is the bundle's
    /// @throws InputError  ShLightmap without a lightmap of this light
    const char* setLight(Renderer& renderer, Technique technique, const std::vector<double>& weights,
                         double rotationRad);
    /// Diffuse reflections that the technique's light holds, after setLight().
    int bounces(Technique technique) const { return technique == Technique::ShLightmap ? bounces_ : 0; }
    /// The name under which the renderer has a technique: asking for all bands or vectors by their number is
    /// asking for all.
    Technique drawn(Technique technique) const;

  private:
    struct Given {
        std::vector<double> weights;
        double rotationRad = 0;
        const char* origin = nullptr;
    };
    const char* makeLight(Renderer& renderer, Technique technique, const std::vector<double>& weights,
                          double rotationRad);
    std::optional<NormalTable> blendStored(TableKind kind, const std::vector<double>& weights);
    const std::optional<NormalTable>& stored(TableKind kind, size_t environment);
    std::optional<NormalTable> readStored(TableKind kind, const Environment& environment) const;

    const RelightArguments& arguments_;
    const RelightData& data_;
    std::optional<LiveLight> live_;
    int bounces_ = 0;                                                            // of the lightmap
    std::map<std::pair<TableKind, size_t>, std::optional<NormalTable>> stored_;  // as far as asked for
    std::map<std::pair<const Renderer*, Technique>, Given> given_;               // last
};

}  // namespace prt::tools
