// Brings the light of the moment to techniques, doing what changed and no more. Internal.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "runtime/live_light.h"
#include "runtime/renderer.h"
#include "runtime/table_blender.h"
#include "runtime/technique_data.h"

namespace prt {

/// Needs the context to be current.
class TechniqueLights {
  public:
    /// @param context  outlives this object
    explicit TechniqueLights(const GlContext& context) : context_(context), blender_(context) {}

    /// As Renderer::setLight.
    void set(Technique technique, TechniqueData& data, const LiveLight& light,
             const std::vector<double>& weights, double rotationRad, BlendOn blendOn);
    /// To be told when the technique's data or table was replaced.
    void forget(Technique technique) { states_.erase(technique); }
    /// Tables that were sent to OpenGL.
    uint64_t tableUploads() const { return tableUploads_; }

  private:
    /// What a technique was given last.
    struct Given {
        uint64_t light = 0;
        std::vector<double> weights;
        double rotationRad = 0;
        BlendOn blendOn = BlendOn::Cpu;
        bool operator==(const Given&) const = default;
    };
    struct State {
        std::optional<Given> given;
        /// Of single environments, of one light and rotation; made when first needed.
        std::vector<TableImage> tables;
        std::vector<bool> made;
        uint64_t light = 0;
        double rotationRad = 0;
    };
    void blendOnGpu(Technique technique, TechniqueData& data, const LiveLight& light, const Given& given,
                    State& state);

    const GlContext& context_;
    TableBlender blender_;
    std::map<Technique, State> states_;
    uint64_t tableUploads_ = 0;
};

}  // namespace prt
