// A context that is not the library's: made as an application makes its own.
#pragma once

#include <memory>

#include "runtime/gl_context.h"

namespace prt::test {

/// OpenGL 4.5 core through EGL without a surface, current when made.
class OwnEgl {
  public:
    /// @return  null where EGL cannot be had here
    static std::unique_ptr<OwnEgl> make();
    ~OwnEgl();
    OwnEgl(const OwnEgl&) = delete;
    OwnEgl& operator=(const OwnEgl&) = delete;
    /// Released first, so that it takes effect whatever was current.
    void makeCurrent() const;
    void release() const;
    bool isCurrent() const;
    /// eglGetProcAddress.
    GlGetProc getProc() const;

  private:
    OwnEgl() = default;
    struct Functions;
    std::unique_ptr<Functions> egl_;
    void *display_ = nullptr, *context_ = nullptr;
};

/// A function of OSMesa, once a context of it was made.
GlProc osMesaProc(const char* name);

}  // namespace prt::test
