// From what a window tells to what the viewer shows.
#pragma once

#include <array>
#include <optional>

#include "tools/view/bindings.h"
#include "tools/view/event.h"
#include "tools/view/state.h"

namespace prt::tools {

/// What was asked for and is not part of the state.
struct ViewRequests {
    bool quit = false;
    int screenshots = 0;
    struct Point {
        double x, y;
        bool operator==(const Point&) const = default;
    };
    std::optional<Point> lookAt;  ///< point of the window whose surface becomes the target

    bool operator==(const ViewRequests&) const = default;
};

/// Buttons and keys that are down, and what moving and pressing them does. A drag over the height of the
/// window turns by 180°, and moves a point at the target's distance with the cursor.
class ViewInput {
  public:
    /// @param start  what R goes back to
    ViewInput(ViewChoices choices, ViewState start);

    /// @param height  of the window, in the units of events; >= 1
    void setWindowHeight(double height);
    /// Takes one event.
    void handle(const ViewEvent& event, ViewState& state, ViewRequests& requests);
    /// Moves on while keys that fly are held: the camera's distance, or the scene's radius where that is
    /// less, in kFlySeconds.
    /// @param seconds  since the last time, >= 0
    void advance(double seconds, ViewState& state) const;
    /// Whether advance() moves anything.
    bool isFlying() const;
    /// Whether a drag is under way.
    bool isDragging() const;
    /// Lets go of everything: the window lost the keyboard, or the panel took the mouse.
    void release();
    /// What a key or a button of the panel does.
    void act(ViewAction action, ViewState& state, ViewRequests& requests) const;

    static constexpr double kFlySeconds = 2;
    static constexpr double kZoomPerStep = 0.9;  ///< of the distance
    static constexpr double kDoubleClickSeconds = 0.4;
    static constexpr double kTurnStepRad = 5 * 3.14159265358979323846 / 180;
    static constexpr double kExposureStep = 1.0 / 3;  ///< stops
    static constexpr double kMostExposureStops = 20;  ///< either way

  private:
    void drag(double dx, double dy, ViewState& state) const;
    void zoom(double steps, ViewState& state) const;
    void press(const ViewEvent& event, ViewRequests& requests);
    void key(const ViewEvent& event, ViewState& state, ViewRequests& requests);
    void fly(ViewAction action, double length, ViewState& state) const;
    double flyLength(const ViewState& state) const;
    bool isDown(Key key) const { return keys_[size_t(key)]; }

    ViewChoices choices_;
    ViewState start_;
    double windowHeight_ = 1;
    double x_ = 0, y_ = 0;
    bool shift_ = false;
    std::array<bool, kMouseButtonCount> buttons_{};
    std::array<bool, kKeyCount> keys_{};
    struct Click {
        double x, y, seconds;
    };
    std::optional<Click> click_;  // the last one of the left button
};

}  // namespace prt::tools
