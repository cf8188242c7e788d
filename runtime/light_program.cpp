// Sources: none.
#include "runtime/light_program.h"

#include <utility>

namespace prt {

LightProgram::LightProgram(const GlFunctions& gl, std::string defines)
    : gl_(gl), defines_(std::move(defines)) {
    of(Pixels::OneSample);
}

const GlProgram& LightProgram::of(Pixels pixels) const {
    static constexpr const char* kDefines[] = {"", "#define MULTISAMPLED\n#define ONE_TRIANGLE\n",
                                               "#define MULTISAMPLED\n"};
    std::optional<GlProgram>& program = programs_[size_t(pixels)];
    if (!program) program.emplace(gl_, "screen.vert", "light.frag", kDefines[size_t(pixels)] + defines_);
    return *program;
}

}  // namespace prt
