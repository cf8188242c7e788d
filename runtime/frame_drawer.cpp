// Sources: deferred shading [SaitoTakahashi1990]: one pass finds what is seen, the second lights it. Of
// several samples to a pixel each triangle is lit once, and the samples are averaged as a display shows them.
#include "runtime/frame_drawer.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "precompute/base/check.h"
#include "precompute/io/bundle.h"

namespace prt {

FrameDrawer::FrameDrawer(const GlContext& context, const Scene& scene)
    : context_(context),
      gl_(context.gl()),
      scene_(context, scene),
      bounds_(sceneBounds(scene)),
      backgroundProgram_(gl_, "screen.vert", "background.frag", ""),
      vertexArray_(makeVertexArray(gl_)) {}

void FrameDrawer::setSuns(std::span<const SunLight> suns, const PointGrid& grid) {
    suns_.clear();
    std::string hash = fmt::format("{}x{} ", grid.width, grid.height);
    for (const SunLight& sun : suns) {
        PRT_CHECK_EQ(sun.shadow.size(), grid.count);
        suns_.push_back({sun.direction, sun.irradiance, {}});
        hash += xxh3Hex(sun.shadow.data(), sun.shadow.size() * sizeof(float));
    }
    if (suns.empty() || hash == shadowsHash_) return;
    std::vector<float> shadows(grid.count * suns.size());
    for (size_t i = 0; i < suns.size(); ++i)
        for (size_t point = 0; point < grid.count; ++point)
            shadows[point * suns.size() + i] = suns[i].shadow[point];
    shadowsHash_.clear();
    sunShadows_ = uploadCoefficients(context_, grid, int(suns.size()), shadows, "shadows of suns");
    shadowsHash_ = hash;
    ++uploads_;
}

void FrameDrawer::setBackground(const FloatImage& latLong, double rotationRad) {
    backgroundRotationRad_ = float(rotationRad);
    const std::string hash =
        fmt::format("{}x{} {}", latLong.width, latLong.height,
                    xxh3Hex(latLong.pixels.data(), latLong.pixels.size() * sizeof(float)));
    if (hash == backgroundHash_) return;
    checkImageSize(gl_, "background", latLong.width, latLong.height, "scale it down");
    backgroundHash_.clear();
    background_ = makeImage(gl_, GL_RGBA32F, latLong.width, latLong.height);
    gl_.TextureSubImage2D(background_.name(), 0, 0, 0, latLong.width, latLong.height, GL_RGB, GL_FLOAT,
                          latLong.pixels.data());
    context_.check("uploading the background");
    backgroundHash_ = hash;
    ++uploads_;
}

CameraFrame FrameDrawer::begin(const Camera& camera, const RenderOptions& options) {
    const int width = options.width, height = options.height;
    checkImageSize(gl_, "image", width, height, "choose another size");
    PRT_CHECK(options.samples == 1 || options.samples == 4);
    const CameraFrame frame = makeCameraFrame(camera, width, height, bounds_);
    targets_ = nullptr;
    for (auto* targets : {&single_, &several_})
        if (*targets && ((*targets)->width != width || (*targets)->height != height)) targets->reset();
    std::unique_ptr<FrameTargets>& wanted = options.samples == 1 ? single_ : several_;
    if (!wanted) wanted = std::make_unique<FrameTargets>(context_, width, height, options.samples);
    targets_ = wanted.get();
    return frame;
}

void FrameDrawer::drawSurface(const CameraFrame& camera, bool normalMap) {
    const GLuint frame = targets_->surfaceFrame.name();
    const GLuint nothing[4] = {kNoTriangle, 0, 0, 0};
    const GLfloat farthest = 0;
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame);
    gl_.Viewport(0, 0, targets_->width, targets_->height);
    gl_.ClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    gl_.Enable(GL_DEPTH_TEST);
    gl_.DepthMask(GL_TRUE);
    gl_.ClearNamedFramebufferuiv(frame, GL_COLOR, 3, nothing);
    gl_.ClearNamedFramebufferfv(frame, GL_DEPTH, 0, &farthest);
    gl_.DepthFunc(GL_GREATER);
    scene_.draw(camera, normalMap, targets_->samples);
}

