// Sources: [IwanickiSloan2012, Sec. 3 to 5] for what is drawn; wires the runtime, its light and the
// reference.
#include "tools/view/scene_view.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "precompute/base/check.h"
#include "precompute/base/log.h"
#include "precompute/rays/ray_caster.h"
#include "runtime/camera_frame.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"
#include "runtime/renderer.h"
#include "tools/background.h"
#include "tools/exposure.h"
#include "tools/relight_suns.h"
#include "tools/relight_techniques.h"

namespace prt::tools {
namespace {

// The longer side of the picture that automatic exposure looks at.
constexpr int kExposureSize = 256;

struct Canvas {
    int width = 0, height = 0;
    GlObject image, framebuffer;
};

}  // namespace

struct SceneView::State {
    State(GlContext& glContext, const RelightArguments& given)
        : context(glContext),
          gl(glContext.gl()),
          arguments(given),
          data(loadRelightData(given)),
          available(data.techniques),
          techniques(given, data),
          suns(data.bundle, data.scene, data.environments),
          renderer(glContext, data.scene, nullptr, nullptr) {
        choices.techniques = available;
        for (const Environment& environment : data.environments)
            choices.environments.push_back(environment.name);
        choices.components = data.pca ? data.pca->components : 0;
        choices.coefficients = data.visibility ? data.visibility->shOrder * data.visibility->shOrder : 0;
        choices.charts = data.visibility && data.domain() == PointDomain::Texel;
        choices.bounds = sceneBounds(data.scene);
    }

    const RayCaster& rays() {
        if (!caster) caster.emplace(data.scene.positions, data.scene.indices);
        return *caster;
    }
    void resize(int width, int height);
    void setBackground(const ViewState& view);
    void setLight(const ViewState& view, bool moving);
    void setPoints(const ViewState& view);
    void chooseExposure(const ViewState& view);
    RenderOptions options(const ViewState& view) const {
        return {canvas.width, canvas.height, view.normalMap, view.samples};
    }

