// A headless OpenGL 4.5 core context (OSMesa) and the function table everything is called through.
#pragma once

#include <memory>
#include <string>

namespace prt {

struct GlFunctions;

/// Owns a current OSMesa context; one per thread.
class GlContext {
  public:
    /// @throws InputError  libOSMesa is not there or has no OpenGL 4.5 core (says which package to install)
    GlContext();
    ~GlContext();
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;
    const GlFunctions& gl() const;
    std::string rendererName() const;  ///< e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
