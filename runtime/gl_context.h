// A headless OpenGL 4.5 core context (OSMesa) and the function table everything is called through.
#pragma once

#include <memory>
#include <string>

namespace prt {

struct GlFunctions;

/// Owns an OSMesa context, current on the thread that made it; one per thread. Rendering runs on all cores of
/// its own accord (LP_NUM_THREADS in the environment limits it).
class GlContext {
  public:
    /// @throws InputError  libOSMesa is not there or has no OpenGL 4.5 core (says which package to install)
    GlContext();
    ~GlContext();
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;
    const GlFunctions& gl() const;
    std::string rendererName() const;  ///< e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"

    /// Makes it current on the calling thread (needed only after another context was).
    void makeCurrent() const;
    /// Errors that OpenGL reported since the last call.
    /// @param doing  what was being done, for the message
    /// @throws InputError  out of memory
    /// @throws Error       any other error: a bug in the runtime or in the driver
    void check(const std::string& doing) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
