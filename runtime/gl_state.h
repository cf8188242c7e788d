// Lets the runtime draw in the middle of somebody else's frame.
#pragma once

#include <memory>

#include "runtime/gl_context.h"

namespace prt {

/// While it lives, the context has the state that the runtime expects; then it has again what it had before.
/// Every function of Renderer keeps one of its own. One around a whole frame saves time, as those inside do
/// nothing then, but what the caller sets meanwhile reaches into the pictures and is not put back. Nothing
/// happens for contexts that GlContext made itself.
///
/// Kept and set: framebuffers, viewports, first depth range, clip control, enables (depth, stencil and
/// scissor tests, blending of buffers 0 to 7, culling, depth clamp, polygon offset, rasterizer discard,
/// multisampling and what goes with it, primitive restart, logic op, sRGB writes, seamless cube maps, clip
/// distances 0 to 7), depth function and mask, colour masks of buffers 0 to 7, front face, face that is
/// culled, polygon mode, provoking vertex, program, vertex array, textures (2D, 2D array and multisampled,
/// cube and cube array, buffer) and samplers of units 0 to 15, active unit, pixel-transfer buffers and
/// layouts. Not touched: everything else. No query, transform feedback or conditional rendering may be
/// active.
class GlStateGuard {
  public:
    /// Errors that the caller left unread are taken out, with a warning.
    /// @throws Error  the caller's context is not current
    explicit GlStateGuard(const GlContext& context);
    ~GlStateGuard();
    GlStateGuard(const GlStateGuard&) = delete;
    GlStateGuard& operator=(const GlStateGuard&) = delete;

  private:
    struct State;
    std::unique_ptr<State> state_;  // none for a context of our own, and within another guard
};

}  // namespace prt
