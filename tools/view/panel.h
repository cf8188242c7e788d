// The viewer's panel, legend and help, by Dear ImGui. In builds with PRT_WITH_VIEWER.
#pragma once

#include <optional>
#include <string>

#include "tools/view/input.h"
#include "tools/view/scene_view.h"
#include "tools/view/window.h"

namespace prt::tools {

/// What the panel tells besides the state.
struct PanelFacts {
    std::string bundle, renderer;
    std::string message;              ///< of the last action, e.g. "wrote prt-view-0001.png"; may be empty
    double framesPerSecond = 0;       ///< 0: not measured
    std::optional<double> reference;  ///< share that is done of the one under way
};

class ViewPanel {
  public:
    /// Needs the window's context to be current, for as long as it lives.
    explicit ViewPanel(const WindowSize& size);
    ~ViewPanel();
    ViewPanel(const ViewPanel&) = delete;
    ViewPanel& operator=(const ViewPanel&) = delete;

    /// Takes an event.
    /// @return whether it is the panel's alone, and not the scene's
    bool handle(const ViewEvent& event);
    /// Lays out panel, legend and help, and does what the events since the last time did to them. Nothing is
    /// drawn yet.
    /// @param seconds  since the last time, > 0
    void update(double seconds, const WindowSize& size, const SceneView& scene, const ViewInput& input,
                const PanelFacts& facts, ViewState& state, ViewRequests& requests);
    /// Draws it over the window.
    void draw();

  private:
    bool visible_ = false;
};

}  // namespace prt::tools
