// One scene with everything a frame can show, drawn in any context.
#pragma once

#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt::test {

/// A textured, normal-mapped, double-sided floor and a sphere, with noise for visibility, under coloured
/// light and a visible background.
class Showcase {
  public:
    explicit Showcase(PointDomain domain);
    /// A renderer that is ready to draw by unc and pca.
    std::unique_ptr<Renderer> makeRenderer(GlContext& context) const;
    RenderedFrame draw(Renderer& renderer, Technique technique) const;
    /// What draw() gives to the renderer.
    static Camera camera();
    static RenderOptions options() { return {80, 60, true}; }

  private:
    Scene scene_;
    VisibilityMap visibility_;
    PcaMap pca_;
    NormalTable lightCosine_, tripleProduct_;
    FloatImage background_;
};

/// Memory of this process that is in RAM.
size_t residentBytes();

/// √(Σ(a−b)²/Σa²); fails the test where a is black.
double relativeRmse(const FloatImage& a, const FloatImage& b);

}  // namespace prt::test
