// Sources: [IwanickiSloan2012, Sec. 3 to 5] for the techniques. What is seen is found before it is lit
// (runtime/frame_drawer.h), so that surface() gives exactly the points that render() shades.
#include "runtime/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "runtime/display_pass.h"
#include "runtime/frame_drawer.h"
#include "runtime/gl_objects.h"
#include "runtime/gl_state.h"
#include "runtime/light_program.h"
#include "runtime/technique_data.h"
#include "runtime/technique_lights.h"

namespace prt {
namespace {

// Colours of points, and the program that shows them.
struct PointColours {
    CoefficientImage colours;
    LightProgram program;
};

std::vector<float> readImage(const GlFunctions& gl, const GlObject& image, size_t pixels) {
    std::vector<float> values(pixels * 4);
    gl.GetTextureImage(image.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(values.size() * sizeof(float)),
                       values.data());
    return values;
}

FloatImage readRgb(const GlFunctions& gl, const GlObject& image, int width, int height) {
    const size_t pixels = size_t(width) * size_t(height);
    const std::vector<float> rgba = readImage(gl, image, pixels);
    FloatImage result{width, height, 3, std::vector<float>(pixels * 3)};
    for (size_t i = 0; i < pixels; ++i) std::copy_n(&rgba[i * 4], 3, &result.pixels[i * 3]);
    return result;
}

void checkGrid(const PointGrid& grid, size_t vertexCount, bool hasAtlas, const char* what) {
    if (grid.domain == PointDomain::Vertex && grid.count != vertexCount)
        throw InputError(what, fmt::format("holds {} vertices, the mesh {}", grid.count, vertexCount),
                         "both must come from one run of prt precompute");
    if (grid.domain == PointDomain::Texel && !hasAtlas)
        throw InputError(what, "is per texel, but the mesh has no atlas coordinates (TEXCOORD_1)",
                         "both must come from one run of prt precompute");
}

Vec3f fromRgba(const float* rgba) { return {rgba[0], rgba[1], rgba[2]}; }

}  // namespace

struct Renderer::State {
    State(GlContext& glContext, const Scene& source)
        : context(glContext),
          gl(glContext.gl()),
          frame(glContext, source),
          lights(glContext),
          display(glContext) {
        geometry.positions = source.positions;
        geometry.indices = source.indices;
        hasAtlas = !source.uv1.empty();
    }

    /// @param data  none: the base pass
    void drawFrame(const CameraFrame& camera, const TechniqueData* data, const RenderOptions& options,
                   const DisplayOptions* shown = nullptr);
    void drawPoints(const Camera& camera, const RenderOptions& options, const DisplayOptions* shown);
    void show(const RenderOptions& options, const DisplayOptions& display, const DrawTarget& target);
    TechniqueData& dataOf(Technique technique);
    const TechniqueData& ready(Technique technique);
    template <class Map>
    void add(Technique technique, const Map& map, int number, int has);