void FrameDrawer::setEnvironment(const GlProgram& program, const CameraFrame& camera) const {
    program.set("rayCorner", Vec3f(camera.rayCorner.cast<float>()));
    program.set("rayPerPixelX", Vec3f(camera.rayPerPixelX.cast<float>()));
    program.set("rayPerPixelY", Vec3f(camera.rayPerPixelY.cast<float>()));
    program.set("rotationRad", backgroundRotationRad_);
    gl_.BindTextureUnit(8, background_.name());
}

namespace {

void setShown(const GlProgram& program, const DisplayOptions* shown) {
    program.set("toneCurve", shown ? int(shown->toneCurve) : -1);
    program.set("exposure", shown ? float(std::exp2(shown->exposureStops)) : 1.0f);
}

}  // namespace

// Over the pixels that pass the depth test, with a program in use.
void FrameDrawer::drawPixels(const GlProgram& program, const CameraFrame& camera,
                             const LightPass& pass) const {
    if (targets_->samples > 1) {
        const bool behind = pass.background && background_;
        setShown(program, pass.shown);
        program.set("hasEnvironment", behind);
        if (behind) setEnvironment(program, camera);
    }
    const size_t sunCount = pass.suns ? suns_.size() : 0;
    program.set("sunCount", int(sunCount));
    program.set("sunsPerTexel", int(sunShadows_.grid.domain == PointDomain::Texel));
    for (size_t i = 0; i < sunCount; ++i) {
        program.set(fmt::format("sunDirection[{}]", i).c_str(), suns_[i].direction);
        program.set(fmt::format("sunIrradiance[{}]", i).c_str(), suns_[i].irradiance);
    }
    const std::pair<GLuint, GLuint> images[] = {
        {0, targets_->place.name()},    {1, targets_->normal.name()}, {2, targets_->albedo.name()},
        {3, targets_->triangle.name()}, {6, scene_.indices()},        {7, sunShadows_.texture.name()}};
    for (const auto& [unit, image] : images)
        if (image != 0) gl_.BindTextureUnit(unit, image);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

// Pixels of several samples get a depth by what they see, so that each kind has a pass of its own.
void FrameDrawer::classify() {
    if (!classesProgram_) classesProgram_.emplace(gl_, "screen.vert", "classes.frag", "");
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets_->classFrame.name());
    gl_.DepthFunc(GL_ALWAYS);
    classesProgram_->use();
    gl_.BindTextureUnit(3, targets_->triangle.name());
    gl_.BindVertexArray(vertexArray_.name());
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void FrameDrawer::drawBackground(const CameraFrame& camera, const LightPass& pass) {
    if (targets_->samples > 1 && !shownBackgroundProgram_)
        shownBackgroundProgram_.emplace(gl_, "screen.vert", "background.frag", "#define MULTISAMPLED\n");
    const GlProgram& program = targets_->samples > 1 ? *shownBackgroundProgram_ : backgroundProgram_;
    program.use();
    setShown(program, pass.shown);
    setEnvironment(program, camera);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void FrameDrawer::drawLight(const CameraFrame& camera, const std::function<const GlProgram&(Pixels)>& use,
                            const LightPass& pass) {
    const GLuint frame = targets_->lightFrame.name();
    const GLfloat black[4] = {};
    if (targets_->samples > 1) classify();
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, frame);
    gl_.DepthMask(GL_FALSE);
    gl_.BindVertexArray(vertexArray_.name());
    gl_.ClearNamedFramebufferfv(frame, GL_COLOR, 0, black);
    gl_.ClearNamedFramebufferfv(frame, GL_COLOR, 1, black);
    if (targets_->samples > 1) {
        gl_.DepthFunc(GL_EQUAL);
        for (const auto& [pixels, depth] :
             {std::pair(Pixels::OneTriangle, 0.25), std::pair(Pixels::Several, 0.5)}) {
            gl_.DepthRangeIndexed(0, depth, depth);
            drawPixels(use(pixels), camera, pass);
        }
        gl_.DepthRangeIndexed(0, 0, 1);
    } else {
        gl_.DepthFunc(GL_LESS);  // than that of nothing, at which the screen's triangle lies
        drawPixels(use(Pixels::OneSample), camera, pass);
        gl_.DepthFunc(GL_EQUAL);
    }
    if (pass.background && background_) drawBackground(camera, pass);
}

}  // namespace prt
