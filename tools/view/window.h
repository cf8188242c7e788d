// The viewer's window, by GLFW: events out, a picture in. In builds with PRT_WITH_VIEWER.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "runtime/gl_context.h"
#include "tools/view/event.h"

namespace prt::tools {

/// Sizes differ on displays of high density: events count in units of the window, pictures in pixels.
struct WindowSize {
    int width = 0, height = 0;            ///< of the content, in the window system's units
    int pixelWidth = 0, pixelHeight = 0;  ///< of what is drawn; 0: minimised
    double contentScale = 1;              ///< what texts should be scaled by, as the desktop wants it
    bool operator==(const WindowSize&) const = default;
};

class ViewWindow {
  public:
    /// On the main thread alone, as all of its functions but wake().
    /// @throws InputError  no display, no OpenGL 4.5
    ViewWindow(int width, int height, const std::string& title);
    ~ViewWindow();

    GlContext& context();
    WindowSize size() const;
    bool isMinimised() const;
    void resize(int width, int height);
    void setTitle(const std::string& title);

    /// What happened since the last call.
    /// @param waitSeconds  how long to wait for something to happen; 0: not at all
    std::vector<ViewEvent> events(double waitSeconds);
    /// Ends a wait, from any thread.
    static void wake();
    /// Seconds on the clock of events.
    double seconds() const;

    /// Copies a framebuffer of that size over the whole window, scaled where sizes differ, and makes the
    /// window what is drawn into.
    void blit(unsigned framebuffer, int width, int height);
    /// What stands in the window before it is shown, rows from the top, 3 channels.
    ByteImage read() const;
    /// Shows it.
    void swap();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt::tools