    GlContext& context;
    const GlFunctions& gl;
    FrameDrawer frame;
    Scene geometry;  // positions and indices, for surface()
    bool hasAtlas = false;
    std::map<Technique, TechniqueData> techniques;
    TechniqueLights lights;
    uint64_t tables = 0;  // that were given as such
    std::optional<LightProgram> baseProgram;
    std::optional<PointColours> points;
    DisplayPass display;
};

void Renderer::State::drawFrame(const CameraFrame& camera, const TechniqueData* data,
                                const RenderOptions& options, const DisplayOptions* shown) {
    frame.drawSurface(camera, options.normalMap);
    if (data) {
        frame.drawLight(camera, [&](Pixels pixels) -> const GlProgram& { return data->use(pixels); },
                        {.shown = shown});
        return;
    }
    if (!baseProgram) baseProgram.emplace(gl, "#define BASE_PASS\n");
    const auto use = [&](Pixels pixels) -> const GlProgram& {
        const GlProgram& program = baseProgram->of(pixels);
        program.use();
        return program;
    };
    frame.drawLight(camera, use, {.suns = false, .shown = shown});
}

void Renderer::State::drawPoints(const Camera& camera, const RenderOptions& options,
                                 const DisplayOptions* shown) {
    if (!points) throw InputError("points", "no colours were set", "set them before drawing");
    const CameraFrame view = frame.begin(camera, options);
    frame.drawSurface(view, options.normalMap);
    const auto use = [&](Pixels pixels) -> const GlProgram& {
        const GlProgram& program = points->program.of(pixels);
        program.use();
        program.set("gridSize", points->colours.grid.width, points->colours.grid.height);
        gl.BindTextureUnit(4, points->colours.texture.name());
        return program;
    };
    frame.drawLight(view, use, {.suns = false, .background = false, .shown = shown});
    context.check("drawing");
}

// What was drawn; of several samples, drawn as it is shown but for the sRGB curve.
void Renderer::State::show(const RenderOptions& options, const DisplayOptions& shown,
                           const DrawTarget& target) {
    display.draw(frame.targets().radiance.name(), options.width, options.height,
                 options.samples > 1 ? DisplayOptions() : shown, target);
    context.check("drawing");
}

TechniqueData& Renderer::State::dataOf(Technique technique) {
    const auto found = techniques.find(technique);
    if (found != techniques.end()) return found->second;
    throw missingData(technique);
}

const TechniqueData& Renderer::State::ready(Technique technique) {
    const TechniqueData& data = dataOf(technique);
    data.checkLight();
    return data;
}

Renderer::Renderer(GlContext& context, const Scene& scene, const VisibilityMap* visibility,
                   const PcaMap* pca) {
    const GlStateGuard guard(context);
    const size_t vertices = scene.vertexCount();
    if (visibility) checkGrid(visibility->grid, vertices, !scene.uv1.empty(), "visibility");
    if (pca) checkGrid(pca->grid, vertices, !scene.uv1.empty(), "PCA weights");
    state_ = std::make_unique<State>(context, scene);
    if (visibility) add(Technique::Unc, *visibility);
    if (pca) add(Technique::Pca, *pca);
    context.check("making the renderer");
}

Renderer::~Renderer() {
    if (state_) state_->context.makeCurrent();
}

template <class Map>
void Renderer::State::add(Technique technique, const Map& map, int number, int has) {
    const GlStateGuard guard(context);
    checkGrid(map.grid, geometry.vertexCount(), hasAtlas,
              readsVisibility(technique) ? "visibility"
              : readsWeights(technique)  ? "PCA weights"
                                         : "lightmap");
    if (number > 0 && number != has)
        throw InputError(techniqueName(technique), fmt::format("was given {} in place of {}", has, number),
                         "reduce it to them");
    techniques.erase(technique);
    lights.forget(technique);
    techniques.emplace(std::piecewise_construct, std::forward_as_tuple(technique),
                       std::forward_as_tuple(context, technique, map));
}

void Renderer::add(Technique technique, const VisibilityMap& visibility) {
    PRT_CHECK(readsVisibility(technique));
    const int number = technique.kind == TechniqueKind::Sh2 ? 2 : technique.number;
    state_->add(technique, visibility, number, visibility.shOrder);
}

void Renderer::add(Technique technique, const PcaMap& pca) {
    PRT_CHECK(readsWeights(technique));
    PRT_CHECK(technique.kind != TechniqueKind::VertexPca || pca.grid.domain == PointDomain::Vertex);
    state_->add(technique, pca, technique.number, pca.components);
}

void Renderer::add(Technique technique, const Lightmap& lightmap) {
    PRT_CHECK(technique.kind == TechniqueKind::ShLightmap);
    const auto found = state_->techniques.find(technique);
    if (found == state_->techniques.end()) {
        state_->add(technique, lightmap, 0, 0);
        return;
    }
    const GlStateGuard guard(state_->context);
    checkGrid(lightmap.grid, state_->geometry.vertexCount(), state_->hasAtlas, "lightmap");
    found->second.setLightmap(lightmap);
}

void Renderer::setTable(const NormalTable& table) {
    setTable(table.kind == TableKind::TripleProduct ? Technique::Pca : Technique::Unc, table);
}

void Renderer::setTable(Technique technique, const NormalTable& table) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    if (!s.techniques.contains(technique))
        throw InputError(techniqueName(technique),
                         fmt::format("a {} table was given, but {}", tableKindName(table.kind),
                                     readsVisibility(technique) ? "no visibility" : "no PCA weights"));
    s.lights.forget(technique);
    s.dataOf(technique).setTable(table);
    ++s.tables;
}

