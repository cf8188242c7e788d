// Sources: GLFW 3.3 (windows and input).
#include "tools/view/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "runtime/gl_functions.h"

namespace prt::tools {

static_assert(int(Key::Space) == GLFW_KEY_SPACE && int(Key::Equal) == GLFW_KEY_EQUAL &&
              int(Key::Z) == GLFW_KEY_Z && int(Key::RightBracket) == GLFW_KEY_RIGHT_BRACKET &&
              int(Key::PageDown) == GLFW_KEY_PAGE_DOWN && int(Key::End) == GLFW_KEY_END &&
              int(Key::F12) == GLFW_KEY_F12 && int(Key::KeypadAdd) == GLFW_KEY_KP_ADD &&
              int(Key::RightControl) == GLFW_KEY_RIGHT_CONTROL && kKeyCount == GLFW_KEY_LAST + 1);
static_assert(int(MouseButton::Right) == GLFW_MOUSE_BUTTON_RIGHT &&
              int(MouseButton::Middle) == GLFW_MOUSE_BUTTON_MIDDLE);

struct ViewWindow::State {
    State(int width, int height, const std::string& title)
        : context(GlWindowOptions{width, height, title, true}),
          window(static_cast<GLFWwindow*>(context.window())),
          blitFramebuffer(
              reinterpret_cast<PFNGLBLITNAMEDFRAMEBUFFERPROC>(glfwGetProcAddress("glBlitNamedFramebuffer"))),
          readPixels(reinterpret_cast<PFNGLREADPIXELSPROC>(glfwGetProcAddress("glReadPixels"))) {}

    static State& of(GLFWwindow* window) { return *static_cast<State*>(glfwGetWindowUserPointer(window)); }
    ViewEvent& add(ViewEventKind kind) {
        ViewEvent event;
        event.kind = kind;
        event.seconds = glfwGetTime();
        return events.emplace_back(event);
    }
    void listen();
    void listenToKeyboard();

    GlContext context;
    GLFWwindow* window;
    PFNGLBLITNAMEDFRAMEBUFFERPROC blitFramebuffer;
    PFNGLREADPIXELSPROC readPixels;
    std::vector<ViewEvent> events;
};

void ViewWindow::State::listenToKeyboard() {
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
        ViewEvent& event = of(w).add(ViewEventKind::Key);
        event.key = Key(key);
        event.pressed = action != GLFW_RELEASE;
        event.repeated = action == GLFW_REPEAT;
        event.shift = (mods & GLFW_MOD_SHIFT) != 0;
        event.control = (mods & GLFW_MOD_CONTROL) != 0;
    });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
        of(w).add(ViewEventKind::Text).character = character;
    });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
        if (!focused) of(w).add(ViewEventKind::Leave);
    });
}

void ViewWindow::State::listen() {
    glfwSetWindowUserPointer(window, this);
    listenToKeyboard();
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        ViewEvent& event = of(w).add(ViewEventKind::Cursor);
        event.x = x;
        event.y = y;
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
        if (button >= kMouseButtonCount) return;
        ViewEvent& event = of(w).add(ViewEventKind::Button);
        event.button = MouseButton(button);
        event.pressed = action == GLFW_PRESS;
        event.shift = (mods & GLFW_MOD_SHIFT) != 0;
        event.control = (mods & GLFW_MOD_CONTROL) != 0;
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
        ViewEvent& event = of(w).add(ViewEventKind::Scroll);
        event.x = x;
        event.y = y;
    });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* w) { of(w).add(ViewEventKind::Close); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w).add(ViewEventKind::Refresh); });
    glfwSetFramebufferSizeCallback(window,
                                   [](GLFWwindow* w, int, int) { of(w).add(ViewEventKind::Refresh); });
}

ViewWindow::ViewWindow(int width, int height, const std::string& title)
    : state_(std::make_unique<State>(width, height, title)) {
    state_->listen();
    glfwSwapInterval(1);
}

ViewWindow::~ViewWindow() { glfwSetWindowUserPointer(state_->window, nullptr); }

GlContext& ViewWindow::context() { return state_->context; }

WindowSize ViewWindow::size() const {
    WindowSize size;
    glfwGetWindowSize(state_->window, &size.width, &size.height);
    glfwGetFramebufferSize(state_->window, &size.pixelWidth, &size.pixelHeight);
    float x = 1, y = 1;
    glfwGetWindowContentScale(state_->window, &x, &y);
    size.contentScale = std::max({double(x), double(y), 0.5});
    return size;
}

bool ViewWindow::isMinimised() const {
    const WindowSize now = size();
    return glfwGetWindowAttrib(state_->window, GLFW_ICONIFIED) == GLFW_TRUE || now.pixelWidth < 1 ||
           now.pixelHeight < 1;
}

void ViewWindow::resize(int width, int height) { glfwSetWindowSize(state_->window, width, height); }

void ViewWindow::setTitle(const std::string& title) { glfwSetWindowTitle(state_->window, title.c_str()); }

std::vector<ViewEvent> ViewWindow::events(double waitSeconds) {
    if (waitSeconds > 0)
        glfwWaitEventsTimeout(waitSeconds);
    else
        glfwPollEvents();
    return std::exchange(state_->events, {});
}

void ViewWindow::wake() { glfwPostEmptyEvent(); }

double ViewWindow::seconds() const { return glfwGetTime(); }

void ViewWindow::blit(unsigned framebuffer, int width, int height) {
    const WindowSize now = size();
    const bool same = now.pixelWidth == width && now.pixelHeight == height;
    state_->blitFramebuffer(framebuffer, 0, 0, 0, width, height, 0, 0, now.pixelWidth, now.pixelHeight,
                            GL_COLOR_BUFFER_BIT, same ? GL_NEAREST : GL_LINEAR);
    state_->context.gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
}

ByteImage ViewWindow::read() const {
    const WindowSize now = size();
    ByteImage image{now.pixelWidth, now.pixelHeight, 3, {}};
    const size_t row = size_t(now.pixelWidth) * 3;
    image.pixels.resize(row * size_t(now.pixelHeight));
    const GlFunctions& gl = state_->context.gl();
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < now.pixelHeight; ++y)
        state_->readPixels(0, now.pixelHeight - 1 - y, now.pixelWidth, 1, GL_RGB, GL_UNSIGNED_BYTE,
                           &image.pixels[size_t(y) * row]);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    state_->context.check("reading the window back");
    return image;
}

void ViewWindow::swap() { glfwSwapBuffers(state_->window); }

}  // namespace prt::tools
