// Sources: [IwanickiSloan2012, Sec. 3 to 5] for the techniques. Deferred: one pass finds what is seen, the
// second lights each pixel once, so that surface() gives exactly the points that render() shades.
#include "runtime/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "runtime/camera_frame.h"
#include "runtime/display_pass.h"
#include "runtime/gl_objects.h"
#include "runtime/gl_state.h"
#include "runtime/scene_images.h"
#include "runtime/technique_data.h"

namespace prt {
namespace {

// Everything drawn for one image size.
struct Targets {
    int width = 0, height = 0;
    GlObject place, normal, albedo, triangle, depth, radiance, irradiance;
    GlObject surfaceFrame, lightFrame;

    Targets(const GlContext& context, int w, int h) : width(w), height(h) {
        const GlFunctions& gl = context.gl();
        for (GlObject* image : {&place, &normal, &albedo, &radiance, &irradiance})
            *image = makeImage(gl, GL_RGBA32F, w, h);
        triangle = makeImage(gl, GL_R32UI, w, h);
        depth = makeImage(gl, GL_DEPTH_COMPONENT32F, w, h);
        context.check("making the image");
        surfaceFrame = makeFramebufferOver(gl, {place.name(), normal.name(), albedo.name(), triangle.name()},
                                           depth.name());
        lightFrame = makeFramebufferOver(gl, {radiance.name(), irradiance.name()}, depth.name());
    }
};

// Colours of points, and the program that shows them.
struct PointColours {
    CoefficientImage colours;
    GlProgram program;
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
          scene(glContext, source),
          bounds(sceneBounds(source)),
          display(glContext) {
        geometry.positions = source.positions;
        geometry.indices = source.indices;
        hasAtlas = !source.uv1.empty();
    }

    CameraFrame begin(const Camera& camera, const RenderOptions& options);
    void drawSurface(const CameraFrame& camera, const RenderOptions& options);
    void drawLight(const GlProgram& program, std::span<const SunLight> lit);
    void drawBackground(const CameraFrame& camera);
    void startLight();
    void drawFrame(const CameraFrame& camera, const TechniqueData* data, const RenderOptions& options);
    void drawPoints(const Camera& camera, const RenderOptions& options);
    const GlProgram& useBaseProgram();
    TechniqueData& dataOf(Technique technique);
    const TechniqueData& ready(Technique technique);
    template <class Map>
    void add(Technique technique, const Map& map, int number, int has);

