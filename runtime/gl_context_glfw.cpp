// Sources: GLFW 3.3 (windows and contexts).
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "precompute/base/error.h"
#include "runtime/gl_backend.h"

namespace prt {
namespace {

constexpr const char* kRemedy = "a display with OpenGL 4.5 is needed; without one, draw with egl or osmesa";

std::string lastGlfwError() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "no reason given";
}

/// GLFW, for as long as a window is there. An application that uses it, too, keeps it alive.
class Glfw {
  public:
    Glfw() {
        if (count_ == 0 && !glfwInit())
            throw InputError("OpenGL", "no window can be made: " + lastGlfwError(), kRemedy);
        ++count_;
    }
    ~Glfw() {
        if (--count_ == 0) glfwTerminate();
    }
    Glfw(const Glfw&) = delete;
    Glfw& operator=(const Glfw&) = delete;

  private:
    inline static int count_ = 0;  // all on the main thread
};

class GlfwBackend : public GlBackend {
  public:
    GlfwBackend(const GlWindowOptions& options, bool debug) {
        glfwDefaultWindowHints();
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, debug ? GLFW_TRUE : GLFW_FALSE);
        glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
        glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
        window_ = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
        if (!window_) throw InputError("OpenGL", "no window can be made: " + lastGlfwError(), kRemedy);
    }
    ~GlfwBackend() override { glfwDestroyWindow(window_); }
    GlfwBackend(const GlfwBackend&) = delete;
    GlfwBackend& operator=(const GlfwBackend&) = delete;

    GlContextKind kind() const override { return GlContextKind::Window; }
    GlProc proc(const char* name) const override { return glfwGetProcAddress(name); }
    bool isCurrent() const override { return glfwGetCurrentContext() == window_; }
    void makeCurrent() const override {
        glfwMakeContextCurrent(window_);
        if (!isCurrent()) throw Error("OpenGL", "the context cannot be made current: " + lastGlfwError());
    }
    void release() const override { glfwMakeContextCurrent(nullptr); }
    void* window() const override { return window_; }

  private:
    Glfw glfw_;
    GLFWwindow* window_ = nullptr;
};

}  // namespace

std::unique_ptr<GlBackend> makeWindowBackend(const GlWindowOptions& options, bool debug) {
    return std::make_unique<GlfwBackend>(options, debug);
}

}  // namespace prt
