// light.frag for pixels of one and of several samples. Internal.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "runtime/gl_objects.h"

namespace prt {

/// What a pass over the image lights.
enum class Pixels {
    OneSample,    ///< the only sample of each pixel
    OneTriangle,  ///< pixels all of whose samples see the same
    Several       ///< pixels whose samples see more than one thing
};

class LightProgram {
  public:
    /// Compiles it for one sample.
    /// @param defines  of the technique, a line each
    /// @throws Error   the compiler's log
    LightProgram(const GlFunctions& gl, std::string defines);
    /// Compiles it for these pixels when first asked to.
    /// @throws Error   the compiler's log
    const GlProgram& of(Pixels pixels) const;
    const std::string& defines() const { return defines_; }

  private:
    const GlFunctions& gl_;
    std::string defines_;
    mutable std::array<std::optional<GlProgram>, 3> programs_;
};

}  // namespace prt
