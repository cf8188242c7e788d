// A scene whose visibility is traced by the test itself, with what every technique reads.
#pragma once

#include <memory>

#include "precompute/io/lightmap_file.h"
#include "runtime/live_light.h"
#include "runtime/renderer.h"
#include "test_scenes.h"

namespace prt::test {

/// A sphere before a wall, on a normal-mapped, textured floor, under two blended and turned skies.
class GoldenScene {
  public:
    GoldenScene();
    /// Draws by any of listedTechniques().
    std::unique_ptr<Renderer> makeRenderer(GlContext& context) const;
    static Camera camera();

  private:
    Scene scene_;
    VisibilityMap visibility_;
    PcaMap pca_, vertexPca_;
    Lightmap lightmap_;
    std::unique_ptr<LiveLight> light_;
    FloatImage background_;
};

}  // namespace prt::test
