// Sources: none; joins window, panel, scene and script.
#include "tools/view/app.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <optional>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "tools/picture.h"
#include "tools/view/input.h"
#include "tools/view/panel.h"
#include "tools/view/scene_view.h"
#include "tools/view/screenshots.h"
#include "tools/view/window.h"

namespace prt::tools {
namespace {

constexpr double kDegreesPerRad = 180 / std::numbers::pi;
// Ctrl-C is noticed that often while nothing else happens.
constexpr double kWaitSeconds = 0.2;
// Time that passes for the panel between two steps of a script.
constexpr double kScriptSeconds = 1.0 / 60;

std::string bundleName(const std::string& path) {
    std::filesystem::path folder = std::filesystem::path(path).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    return folder.filename().string();
}

// JSON without its line breaks and the blanks behind them.
std::string oneLine(const std::string& json) {
    std::string line;
    for (size_t i = 0; i < json.size(); ++i)
        if (json[i] == '\n')
            while (i + 1 < json.size() && json[i + 1] == ' ') ++i;
        else
            line += json[i];
    return line + "\n";
}

class Viewer {
  public:
    explicit Viewer(const ViewOptions& options)
        : options_(options),
          window_(options.relight.width, options.relight.height, "prt view"),
          scene_(window_.context(), options.relight, ViewWindow::wake),
          state_(firstState()),
          input_(scene_.choices(), state_),
          panel_(window_.size()) {
        facts_.bundle = bundleName(options.relight.bundlePath);
        facts_.renderer = window_.context().rendererName();
    }

    Report run() {
        while (!requests_.quit) {
            throwIfInterrupted();
            if (step_ < options_.script.size())
                play(options_.script[step_++]);
            else
                listen();
            answer();
            followReference();
            present();
        }
        return report();
    }

  private:
    ViewState firstState() const;
    void listen();
    void dispatch(const std::vector<ViewEvent>& events);
    std::vector<ViewEvent> ownEvents();
    void play(const ScriptStep& step);
    void playChoice(const ScriptStep& step);
    void answer();
    void present();
    void drawScene(bool still = false);
    int coarseness(double lastMs) const;
    void updatePanel();
    void followReference();
    void waitForReference(const ScriptStep& step);
    void screenshot(const std::filesystem::path& path);
    Report report() const;
    [[noreturn]] void fail(const ScriptStep& step, const std::string& problem,
                           const std::string& remedy) const {
        throw InputError(fmt::format("{}:{}", options_.scriptName, step.line), problem, remedy);
    }

    const ViewOptions& options_;
    ViewWindow window_;
    SceneView scene_;
    ViewState state_;
    ViewInput input_;
    ViewPanel panel_;
    PanelFacts facts_;
    ViewRequests requests_;
    size_t step_ = 0;
    double playedSeconds_ = 0, lastUpdate_ = 0, lastListen_ = 0, lastFrame_ = 0;
    std::optional<ViewState> drawn_;  // what stands in the scene's image
    WindowSize drawnSize_;
    bool drawnMoving_ = false;
    int part_ = 1;       // of the window's sides that was drawn
    bool dirty_ = true;  // something happened since the window was shown last
    int windows_ = 0, screenshots_ = 0;
};

ViewState Viewer::firstState() const {
    ViewState state = scene_.startState();
    const std::vector<Technique>& techniques = scene_.choices().techniques;
    const auto find = [&](Technique technique) {
        return size_t(std::ranges::find(techniques, technique) - techniques.begin());
    };
    if (options_.technique.empty()) {
        state.technique = find(Technique::Pca);
        if (state.technique == techniques.size()) state.technique = 0;
    } else {
        state.technique = find(techniqueFromName(options_.technique).value());
    }
    if (options_.firstAlone) state.solo = 0;
    return state;
}

void Viewer::listen() {
    const bool busy = dirty_ || input_.isFlying() || options_.measureFrames;
    const std::vector<ViewEvent> events = window_.events(busy && !window_.isMinimised() ? 0 : kWaitSeconds);
    const double now = window_.seconds();
    if (input_.isFlying()) {
        input_.advance(std::min(now - lastListen_, 0.5), state_);
        dirty_ = true;
    }
    lastListen_ = now;
    dispatch(events);
    // Rays are for a picture that stands still.
    const WindowSize size = window_.size();
    if (events.empty() && !dirty_ && needsReference(state_.shown) && !window_.isMinimised())
        scene_.traceReference(state_, size.pixelWidth, size.pixelHeight);
}

void Viewer::followReference() {
    if (scene_.pollReference()) {
        drawn_.reset();
        dirty_ = true;
    }
    const std::optional<double> progress = scene_.referenceProgress();
    if (progress != facts_.reference) dirty_ = true;
    facts_.reference = progress;
}

void Viewer::waitForReference(const ScriptStep& step) {
    drawScene();
    const auto isThere = [&] { return scene_.hasReference(state_, scene_.width(), scene_.height()); };
    scene_.traceReference(state_, scene_.width(), scene_.height());
    while (!isThere()) {
        followReference();
        if (isThere()) break;
        if (!scene_.referenceProgress()) fail(step, "no environment shines", "give one a weight");
        throwIfInterrupted();
        dispatch(ownEvents());
        if (requests_.quit) return;
        present();
        window_.events(kWaitSeconds);
    }
    drawn_.reset();
    dirty_ = true;
}

// What the window itself tells (its new size, that it is to be closed): that counts while a script plays, a
// hand on the mouse does not.
std::vector<ViewEvent> Viewer::ownEvents() {
    std::vector<ViewEvent> events = window_.events(0);
    std::erase_if(events, [](const ViewEvent& event) {
        return event.kind != ViewEventKind::Close && event.kind != ViewEventKind::Refresh;
    });
    return events;
}

// The panel sees every event first, and is laid out between them, so that it knows what is under the cursor.
void Viewer::dispatch(const std::vector<ViewEvent>& events) {
    const WindowSize size = window_.size();
    if (size.width < 1 || size.height < 1) return;
    input_.setWindowHeight(size.height);
    for (size_t i = 0; i < events.size(); ++i) {
        dirty_ = true;
        const bool taken = panel_.handle(events[i]);
        if (!taken) input_.handle(events[i], state_, requests_);
        const bool more = i + 1 < events.size() && events[i].kind == ViewEventKind::Cursor &&
                          events[i + 1].kind == ViewEventKind::Cursor;
        if (!more) updatePanel();
    }
}

void Viewer::updatePanel() {
    const WindowSize size = window_.size();
    if (size.width < 1 || size.height < 1) return;
    const double now = options_.script.empty() ? window_.seconds() : lastUpdate_ + kScriptSeconds;
    panel_.update(now - lastUpdate_, size, scene_, input_, facts_, state_, requests_);
    lastUpdate_ = now;
}

void Viewer::play(const ScriptStep& step) {
    dispatch(ownEvents());
    dirty_ = true;
    std::vector<ViewEvent> events = step.events;
    playedSeconds_ += 1;  // so that clicks of two steps are no double click
    for (ViewEvent& event : events) event.seconds = playedSeconds_;
    switch (step.action) {
        case ScriptAction::Events:
            dispatch(events);
            break;
        case ScriptAction::Hold:
            dispatch({events.front()});
            input_.advance(step.number, state_);
            dispatch({events.back()});
            break;
        case ScriptAction::Resize:
            window_.resize(step.index, step.index2);
            break;
        case ScriptAction::WaitReference:
            waitForReference(step);
            break;
        case ScriptAction::Screenshot:
            screenshot(step.text);
            break;
        case ScriptAction::WindowShot:
            present();
            writePng(step.text, window_.read());
            break;
        case ScriptAction::Report:
            std::fputs(oneLine(report().text()).c_str(), stdout);
            break;
        case ScriptAction::Quit:
            requests_.quit = true;
            break;
        default:
            playChoice(step);
            break;
    }
}

void Viewer::playChoice(const ScriptStep& step) {
    const ViewChoices& choices = scene_.choices();
    switch (step.action) {
        case ScriptAction::Technique: {
            const auto technique = techniqueFromName(step.text);
            const auto found =
                technique ? std::ranges::find(choices.techniques, *technique) : choices.techniques.end();
            if (found == choices.techniques.end())
                fail(step, fmt::format("there is no technique '{}' here", step.text), "prt info lists files");
            state_.technique = size_t(found - choices.techniques.begin());
            break;
        }
        case ScriptAction::Show: {
            const auto shown = shownFromName(step.text);
            if (!shown) fail(step, fmt::format("'{}' cannot be shown", step.text), "see prt view --help");
            if (const std::string why = choices.whyNot(*shown); !why.empty()) fail(step, why, "");
            state_.shown = *shown;
            if (step.index >= choices.indexCount(*shown))
                fail(step, fmt::format("there is no number {}", step.index),
                     fmt::format("0..{}", choices.indexCount(*shown) - 1));
            state_.setIndex(step.index, choices);
            break;
        }
        case ScriptAction::Rotate:
            state_.rotationRad = step.number / kDegreesPerRad;
            break;
        case ScriptAction::Exposure:
            state_.autoExposure = step.text == "auto";
            if (!state_.autoExposure) state_.exposureStops = step.number;
            break;
        case ScriptAction::Weight: {
            const auto found = std::ranges::find(choices.environments, step.text);
            if (found == choices.environments.end())
                fail(step, fmt::format("there is no environment '{}'", step.text),
                     fmt::format("there are {}", fmt::join(choices.environments, ", ")));
            state_.weights[size_t(found - choices.environments.begin())] = step.number;
            state_.solo.reset();
            break;
        }
        default:
            break;
    }
}

// What was asked for besides changes of the state.
void Viewer::answer() {
    if (requests_.lookAt) {
        const WindowSize size = window_.size();
        if (const auto point =
                scene_.pointUnder(state_, requests_.lookAt->x, requests_.lookAt->y, size.width, size.height))
            state_.camera.lookAt(*point);
        requests_.lookAt.reset();
        dirty_ = true;
    }
    for (; requests_.screenshots > 0; --requests_.screenshots) {
        try {
            const std::filesystem::path path = nextScreenshot(options_.screenshots);
            screenshot(path);
            facts_.message = "wrote " + path.string();
            logNote(facts_.message);
        } catch (const OutputError& error) {
            facts_.message = error.what();  // a full disk is no reason to lose the view
            logWarning(error.what());
        }
        dirty_ = true;
    }
}

void Viewer::screenshot(const std::filesystem::path& path) {
    drawScene(true);
    writePng(path, scene_.image());
    ++screenshots_;
}

// still: a picture to keep, even in the middle of a drag.
void Viewer::drawScene(bool still) {
    const WindowSize size = window_.size();
    const bool moving = !still && (input_.isDragging() || input_.isFlying());
    ViewState wanted = state_;
    wanted.panel = wanted.help = false;
    if (drawn_ == wanted && drawnSize_ == size && drawnMoving_ == moving && !options_.measureFrames) return;
    const int part = moving ? coarseness(scene_.statistics().frameMs) : 1;
    scene_.draw(state_, std::max(size.pixelWidth / part, 1), std::max(size.pixelHeight / part, 1), moving);
    part_ = part;
    drawn_ = wanted;
    drawnSize_ = size;
    drawnMoving_ = moving;
}

// Where frames are slow, what moves is drawn at a half or a quarter of the size: the hand matters more then.
int Viewer::coarseness(double lastMs) const {
    constexpr double kSlowMs = 80, kFastMs = 15;
    if (options_.measureFrames) return 1;
    if (lastMs > kSlowMs) return std::min(2 * part_, 4);
    if (lastMs < kFastMs) return std::max(part_ / 2, 1);
    return part_;
}

void Viewer::present() {
    if (window_.isMinimised()) return;
    if (!dirty_ && !options_.measureFrames) return;
    drawScene();
    if (options_.measureFrames) {
        const double now = window_.seconds();
        if (now > lastFrame_) facts_.framesPerSecond = 1 / (now - lastFrame_);
        lastFrame_ = now;
    }
    window_.setTitle(fmt::format("prt view - {} - {}", facts_.bundle,
                                 techniqueName(scene_.choices().techniques[state_.technique])));
    const ViewState before = state_;
    for (int i = 0; i < 2; ++i) updatePanel();  // a window's size is known after it was laid out once
    window_.blit(scene_.framebuffer(), scene_.width(), scene_.height());
    panel_.draw();
    ++windows_;
    window_.swap();
    dirty_ = !(state_ == before) || requests_.screenshots > 0;
}

Report Viewer::report() const {
    const ViewChoices& choices = scene_.choices();
    const ViewStatistics& statistics = scene_.statistics();
    const Camera camera = state_.camera.camera();
    const auto vector = [](const Vec3f& v) {
        return fmt::format("[{:.9g},{:.9g},{:.9g}]", v.x(), v.y(), v.z());
    };
    Report report;
    report.set("bundle", options_.relight.bundlePath)
        .set("renderer", facts_.renderer)
        .set("technique", techniqueName(choices.techniques[state_.technique]))
        .set("show", shownName(state_.shown))
        .setJson("eye", vector(camera.eye))
        .setJson("target", vector(camera.target))
        .set("normal_map", state_.normalMap)
        .set("background", state_.background)
        .set("samples", state_.samples)
        .set("tone", std::string(toneCurveName(state_.toneCurve)))
        .set("rotate_deg", state_.rotationRad * kDegreesPerRad)
        .set("exposure_stops", statistics.exposureStops)
        .set("width", scene_.width())
        .set("height", scene_.height())
        .setJson("weights", fmt::format("[{:.9g}]", fmt::join(state_.effectiveWeights(), ",")))
        .set("scene_frames", statistics.frames)
        .set("window_frames", windows_)
        .set("light_switches", statistics.switches)
        .set("light_switch_ms", statistics.switchMs)
        .set("frame_ms", statistics.frameMs)
        .set("screenshots", screenshots_);
    if (!statistics.problem.empty()) report.set("problem", statistics.problem);
    if (statistics.relativeRmse) report.set("relative_rmse", *statistics.relativeRmse);
    return report;
}

}  // namespace

Report runViewer(const ViewOptions& options) {
    Bundle::open(options.relight.bundlePath);  // before a window appears
    return Viewer(options).run();
}

}  // namespace prt::tools
