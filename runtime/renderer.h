// Draws a bundle's mesh, lit by precomputed visibility, into float images, pictures, or framebuffers of the
// caller's. Backs of triangles are not drawn, unless their material is double-sided. A context that is the
// caller's keeps its state (gl_state.h).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/io/lightmap_file.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "runtime/gl_context.h"
#include "runtime/live_light.h"
#include "runtime/technique.h"

namespace prt {

struct RenderOptions {
    int width = 1280, height = 800;
    bool normalMap = true;
    /// Of a pixel, 1 (at its centre) or 4. Of four, each triangle that the pixel shows is shaded once, and
    /// its samples are averaged.
    int samples = 1;
};

/// How radiance becomes the colours of a display; as toDisplay.
struct DisplayOptions {
    double exposureStops = 0;
    ToneCurve toneCurve = ToneCurve::None;
};

/// Where a picture goes: a framebuffer of the renderer's context.
struct DrawTarget {
    unsigned framebuffer = 0;  ///< OpenGL's name; 0: the window's own
    int x = 0, y = 0;          ///< lower left corner of the picture in it, pixels from its lower left corner
};

struct RenderedFrame {
    /// 3 channels: albedo/π·E; background where nothing is seen. Linear in the light, so slightly negative
    /// where the truncated series of E is; toDisplay shows that as black.
    FloatImage radiance;
    /// 3 channels: E; 0 where nothing is seen. Of four samples, the mean of those that see something.
    FloatImage irradiance;
};

/// A light from one small disc of the sky, with its own shadow.
struct SunLight {
    Vec3f direction = Vec3f::UnitY();  ///< towards it, unit, world
    Vec3f irradiance = Vec3f::Zero();  ///< of a surface that faces it, per colour
    std::vector<float> shadow;         ///< [points of the grid] visible share of the disc, 0..1
};
/// Suns that a renderer draws at a time.
inline constexpr int kMostSuns = 8;

/// The table of a technique as OpenGL has it: a 2D array of RGBA32F, linearly filtered, without mipmaps.
/// Group g = colour·layers + i holds coefficients 4i … 4i + 3 of a colour (R, G, B: 0, 1, 2), one to a
/// channel; group 3·layers the mean of triple products, in RGB. A group is `imagesPerGroup` images of the
/// array, from g·imagesPerGroup on: of a cube the faces, in OpenGL's order, each within a border of one texel
/// of its neighbours. runtime/shaders/table.glsl reads it.
/// @source [IwanickiSloan2012, Sec. 3.4]
struct TableTexture {
    unsigned name = 0;     ///< OpenGL's; another when a table of another shape is set
    std::string layout;    ///< "cube", "dual-paraboloid" or "octahedral" (math/table_layout.h)
    int size = 0;          ///< texels along the side of a face, without a border
    int layers = 0;        ///< groups of a colour
    bool hasMean = false;  ///< of techniques that read weights, and of PreconvolvedAo, which has no more
    int imagesPerGroup = 1;
};

/// Where tables of blended environments are made.
enum class BlendOn {
    Cpu,  ///< environments are blended, then their table is built and uploaded
    Gpu   ///< each environment has a table of its own on the GPU; other weights cost one pass over them
};

class Renderer {
  public:
    /// Uploads geometry and textures, and adds Unc and Pca where visibility and PCA weights are given.
    /// @throws InputError  as add(); texture limits exceeded
    Renderer(GlContext& context, const Scene& scene, const VisibilityMap* visibility, const PcaMap* pca);
    ~Renderer();

    /// Uploads what a technique reads; replaces what it read before. Domain and size are taken from the grid.
    /// Of a technique with a number the map must have just that many bands or vectors, Sh2 two bands
    /// (compress/reduce_visibility.h).
    /// @throws InputError  per-vertex count differs from the mesh, no uv1 for per-texel data, other bands or
    /// vectors, texture limits exceeded
    void add(Technique technique, const VisibilityMap& visibility);
    /// VertexPca takes a map per vertex (precompute/mesh/vertex_values.h makes one from texels).
    void add(Technique technique, const PcaMap& pca);
    /// ShLightmap, whose light is in its data: it needs no setLight(), is not turned by it, and suns are not
    /// added to it.
    void add(Technique technique, const Lightmap& lightmap);