    GlContext& context;
    const GlFunctions& gl;
    const RelightArguments& arguments;
    RelightData data;
    const std::vector<Technique> available;
    RelightTechniques techniques;
    RelightSuns suns;
    Renderer renderer;
    ViewChoices choices;
    Canvas canvas;
    std::set<Technique> added;
    struct Light {
        Technique technique;
        std::vector<double> weights;
        double rotationRad = 0;
        bool operator==(const Light&) const = default;
    };
    std::optional<Light> lit;  // what was set last
    FloatImage background;
    std::vector<double> backgroundWeights;  // of `background`
    std::optional<double> backgroundTurn;   // as the renderer has it
    bool hasBackground = true;              // the renderer was given one
    std::optional<PointColours> points;
    std::pair<Shown, int> pointsOf{Shown::Lit, 0};
    std::optional<RayCaster> caster;
    ViewStatistics statistics;
};

SceneView::SceneView(GlContext& context, const RelightArguments& arguments)
    : state_(std::make_unique<State>(context, arguments)) {}

SceneView::~SceneView() { state_->context.makeCurrent(); }

const ViewChoices& SceneView::choices() const { return state_->choices; }
const PointColours* SceneView::pointColours() const {
    return state_->points && state_->pointsOf.first != Shown::Lit ? &*state_->points : nullptr;
}
const ViewStatistics& SceneView::statistics() const { return state_->statistics; }
unsigned SceneView::framebuffer() const { return state_->canvas.framebuffer.name(); }
int SceneView::width() const { return state_->canvas.width; }
int SceneView::height() const { return state_->canvas.height; }

ViewState SceneView::startState() const {
    const RelightArguments& arguments = state_->arguments;
    ViewState view;
    view.camera = OrbitCamera::around(arguments.camera(state_->choices.bounds));
    view.weights = state_->data.weights;
    view.rotationRad = arguments.rotationRad();
    view.exposureStops = arguments.exposureStops.value_or(0);
    view.autoExposure = !arguments.exposureStops;
    view.normalMap = !arguments.noNormalMap;
    view.background = !arguments.noBackground;
    return view;
}

void SceneView::State::resize(int width, int height) {
    if (canvas.width == width && canvas.height == height) return;
    canvas = {};
    const GLint edge = glInteger(gl, GL_MAX_TEXTURE_SIZE);
    PRT_CHECK(width >= 1 && height >= 1 && width <= edge && height <= edge);
    canvas.image = makeImage(gl, GL_RGBA8, width, height);
    canvas.framebuffer = makeFramebufferOver(gl, {canvas.image.name()}, 0);
    canvas.width = width;
    canvas.height = height;
    context.check("making the viewer's image");
}

void SceneView::State::setBackground(const ViewState& view) {
    if (!view.background) {
        if (hasBackground) renderer.setBackground({1, 1, 3, {0, 0, 0}}, 0);
        hasBackground = false;
        backgroundTurn.reset();
        return;
    }
    const std::vector<double> weights = view.effectiveWeights();
    if (weights != backgroundWeights) {
        background = blendImages(data.environments, weights);
        backgroundWeights = weights;
        backgroundTurn.reset();
    }
    if (backgroundTurn == view.rotationRad) return;
    renderer.setBackground(background, view.rotationRad);
    backgroundTurn = view.rotationRad;
    hasBackground = true;
}

void SceneView::State::setLight(const ViewState& view, bool moving) {
    const Technique technique = available[view.technique];
    if (!added.contains(technique)) {
        // Only what is looked at is reduced and uploaded.
        data.techniques = {technique};
        techniques.addTo(renderer);
        added.insert(technique);
    }
    const std::vector<double> weights = view.effectiveWeights();
    const Light light{technique, weights, view.rotationRad};
    const bool changed = lit != light;
    const Stopwatch watch;
    techniques.setLight(renderer, technique, weights, view.rotationRad);
    // Shadows of a turned sun are traced: not in the middle of a drag.
    if (arguments.tables.extractSun && !moving) suns.setTo(renderer, weights, view.rotationRad);
    if (!changed) return;
    gl.Finish();
    statistics.switchMs = watch.seconds() * 1e3;
    ++statistics.switches;
    lit = light;
    statistics.cost = techniqueCost(technique, data.source(), data.domain(), arguments.tables.cosineBands());
}

void SceneView::State::setPoints(const ViewState& view) {
    const std::pair<Shown, int> wanted{view.shown, view.index()};
    if (wanted == pointsOf) return;
    points =
        tools::pointColours(view.shown, view.index(), data.scene,
                            data.visibility ? &*data.visibility : nullptr, data.pca ? &*data.pca : nullptr);
    renderer.setPointColours(points->grid, points->rgb, points->smooth);
    pointsOf = wanted;
}

void SceneView::State::chooseExposure(const ViewState& view) {
    statistics.exposureStops = view.exposureStops;
    if (!view.autoExposure) return;
    const double scale = std::min(1.0, double(kExposureSize) / std::max(canvas.width, canvas.height));
    const RenderOptions small{std::max(1, int(canvas.width * scale)), std::max(1, int(canvas.height * scale)),
                              view.normalMap, 1};
    const Camera camera = view.camera.camera();
    const Technique technique = techniques.drawn(available[view.technique]);
    statistics.exposureStops =
        autoExposure(renderer.render(camera, technique, small).radiance, renderer.surface(camera, small));
}

void SceneView::draw(const ViewState& view, int width, int height, bool moving) {
    State& s = *state_;
    PRT_CHECK(view.technique < s.available.size());
    s.context.makeCurrent();
    s.resize(width, height);
    const Camera camera = view.camera.camera();
    const DrawTarget target{s.canvas.framebuffer.name(), 0, 0};
    if (showsPoints(view.shown)) {
        s.setPoints(view);
        const Stopwatch watch;
        s.renderer.drawPoints(camera, s.options(view), {}, target);
        s.gl.Finish();
        s.statistics.frameMs = watch.seconds() * 1e3;
    } else {
        s.setBackground(view);
        s.setLight(view, moving);
        s.chooseExposure(view);
        const Stopwatch watch;
        s.renderer.draw(camera, s.techniques.drawn(s.available[view.technique]), s.options(view),
                        {s.statistics.exposureStops, view.toneCurve}, target);
        s.gl.Finish();
        s.statistics.frameMs = watch.seconds() * 1e3;
        s.pointsOf.first = Shown::Lit;
    }
    ++s.statistics.frames;
}

ByteImage SceneView::image() const {
    const State& s = *state_;
    PRT_CHECK(s.canvas.width > 0);
    s.context.makeCurrent();
    const size_t row = size_t(s.canvas.width) * 3;
    std::vector<uint8_t> bottomUp(row * size_t(s.canvas.height));
    s.gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    s.gl.GetTextureImage(s.canvas.image.name(), 0, GL_RGB, GL_UNSIGNED_BYTE, GLsizei(bottomUp.size()),
                         bottomUp.data());
    s.gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
    s.context.check("reading the picture back");
    ByteImage image{s.canvas.width, s.canvas.height, 3, std::vector<uint8_t>(bottomUp.size())};
    for (size_t y = 0; y < size_t(s.canvas.height); ++y)
        std::copy_n(&bottomUp[(size_t(s.canvas.height) - 1 - y) * row], row, &image.pixels[y * row]);
    return image;
}

std::optional<Vec3d> SceneView::pointUnder(const ViewState& view, double x, double y, int width, int height) {
    const Camera camera = view.camera.camera();
    const CameraFrame frame = makeCameraFrame(camera, width, height, state_->choices.bounds);
    const Vec3f direction =
        (frame.rayCorner + x * frame.rayPerPixelX + y * frame.rayPerPixelY).normalized().cast<float>();
    const RayHit hit = state_->rays().firstHit(camera.eye, direction);
    if (hit.triangle == kNoTriangle) return std::nullopt;
    return camera.eye.cast<double>() + double(hit.distance) * direction.cast<double>();
}

}  // namespace prt::tools