    GlContext& context;
    const GlFunctions& gl;
    SceneImages scene;
    Bounds bounds;
    Scene geometry;  // positions and indices, for surface()
    bool hasAtlas = false;
    std::map<Technique, TechniqueData> techniques;
    std::vector<SunLight> suns;  // without their shadows
    CoefficientImage sunShadows;
    GlProgram backgroundProgram;
    std::optional<GlProgram> baseProgram;
    std::optional<PointColours> points;
    DisplayPass display;
    GlObject background;
    float backgroundRotationRad = 0;
    GlObject vertexArray;
    std::unique_ptr<Targets> targets;
};

CameraFrame Renderer::State::begin(const Camera& camera, const RenderOptions& options) {
    const int width = options.width, height = options.height;
    checkImageSize(gl, "image", width, height, "choose another size");
    PRT_CHECK_EQ(options.samples, 1);
    const CameraFrame frame = makeCameraFrame(camera, width, height, bounds);
    if (!targets || targets->width != width || targets->height != height) {
        targets.reset();
        targets = std::make_unique<Targets>(context, width, height);
    }
    return frame;
}

void Renderer::State::drawSurface(const CameraFrame& camera, const RenderOptions& options) {
    const GLuint frame = targets->surfaceFrame.name();
    const GLuint nothing[4] = {kNoTriangle, 0, 0, 0};
    const GLfloat farthest = 0;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame);
    gl.Viewport(0, 0, targets->width, targets->height);
    gl.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthMask(GL_TRUE);
    gl.ClearNamedFramebufferuiv(frame, GL_COLOR, 3, nothing);
    gl.ClearNamedFramebufferfv(frame, GL_DEPTH, 0, &farthest);
    gl.DepthFunc(GL_GREATER);
    scene.draw(camera, options.normalMap);
}

const GlProgram& Renderer::State::useBaseProgram() {
    if (!baseProgram) baseProgram.emplace(gl, "screen.vert", "light.frag", "#define BASE_PASS\n");
    baseProgram->use();
    return *baseProgram;
}

// Over the pixels whose depth is greater than that of nothing, with a program in use.
void Renderer::State::drawLight(const GlProgram& program, std::span<const SunLight> lit) {
    gl.DepthFunc(GL_LESS);
    program.set("sunCount", int(lit.size()));
    for (size_t i = 0; i < lit.size(); ++i) {
        program.set(fmt::format("sunDirection[{}]", i).c_str(), lit[i].direction);
        program.set(fmt::format("sunIrradiance[{}]", i).c_str(), lit[i].irradiance);
    }
    const std::pair<GLuint, GLuint> images[] = {{0, targets->place.name()},  {1, targets->normal.name()},
                                                {2, targets->albedo.name()}, {3, targets->triangle.name()},
                                                {6, scene.indices()},        {7, sunShadows.texture.name()}};
    for (const auto& [unit, image] : images)
        if (image != 0) gl.BindTextureUnit(unit, image);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::State::drawBackground(const CameraFrame& camera) {
    gl.DepthFunc(GL_EQUAL);
    backgroundProgram.use();
    backgroundProgram.set("rayCorner", Vec3f(camera.rayCorner.cast<float>()));
    backgroundProgram.set("rayPerPixelX", Vec3f(camera.rayPerPixelX.cast<float>()));
    backgroundProgram.set("rayPerPixelY", Vec3f(camera.rayPerPixelY.cast<float>()));
    backgroundProgram.set("rotationRad", backgroundRotationRad);
    gl.BindTextureUnit(0, background.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::State::startLight() {
    const GLuint frame = targets->lightFrame.name();
    const GLfloat black[4] = {};
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame);
    gl.DepthMask(GL_FALSE);
    gl.BindVertexArray(vertexArray.name());
    gl.ClearNamedFramebufferfv(frame, GL_COLOR, 0, black);
    gl.ClearNamedFramebufferfv(frame, GL_COLOR, 1, black);
}

// Without data: the base pass.
void Renderer::State::drawFrame(const CameraFrame& camera, const TechniqueData* data,
                                const RenderOptions& options) {
    drawSurface(camera, options);
    startLight();
    if (data)
        drawLight(data->use(), suns);
    else
        drawLight(useBaseProgram(), {});
    if (background) drawBackground(camera);
}

void Renderer::State::drawPoints(const Camera& camera, const RenderOptions& options) {
    if (!points) throw InputError("points", "no colours were set", "set them before drawing");
    drawSurface(begin(camera, options), options);
    startLight();
    points->program.use();
    points->program.set("gridSize", points->colours.grid.width, points->colours.grid.height);
    gl.BindTextureUnit(4, points->colours.texture.name());
    drawLight(points->program, {});
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
    state_->vertexArray = makeVertexArray(state_->gl);
    state_->backgroundProgram = GlProgram(state_->gl, "screen.vert", "background.frag", "");
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
    s.dataOf(technique).setTable(table);
}

void Renderer::setLight(Technique technique, const LiveLight& light, const std::vector<double>& weights,
                        double rotationRad) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    TechniqueData& data = s.dataOf(technique);
    if (technique.kind == TechniqueKind::Unc)
        data.setTable(light.lightCosineTable(weights, rotationRad, data.shOrder()));
    else if (technique.kind == TechniqueKind::Pca || technique.kind == TechniqueKind::VertexPca)
        data.setTable(light.tripleProductTable(weights, rotationRad, data.basis()));
    else if (technique.kind == TechniqueKind::PreconvolvedAo)
        data.setTable(light.preconvolvedTable(weights, rotationRad));
    else if (technique.kind == TechniqueKind::ShLightmap)
        throw InputError(techniqueName(technique), "its light is in its data",
                         "add the lightmap of another light");
    else
        data.setLight(light.blend(weights, rotationRad), light.cosineBands());
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
    s.suns.clear();
    s.sunShadows = {};
    if (suns.empty()) return;
    std::vector<float> shadows(grid.count * suns.size());
    for (size_t i = 0; i < suns.size(); ++i) {
        PRT_CHECK_EQ(suns[i].shadow.size(), grid.count);
        for (size_t point = 0; point < grid.count; ++point)
            shadows[point * suns.size() + i] = suns[i].shadow[point];
        s.suns.push_back({suns[i].direction, suns[i].irradiance, {}});
    }
    s.sunShadows = uploadCoefficients(s.context, grid, int(suns.size()), shadows, "shadows of suns");
}

void Renderer::setBackground(const FloatImage& latLong, double rotationRad) {
    PRT_CHECK_EQ(latLong.channels, 3);
    State& s = *state_;
    const GlStateGuard guard(s.context);
    checkImageSize(s.gl, "background", latLong.width, latLong.height, "scale it down");
    s.background = makeImage(s.gl, GL_RGBA32F, latLong.width, latLong.height);
    s.gl.TextureSubImage2D(s.background.name(), 0, 0, 0, latLong.width, latLong.height, GL_RGB, GL_FLOAT,
                           latLong.pixels.data());
    s.backgroundRotationRad = float(rotationRad);
    s.context.check("uploading the background");
}

RenderedFrame Renderer::render(const Camera& camera, Technique technique, const RenderOptions& options) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    const TechniqueData& data = s.ready(technique);
    s.drawFrame(s.begin(camera, options), &data, options);
    s.context.check("drawing");
    RenderedFrame frame;
    frame.radiance = readRgb(s.gl, s.targets->radiance, options.width, options.height);
    frame.irradiance = readRgb(s.gl, s.targets->irradiance, options.width, options.height);
    s.context.check("reading the image back");
    return frame;
}

void Renderer::draw(const Camera& camera, Technique technique, const RenderOptions& options,
                    const DisplayOptions& display, const DrawTarget& target) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    const TechniqueData& data = s.ready(technique);
    s.drawFrame(s.begin(camera, options), &data, options);
    s.display.draw(s.targets->radiance.name(), options.width, options.height, display, target);
    s.context.check("drawing");
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
    s.points.emplace(PointColours{std::move(colours), GlProgram(s.gl, "screen.vert", "light.frag", defines)});
}

void Renderer::drawPoints(const Camera& camera, const RenderOptions& options, const DisplayOptions& display,
                          const DrawTarget& target) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.drawPoints(camera, options);
    s.display.draw(s.targets->radiance.name(), options.width, options.height, display, target);
    s.context.check("drawing");
}

FloatImage Renderer::renderPoints(const Camera& camera, const RenderOptions& options) {
    State& s = *state_;
    const GlStateGuard guard(s.context);
    s.drawPoints(camera, options);
    FloatImage image = readRgb(s.gl, s.targets->radiance, options.width, options.height);
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
    s.drawSurface(s.begin(camera, options), options);
    s.context.check("drawing");
    SurfaceImage image;
    image.width = options.width;
    image.height = options.height;
    const size_t pixels = size_t(options.width) * size_t(options.height);
    const std::vector<float> places = readImage(s.gl, s.targets->place, pixels);
    const std::vector<float> normals = readImage(s.gl, s.targets->normal, pixels);
    const std::vector<float> albedos = readImage(s.gl, s.targets->albedo, pixels);
    image.triangle.resize(pixels);
    s.gl.GetTextureImage(s.targets->triangle.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
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
    const CameraFrame view = s.begin(camera, options);
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
