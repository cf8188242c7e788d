// An OpenGL 4.5 context, whoever made it, and the function table everything is called through.
#pragma once

#include <memory>
#include <string>

#include "precompute/base/error.h"

namespace prt {

struct GlFunctions;

using GlProc = void (*)();
/// Resolves "glDrawArrays" and the like: eglGetProcAddress, glfwGetProcAddress, OSMesaGetProcAddress…
using GlGetProc = GlProc (*)(const char* name);

enum class GlContextKind {
    OsMesa,  ///< headless, in software
    Egl,     ///< headless: a GPU where there is one that may be used, else in software
    Window,  ///< of a window, in builds with PRT_WITH_VIEWER
    Current  ///< the caller's, whatever made it
};
const char* glContextKindName(GlContextKind kind);  ///< "osmesa", "egl", "window", "current"

struct GlWindowOptions {
    int width = 1280, height = 800;  ///< of its content, in the window system's units
    std::string title = "prt";
    bool visible = true;  ///< a hidden one is a context on the display's GPU
};

/// The driver reset the GPU: everything in the context is lost. Make a new context, and renderers in it.
class GlContextLost : public Error {
  public:
    using Error::Error;
};

/// One context; functions are loaded at run time, so that nothing links an OpenGL library. Not for several
/// threads at once. In software, rendering runs on all cores of its own accord (LP_NUM_THREADS limits it).
///
/// Read from the environment: PRT_GL_DEBUG (set and not 0: a debug context, in which undefined behaviour is
/// an error), PRT_EGL_DEVICE (number of the EGL device to use), PRT_EGL_LIBRARY and PRT_OSMESA_LIBRARY (names
/// to load in place of libEGL and libOSMesa).
class GlContext {
  public:
    /// Makes a context of its own and makes it current on the calling thread.
    /// @param kind  OsMesa or Egl
    /// @throws InputError  the library is not there or has no OpenGL 4.5 core (says what there is)
    explicit GlContext(GlContextKind kind = GlContextKind::OsMesa);

    /// Opens a window and makes its context current. On the main thread alone, as GLFW wants it.
    /// @throws InputError  no display, no OpenGL 4.5 core, or a build without windows
    explicit GlContext(const GlWindowOptions& options);

    /// Wraps the context that is current on the calling thread. It is never made current, released or
    /// destroyed here: it must be current whenever this object, or anything made in it, is used or destroyed.
    /// Drawing leaves its state as it was, see GlStateGuard.
    /// @param getProc  resolves its functions; null: that of EGL, GLX or OSMesa, whichever made it
    /// @throws InputError  none is current, or it has no OpenGL 4.5
    static GlContext ofCaller(GlGetProc getProc = nullptr);

    ~GlContext();
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    GlContextKind kind() const;
    const GlFunctions& gl() const;
    void* window() const;  ///< the GLFWwindow, for its events and to swap its buffers; null for other kinds
    std::string rendererName() const;  ///< e.g. "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string versionName() const;   ///< e.g. "4.5 (Core Profile) Mesa 22.3.6"

    /// Makes it current on the calling thread (needed only after another context was).
    /// @throws Error  the driver refuses; or it is the caller's and another is current
    void makeCurrent() const;
    /// Errors that OpenGL reported since the last call.
    /// @param doing  what was being done, for the message
    /// @throws InputError     out of memory
    /// @throws GlContextLost  the GPU was reset
    /// @throws Error          any other error: a bug in the runtime or in the driver
    void check(const std::string& doing) const;

  private:
    struct State;
    explicit GlContext(std::unique_ptr<State> state);
    void listen();
    std::unique_ptr<State> state_;
    friend class GlStateGuard;
    mutable bool guarded_ = false;  // a guard lives
};

}  // namespace prt