void Renderer::setLight(Technique technique, const LiveLight& light, const std::vector<double>& weights,
                        double rotationRad, BlendOn blendOn) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.lights.set(technique, s.dataOf(technique), light, weights, rotationRad, blendOn);
}

TableTexture Renderer::tableTexture(Technique technique) const {
    if (!usesTable(technique)) throw InputError(techniqueName(technique), "has no table");
    const TableImage& table = state_->ready(technique).table();
    const TableShape& shape = table.shape;
    const int groups = 3 * shape.layers + (shape.mean ? 1 : 0);
    return {table.texture.name(), shape.layout, shape.size, shape.layers, shape.mean, shape.images / groups};
}

std::string Renderer::shaderDefines(Technique technique) const { return state_->ready(technique).defines(); }

uint64_t Renderer::uploads() const {
    return state_->lights.tableUploads() + state_->tables + state_->frame.uploads();
}

uint64_t Renderer::lightRevision(Technique technique) const {
    return state_->dataOf(technique).lightRevision();
}

void Renderer::setSuns(std::span<const SunLight> suns, const PointGrid& grid) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    if (suns.size() > size_t(kMostSuns))
        throw InputError(
            "suns", fmt::format("{} are more than the {} that are drawn at a time", suns.size(), kMostSuns));
    s.frame.setSuns(suns, grid);
}

void Renderer::setBackground(const FloatImage& latLong, double rotationRad) {
    PRT_CHECK_EQ(latLong.channels, 3);
    const GlStateGuard guard(state_->context);
    state_->frame.setBackground(latLong, rotationRad);
}

RenderedFrame Renderer::render(const Camera& camera, Technique technique, const RenderOptions& options) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    const TechniqueData& data = s.ready(technique);
    s.drawFrame(s.frame.begin(camera, options), &data, options);
    s.context.check("drawing");
    RenderedFrame frame;
    frame.radiance = readRgb(s.gl, s.frame.targets().radiance, options.width, options.height);
    frame.irradiance = readRgb(s.gl, s.frame.targets().irradiance, options.width, options.height);
    s.context.check("reading the image back");
    return frame;
}

void Renderer::draw(const Camera& camera, Technique technique, const RenderOptions& options,
                    const DisplayOptions& display, const DrawTarget& target) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    const TechniqueData& data = s.ready(technique);
    s.drawFrame(s.frame.begin(camera, options), &data, options, &display);
    s.show(options, display, target);
}

ByteImage Renderer::picture(const Camera& camera, Technique technique, const RenderOptions& options,
                            const DisplayOptions& display) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    checkImageSize(s.gl, "image", options.width, options.height, "choose another size");
    const GlObject colours = makeImage(s.gl, GL_RGBA8, options.width, options.height);
    const GlObject framebuffer = makeFramebufferOver(s.gl, {colours.name()}, 0);
    draw(camera, technique, options, display, {framebuffer.name(), 0, 0});
    ByteImage image{options.width, options.height, 4, {}};
    const size_t rowBytes = size_t(options.width) * 4, rows = size_t(options.height);
    std::vector<uint8_t> bytes(rowBytes * rows);
    s.gl.GetTextureImage(colours.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, GLsizei(bytes.size()), bytes.data());
    s.context.check("reading the image back");
    for (size_t y = rows; y-- > 0;)  // OpenGL's lowest comes first
        image.pixels.insert(image.pixels.end(), bytes.begin() + ptrdiff_t(y * rowBytes),
                            bytes.begin() + ptrdiff_t((y + 1) * rowBytes));
    return image;
}

void Renderer::setPointColours(const PointGrid& grid, std::span<const float> rgb, bool smooth) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    checkGrid(grid, s.geometry.vertexCount(), s.hasAtlas, "colours of points");
    CoefficientImage colours = uploadCoefficients(s.context, grid, 3, rgb, "colours of points");
    std::string defines = "#define POINT_COLOURS\n";
    if (grid.domain == PointDomain::Vertex) defines += "#define PER_VERTEX\n";
    if (!smooth) {
        defines += "#define NEAREST_POINT\n";
        for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
            s.gl.TextureParameteri(colours.texture.name(), filter, GL_NEAREST);
    }
    s.points.emplace(PointColours{std::move(colours), LightProgram(s.gl, defines)});
}

void Renderer::drawPoints(const Camera& camera, const RenderOptions& options, const DisplayOptions& display,
                          const DrawTarget& target) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.drawPoints(camera, options, &display);
    s.show(options, display, target);
}

FloatImage Renderer::renderPoints(const Camera& camera, const RenderOptions& options) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.drawPoints(camera, options, nullptr);
    FloatImage image = readRgb(s.gl, s.frame.targets().radiance, options.width, options.height);
    s.context.check("reading the image back");
    return image;
}

void Renderer::drawImage(const FloatImage& image, const DisplayOptions& display, const DrawTarget& target) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.display.draw(image, display, target);
    s.context.check("drawing");
}

SurfaceImage Renderer::surface(const Camera& camera, const RenderOptions& options) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    RenderOptions single = options;
    single.samples = 1;
    s.frame.drawSurface(s.frame.begin(camera, single), options.normalMap);
    s.context.check("drawing");
    const FrameTargets& targets = s.frame.targets();
    SurfaceImage image;
    image.width = options.width;
    image.height = options.height;
    const size_t pixels = size_t(options.width) * size_t(options.height);
    const std::vector<float> places = readImage(s.gl, targets.place, pixels);
    const std::vector<float> normals = readImage(s.gl, targets.normal, pixels);
    const std::vector<float> albedos = readImage(s.gl, targets.albedo, pixels);
    image.triangle.resize(pixels);
    s.gl.GetTextureImage(targets.triangle.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                         GLsizei(pixels * sizeof(uint32_t)), image.triangle.data());
    s.context.check("reading the image back");
    for (auto* vectors : {&image.position, &image.geometricNormal, &image.shadingNormal, &image.albedo})
        vectors->assign(pixels, Vec3f::Zero());
    parallelFor(pixels, 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const uint32_t triangle = image.triangle[i];
            if (triangle == kNoTriangle) continue;
            image.geometricNormal[i] = triangleNormal(s.geometry, triangle);
            image.shadingNormal[i] = fromRgba(&normals[i * 4]);
            image.albedo[i] = fromRgba(&albedos[i * 4]);
            // As in light.frag: a centre a little outside of its triangle goes to the triangle's edge.
            Vec3d b(1.0 - places[i * 4] - places[i * 4 + 1], places[i * 4], places[i * 4 + 1]);
            b = b.cwiseMax(0.0);
            b /= b.sum();
            Vec3d point = Vec3d::Zero();
            for (int corner = 0; corner < 3; ++corner) {
                const uint32_t vertex = s.geometry.indices[size_t(triangle) * 3 + size_t(corner)];
                point += b[corner] * s.geometry.positions[vertex].cast<double>();
            }
            image.position[i] = point.cast<float>();
        }
    });
    return image;
}

double Renderer::frameMilliseconds(const Camera& camera, std::optional<Technique> technique,
                                   const RenderOptions& options, int frames, int warmUpFrames) {
    PRT_CHECK_LT(0, frames);
    State& s = *state_;
    const GlStateGuard guard(s.context);
    const TechniqueData* data = technique ? &s.ready(*technique) : nullptr;
    const CameraFrame view = s.frame.begin(camera, options);
    std::vector<double> times;
    for (int i = 0; i < warmUpFrames + frames; ++i) {
        throwIfInterrupted();
        const Stopwatch watch;
        s.drawFrame(view, data, options);
        s.gl.Finish();
        if (i >= warmUpFrames) times.push_back(watch.seconds() * 1e3);
    }
    s.context.check("drawing");
    std::ranges::sort(times);
    const size_t half = times.size() / 2;
    return times.size() % 2 ? times[half] : (times[half - 1] + times[half]) / 2;
}

}  // namespace prt
