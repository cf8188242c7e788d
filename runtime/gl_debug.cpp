// Sources: OpenGL 4.5 core profile, sections 20 (debug output) and 2.3.1 (errors).
#include "runtime/gl_debug.h"

#include <atomic>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "precompute/base/log.h"

namespace prt {
namespace {

std::atomic<size_t> unreportedCount{0};

}  // namespace

GlMessages::~GlMessages() {
    if (text_.empty()) return;
    ++unreportedCount;
    logWarning("OpenGL: " + text_);
}

void GlMessages::listen(const GlFunctions& gl, bool strict) {
    strict_ = strict;
    gl.DebugMessageCallback(receive, this);
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

std::string GlMessages::take() { return std::exchange(text_, {}); }

size_t GlMessages::unreported() { return unreportedCount; }

// Exceptions must not pass through OpenGL's frames: the message is kept. The compiler's warnings are of high
// severity to some drivers, so that only the type tells.
void APIENTRY GlMessages::receive(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message,
                                  const void* user) {
    auto& self = *const_cast<GlMessages*>(static_cast<const GlMessages*>(user));
    if (type != GL_DEBUG_TYPE_ERROR && !(self.strict_ && type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR)) return;
    std::string& text = self.text_;
    if (text.size() >= 500) return;
    if (!text.empty()) text += " | ";
    text += message;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
}

const char* glErrorName(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "invalid enum";
        case GL_INVALID_VALUE:
            return "invalid value";
        case GL_INVALID_OPERATION:
            return "invalid operation";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "invalid framebuffer operation";
        case GL_OUT_OF_MEMORY:
            return "out of memory";
        case GL_CONTEXT_LOST:
            return "context lost";
        default:
            return "unknown error";
    }
}

bool glDebugWanted() {
    const char* value = std::getenv("PRT_GL_DEBUG");
    return value && *value && std::string_view(value) != "0";
}

}  // namespace prt
