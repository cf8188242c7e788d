// Sources: none.
#include "runtime/light_program.h"

#include <utility>

namespace prt {

LightProgram::LightProgram(const GlFunctions& gl, std::string defines)
    : gl_(gl), defines_(std::move(defines)), single_(gl, "screen.vert", "light.frag", defines_) {}

const GlProgram& LightProgram::of(int samples) const {
    if (samples == 1) return single_;
    if (!several_) several_.emplace(gl_, "screen.vert", "light.frag", "#define MULTISAMPLED\n" + defines_);
    return *several_;
}

}  // namespace prt