    /// Uploads the table of Unc or Pca (already blended and rotated); replaces the previous one.
    /// @throws InputError  kind, order or layer count does not fit the visibility or PCA data
    void setTable(const NormalTable& table);
    /// The same for any technique that takes a table.
    void setTable(Technique technique, const NormalTable& table);
    /// Light of any technique that was added: its table, or what it has in place of one. Nothing is done
    /// where the technique has this light, of these weights and rotation, already.
    /// @param light        of the bands of the visibility that maps were made from, or more
    /// @param weights      [environments] any numbers
    /// @param rotationRad  turn about the up axis
    /// @param blendOn      techniques with uniforms in place of a table are blended on the CPU always
    /// @throws InputError  the technique was not added, or is ShLightmap; more uniforms than OpenGL takes
    void setLight(Technique technique, const LiveLight& light, const std::vector<double>& weights,
                  double rotationRad, BlendOn blendOn = BlendOn::Cpu);
    /// How often the technique was given a table or light: the same number, the same light.
    /// @throws InputError  the technique was not added
    uint64_t lightRevision(Technique technique) const;
    /// The table of the technique's present light, to be read by shaders of the caller's: valid until the
    /// technique is added again, or the renderer is destroyed; its texels change with the light.
    /// @throws InputError  the technique was not added, takes no table, or has none yet
    TableTexture tableTexture(Technique technique) const;
    /// Lines for runtime/shader_sources.h with which light.frag and table.glsl fit the technique and the
    /// table or uniforms that it has at present.
    /// @throws InputError  the technique was not added, or has no light
    std::string shaderDefines(Technique technique) const;
    /// Lights besides the tables', for every technique; replaces the previous ones. Each adds its irradiance
    /// × max(0, n·direction) × shadow.
    /// @param grid  of the shadows: that of the visibility or PCA data
    /// @throws InputError  more than kMostSuns
    void setSuns(std::span<const SunLight> suns, const PointGrid& grid);
    /// Tables, backgrounds and shadows of suns that were sent to OpenGL so far: those that did not change are
    /// not sent again.
    uint64_t uploads() const;
    /// Background: radiance per world direction, or black when never set.
    /// @throws InputError  larger than OpenGL takes
    void setBackground(const FloatImage& latLong, double rotationRad);

    /// @throws InputError  the technique was not added, or has no table or light
    RenderedFrame render(const Camera& camera, Technique technique, const RenderOptions& options);
    /// The same frame, as a display shows it, into colour output 0 of a framebuffer: within 1/255 of
    /// toDisplay of what render() gives, right way up; pixels outside of the picture stay. Values are sRGB
    /// whatever the framebuffer's format is: it is written as it is, without conversion on writing.
    ///
    /// Of four samples, exposure and tone curve come before the mean (render() takes the mean of linear
    /// radiance): an edge before a bright sky is smooth only so.
    /// @throws InputError  as render(); a target that is no complete framebuffer
    void draw(const Camera& camera, Technique technique, const RenderOptions& options,
              const DisplayOptions& display, const DrawTarget& target);

    /// What draw() shows, as an image.
    /// @return 4 channels, alpha 255
    /// @throws InputError  as render()
    ByteImage picture(const Camera& camera, Technique technique, const RenderOptions& options,
                      const DisplayOptions& display);

    /// Colours of the points of a grid, to look at what is stored there (weights, coefficients, validity,
    /// charts); replaces the previous ones.
    /// @param grid    of the visibility or PCA data
    /// @param rgb     [grid.count×3] linear; any numbers
    /// @param smooth  interpolated between points; else each place has the colour of the nearest texel, or
    /// of the corner with the largest barycentric coordinate
    /// @throws InputError  the grid is not of this mesh, texture limits exceeded
    void setPointColours(const PointGrid& grid, std::span<const float> rgb, bool smooth);
    /// Those colours unlit, without albedo, tone or background, as draw() shows a frame.
    /// @throws InputError  no colours were set; options or target as in draw()
    void drawPoints(const Camera& camera, const RenderOptions& options, const DisplayOptions& display,
                    const DrawTarget& target);
    /// The same as numbers.
    /// @return 3 channels; 0 where nothing is seen
    /// @throws InputError  no colours were set; options as in render()
    FloatImage renderPoints(const Camera& camera, const RenderOptions& options);
    /// An image made elsewhere, shown the same way.
    /// @param image  3 channels, or 4, the last of which is not shown; linear
    /// @throws InputError  larger than OpenGL takes; target as in draw()
    void drawImage(const FloatImage& image, const DisplayOptions& display, const DrawTarget& target);

    /// The points that render() shades with one sample to a pixel: same geometry, textures, normal maps and
    /// filtering.
    SurfaceImage surface(const Camera& camera, const RenderOptions& options);
    /// Median time of a frame, ms, glFinish and a clock, after warm-up.
    /// @param technique  none: the base pass, the same frame with an irradiance of 1 (geometry, normal map,
    /// albedo), what is to be subtracted to have a technique's own time
    /// @param warmUpFrames  drawn first and not counted; shaders are compiled for the state they meet first
    double frameMilliseconds(const Camera& camera, std::optional<Technique> technique,
                             const RenderOptions& options, int frames, int warmUpFrames = 2);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt
