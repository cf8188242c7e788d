// Sources: [IwanickiSloan2012, Sec. 3 to 5] for what is drawn; wires the runtime, its light and the
// reference.
#include "tools/view/scene_view.h"

#include <fmt/format.h>

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
#include "tools/comparison.h"
#include "tools/exposure.h"
#include "tools/picture.h"
#include "tools/relight_suns.h"
#include "tools/relight_techniques.h"
#include "tools/view/reference.h"

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
    State(GlContext& glContext, const RelightArguments& given, std::function<void()> wakeUp)
        : context(glContext),
          gl(glContext.gl()),
          arguments(given),
          data(loadRelightData(given)),
          available(data.techniques),
          techniques(given, data),
          suns(data.bundle, data.scene, data.environments),
          renderer(glContext, data.scene, nullptr, nullptr),
          wake(std::move(wakeUp)) {
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
    bool setLight(const ViewState& view, bool moving);
    void setPoints(const ViewState& view);
    void chooseExposure(const ViewState& view);
    ReferencePicture pictureOf(const ViewState& view, int width, int height) const;
    const TracedReference* referenceOf(const ViewState& view, int width, int height) const;
    void drawLit(const ViewState& view, const Camera& camera, const DrawTarget& target);
    void drawCompared(const ViewState& view, const TracedReference& reference, const DrawTarget& target);
    void compare(const ViewState& view, const TracedReference& reference);
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
    std::function<void()> wake;
    std::optional<RayCaster> caster;
    std::optional<ReferenceTracer> tracer;
    std::optional<Light> compared;                  // whose error stands in the statistics …
    const TracedReference* comparedWith = nullptr;  // … against this
    ViewStatistics statistics;
};

SceneView::SceneView(GlContext& context, const RelightArguments& arguments, std::function<void()> wake)
    : state_(std::make_unique<State>(context, arguments, std::move(wake))) {}

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
    view.toneCurve = arguments.toneCurve;
    view.samples = arguments.samples;
    view.normalMap = !arguments.noNormalMap;
    view.background = !arguments.noBackground;
    return view;
}

void SceneView::State::resize(int width, int height) {
    if (canvas.width == width && canvas.height == height) return;
    PRT_CHECK(width >= 1 && height >= 1);
    const GLint edge = glInteger(gl, GL_MAX_TEXTURE_SIZE);
    if (width > edge || height > edge)
        throw InputError(
            "window",
            fmt::format("{}x{} pixels are more than the {} that OpenGL takes here", width, height, edge),
            "make it smaller");
    canvas = {};
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

// Whether the technique has a light like this; else says why not.
bool SceneView::State::setLight(const ViewState& view, bool moving) {
    const Technique technique = available[view.technique];
    const std::vector<double> weights = view.effectiveWeights();
    const Light light{technique, weights, view.rotationRad};
    const bool changed = lit != light;
    statistics.problem.clear();
    Stopwatch watch;
    try {
        // Only what is looked at is reduced and uploaded.
        if (added.insert(techniques.drawn(technique)).second) {
            data.techniques = {technique};
            techniques.addTo(renderer);
            watch = {};
        }
        techniques.setLight(renderer, technique, weights, view.rotationRad);
        // Shadows of a turned sun are traced: not in the middle of a drag.
        if (arguments.tables.extractSun && !moving) suns.setTo(renderer, weights, view.rotationRad);
    } catch (const InputError& error) {
        statistics.problem = error.what();
        lit.reset();
        return false;
    }
    if (!changed) return true;
    gl.Finish();
    statistics.switchMs = watch.seconds() * 1e3;
    ++statistics.switches;
    lit = light;
    statistics.cost = techniqueCost(technique, data.source(), data.domain(), arguments.tables.cosineBands());
    return true;
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

ReferencePicture SceneView::State::pictureOf(const ViewState& view, int width, int height) const {
    ReferencePicture picture{view.camera, width, height, view.normalMap, view.rotationRad, {}};
    const std::vector<double> weights = view.effectiveWeights();
    for (size_t e = 0; e < weights.size(); ++e)
        if (weights[e] > 0) picture.environments.push_back(e);
    return picture;
}

const TracedReference* SceneView::State::referenceOf(const ViewState& view, int width, int height) const {
    const TracedReference* result = tracer ? tracer->result() : nullptr;
    if (!result || !result->picture.covers(view.effectiveWeights())) return nullptr;
    ReferencePicture picture = pictureOf(view, width, height);
    picture.environments = result->picture.environments;  // more of them do no harm
    return picture == result->picture ? result : nullptr;
}

void SceneView::State::drawLit(const ViewState& view, const Camera& camera, const DrawTarget& target) {
    renderer.draw(camera, techniques.drawn(available[view.technique]), options(view),
                  {statistics.exposureStops, view.toneCurve}, target);
}

// The reference itself, or what the technique is away from it.
void SceneView::State::drawCompared(const ViewState& view, const TracedReference& reference,
                                    const DrawTarget& target) {
    const Camera camera = view.camera.camera();
    FloatImage image = radianceOf(reference.blend(view.effectiveWeights()), reference.surface);
    DisplayOptions display{statistics.exposureStops, view.toneCurve};
    if (view.shown == Shown::Reference) {
        if (view.background)
            paintBackground(image, reference.surface, camera, choices.bounds, background, view.rotationRad);
    } else {
        RenderOptions plain = options(view);
        plain.samples = 1;
        const Technique technique = techniques.drawn(available[view.technique]);
        image =
            scaledDifference(renderer.render(camera, technique, plain).radiance, image, reference.surface);
        display.toneCurve = ToneCurve::None;
    }
    renderer.drawImage(image, display, target);
}

// Once for every light and reference.
void SceneView::State::compare(const ViewState& view, const TracedReference& reference) {
    if (compared == lit && comparedWith == &reference) return;
    const Technique technique = techniques.drawn(available[view.technique]);
    const RenderOptions plain{canvas.width, canvas.height, view.normalMap, 1};
    const RenderedFrame frame = renderer.render(view.camera.camera(), technique, plain);
    const IrradianceError error = compareIrradiance(
        frame.irradiance.pixels, reference.blend(view.effectiveWeights()), reference.surface);
    statistics.relativeRmse = error.relativeRmse;
    statistics.psnrDb = error.psnrDb;
    compared = lit;
    comparedWith = &reference;
}

void SceneView::draw(const ViewState& view, int width, int height, bool moving) {
    State& s = *state_;
    PRT_CHECK(view.technique < s.available.size());
    s.context.makeCurrent();
    s.resize(width, height);
    if (s.tracer && s.tracer->underWay() && *s.tracer->underWay() != s.pictureOf(view, width, height))
        s.tracer->stop();
    const Camera camera = view.camera.camera();
    const DrawTarget target{s.canvas.framebuffer.name(), 0, 0};
    const bool points = showsPoints(view.shown);
    if (points) {
        s.setPoints(view);
    } else {
        s.pointsOf.first = Shown::Lit;
        s.setBackground(view);
        if (!s.setLight(view, moving)) {
            s.renderer.drawImage({width, height, 3, std::vector<float>(size_t(width) * size_t(height) * 3)},
                                 {}, target);
            ++s.statistics.frames;
            return;
        }
        s.chooseExposure(view);
    }
    const TracedReference* reference = points ? nullptr : s.referenceOf(view, width, height);
    if (reference) {
        s.compare(view, *reference);
    } else {
        s.statistics.relativeRmse = s.statistics.psnrDb = std::nullopt;
        s.compared.reset();
    }
    const Stopwatch watch;
    if (points)
        s.renderer.drawPoints(camera, s.options(view), {}, target);
    else if (reference && needsReference(view.shown))
        s.drawCompared(view, *reference, target);
    else
        s.drawLit(view, camera, target);
    s.gl.Finish();
    s.statistics.frameMs = watch.seconds() * 1e3;
    ++s.statistics.frames;
}

void SceneView::traceReference(const ViewState& view, int width, int height) {
    State& s = *state_;
    const ReferencePicture picture = s.pictureOf(view, width, height);
    if (hasReference(view, width, height) || picture.environments.empty()) return stopReference();
    if (!s.tracer) s.tracer.emplace(s.rays(), s.data.environments, s.arguments.referenceRays, s.wake);
    s.tracer->start(picture, [&] {
        s.context.makeCurrent();
        return s.renderer.surface(view.camera.camera(), {width, height, view.normalMap, 1});
    });
}

void SceneView::stopReference() {
    if (state_->tracer) state_->tracer->stop();
}

bool SceneView::pollReference() {
    if (!state_->tracer || !state_->tracer->poll()) return false;
    state_->compared.reset();
    return true;
}

bool SceneView::hasReference(const ViewState& view, int width, int height) const {
    return state_->referenceOf(view, width, height) != nullptr;
}

std::optional<double> SceneView::referenceProgress() const {
    if (!state_->tracer || !state_->tracer->underWay()) return std::nullopt;
    return state_->tracer->progress();
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
