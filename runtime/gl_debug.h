// What the driver says through debug output. Internal.
#pragma once

#include <cstddef>
#include <string>

#include "runtime/gl_functions.h"

namespace prt {

/// Keeps the driver's messages about errors until somebody asks.
class GlMessages {
  public:
    GlMessages() = default;
    GlMessages(const GlMessages&) = delete;
    GlMessages& operator=(const GlMessages&) = delete;
    /// Warns of what nobody asked for.
    ~GlMessages();

    /// Installs itself in the current context, which must not outlive it.
    /// @param strict  undefined behaviour counts as an error
    void listen(const GlFunctions& gl, bool strict);
    /// What was said since the last call, in one line; empty if nothing.
    std::string take();

    /// Contexts of this process that went away with messages nobody had asked for.
    static size_t unreported();

  private:
    static void APIENTRY receive(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                 const GLchar* message, const void* user);
    std::string text_;
    bool strict_ = false;
};

/// "invalid enum", …
const char* glErrorName(GLenum error);

/// PRT_GL_DEBUG in the environment.
bool glDebugWanted();

}  // namespace prt
