// Draws what a ViewState says, into an image of its own. Any context will do: no window is needed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "runtime/gl_context.h"
#include "runtime/technique.h"
#include "tools/relight_arguments.h"
#include "tools/view/point_colours.h"
#include "tools/view/state.h"

namespace prt::tools {

/// What drawing cost and found, for the panel.
struct ViewStatistics {
    double frameMs = 0;   ///< the last frame, glFinish and a clock
    double switchMs = 0;  ///< the last time that light was changed: tables made and uploaded
    int switches = 0;     ///< how often that was
    int frames = 0;
    TechniqueCost cost;        ///< of a pixel
    double exposureStops = 0;  ///< as shown
    /// Of the technique against the reference, where that is there for just this picture.
    std::optional<double> relativeRmse, psnrDb;
    std::string problem;  ///< why the technique cannot be lit like this; empty: it can
};

class SceneView {
  public:
    /// Loads the bundle and the environments.
    /// @param arguments  finished; must outlive the object
    /// @param wake       called from another thread when a reference goes on; may be empty
    /// @throws InputError, UsageError  as prt relight
    SceneView(GlContext& context, const RelightArguments& arguments, std::function<void()> wake = {});
    ~SceneView();

    const ViewChoices& choices() const;
    /// Camera, light and options as the arguments say.
    ViewState startState() const;

    /// Draws; only what changed since the last time is made anew. Reference and difference are of the
    /// technique's own picture until they are traced.
    /// @param width, height  pixels, >= 1
    /// @param moving         a drag or a flight is under way: what takes long may wait
    /// @throws InputError  larger than OpenGL takes; Interrupted
    void draw(const ViewState& state, int width, int height, bool moving = false);
    /// The picture that was drawn last, rows from the top, 3 channels.
    ByteImage image() const;
    /// OpenGL's name of the framebuffer that holds it, lower left corner first.
    unsigned framebuffer() const;
    int width() const;
    int height() const;

    /// Begins to trace the reference of the picture, in another thread, unless that is done; a reference of
    /// another picture is given up, by draw() too. Nothing to do where no environment shines.
    void traceReference(const ViewState& state, int width, int height);
    void stopReference();
    /// Takes a reference that was finished.
    /// @return whether there was one
    bool pollReference();
    /// Whether the reference of the picture is there.
    bool hasReference(const ViewState& state, int width, int height) const;
    /// Share of the reference under way that is done; nothing where none is.
    std::optional<double> referenceProgress() const;

    /// Legend of what is shown; null unless points are.
    const PointColours* pointColours() const;
    const ViewStatistics& statistics() const;
    /// The surface behind a point of a picture of that size, pixels from its top left corner.
    std::optional<Vec3d> pointUnder(const ViewState& state, double x, double y, int width, int height);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt::tools
