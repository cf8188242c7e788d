// What GLFW tells arrives as the viewer's events. In builds with PRT_WITH_VIEWER.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdlib>

#include "tools/view/window.h"

namespace prt::tools {
namespace {

/// The function that GLFW would call.
template <class Set>
auto callbackOf(GLFWwindow* window, Set set) {
    const auto callback = set(window, nullptr);
    set(window, callback);
    return callback;
}

TEST(ViewWindow, TellsWhatGlfwTells) {
    if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no window: needs a display (xvfb-run -s -noreset)";
    ViewWindow window(120, 80, "test");
    EXPECT_EQ(window.size().width, 120);
    EXPECT_EQ(window.size().pixelHeight, 80);
    EXPECT_FALSE(window.isMinimised());
    window.events(0);
    auto* glfw = static_cast<GLFWwindow*>(window.context().window());
    callbackOf(glfw, glfwSetKeyCallback)(glfw, GLFW_KEY_PAGE_UP, 0, GLFW_PRESS, GLFW_MOD_SHIFT);
    callbackOf(glfw, glfwSetKeyCallback)(glfw, GLFW_KEY_N, 0, GLFW_REPEAT, GLFW_MOD_CONTROL);
    callbackOf(glfw, glfwSetKeyCallback)(glfw, GLFW_KEY_UNKNOWN, 0, GLFW_RELEASE, 0);
    callbackOf(glfw, glfwSetCharCallback)(glfw, 0x416);
    callbackOf(glfw, glfwSetCursorPosCallback)(glfw, 3.5, 70);
    callbackOf(glfw, glfwSetMouseButtonCallback)(glfw, GLFW_MOUSE_BUTTON_MIDDLE, GLFW_PRESS, GLFW_MOD_SHIFT);
    callbackOf(glfw, glfwSetMouseButtonCallback)(glfw, GLFW_MOUSE_BUTTON_8, GLFW_PRESS, 0);
    callbackOf(glfw, glfwSetScrollCallback)(glfw, 0, -2);
    callbackOf(glfw, glfwSetWindowFocusCallback)(glfw, GLFW_FALSE);
    callbackOf(glfw, glfwSetWindowCloseCallback)(glfw);
    callbackOf(glfw, glfwSetFramebufferSizeCallback)(glfw, 10, 10);
    std::vector<ViewEvent> events = window.events(0);
    // The window system may have told of its own what the test did not.
    std::erase_if(events, [](const ViewEvent& e) { return e.kind == ViewEventKind::Refresh; });
    ASSERT_EQ(events.size(), 9u) << "an eighth mouse button is nobody's";
    EXPECT_EQ(events[0].key, Key::PageUp);
    EXPECT_TRUE(events[0].pressed && events[0].shift && !events[0].repeated && !events[0].control);
    EXPECT_EQ(events[1].key, Key::N);
    EXPECT_TRUE(events[1].pressed && events[1].repeated && events[1].control);
    EXPECT_EQ(events[2].key, Key::Unknown);
    EXPECT_FALSE(events[2].pressed);
    EXPECT_EQ(events[3].character, 0x416u);
    EXPECT_EQ(events[4].x, 3.5);
    EXPECT_EQ(events[4].y, 70);
    EXPECT_EQ(events[5].button, MouseButton::Middle);
    EXPECT_TRUE(events[5].pressed && events[5].shift);
    EXPECT_EQ(events[6].y, -2);
    EXPECT_EQ(events[7].kind, ViewEventKind::Leave);
    EXPECT_EQ(events[8].kind, ViewEventKind::Close);
    for (size_t i = 1; i < events.size(); ++i) EXPECT_GE(events[i].seconds, events[i - 1].seconds);
}

TEST(ViewWindow, IsResizedAndWoken) {
    if (!std::getenv("DISPLAY")) GTEST_SKIP() << "no window: needs a display (xvfb-run -s -noreset)";
    ViewWindow window(120, 80, "test");
    window.resize(90, 50);
    for (int i = 0; i < 50 && window.size().pixelWidth != 90; ++i) window.events(0.1);
    EXPECT_EQ(window.size().pixelWidth, 90);
    EXPECT_EQ(window.read().pixels.size(), size_t(90 * 50 * 3));
    ViewWindow::wake();
    window.events(60);  // would run into the test's time limit
}

}  // namespace
}  // namespace prt::tools
