// light.frag for one and for several samples to a pixel. Internal.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "runtime/gl_objects.h"

namespace prt {

class LightProgram {
  public:
    /// Compiles it for one sample.
    /// @param defines  of the technique, a line each
    /// @throws Error   the compiler's log
    LightProgram(const GlFunctions& gl, std::string defines);
    /// Compiles it for several samples when first asked to.
    /// @param samples  of a pixel
    /// @throws Error   the compiler's log
    const GlProgram& of(int samples) const;
    const std::string& defines() const { return defines_; }

  private:
    const GlFunctions& gl_;
    std::string defines_;
    GlProgram single_;
    mutable std::optional<GlProgram> several_;
};

}  // namespace prt
