// Sources: none; the viewer's own rules, as tools/docs/view.md lists them.
#include "tools/view/input.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

constexpr double kClickReach = 4;  // between the clicks of a double click, window units

bool isFlight(ViewAction action) { return action >= ViewAction::FlyForward; }

// 0 … count − 1, around the ends.
size_t stepped(size_t index, int by, size_t count) {
    return size_t((int(index) + by % int(count) + int(count)) % int(count));
}

}  // namespace

ViewInput::ViewInput(ViewChoices choices, ViewState start)
    : choices_(std::move(choices)), start_(std::move(start)) {
    PRT_CHECK(!choices_.techniques.empty());
    PRT_CHECK_EQ(choices_.environments.size(), start_.weights.size());
}

void ViewInput::setWindowHeight(double height) { windowHeight_ = std::max(height, 1.0); }

void ViewInput::handle(const ViewEvent& event, ViewState& state, ViewRequests& requests) {
    switch (event.kind) {
        case ViewEventKind::Cursor:
            drag(event.x - std::exchange(x_, event.x), event.y - std::exchange(y_, event.y), state);
            break;
        case ViewEventKind::Button:
            shift_ = event.shift;
            buttons_[size_t(event.button)] = event.pressed;
            if (event.pressed) press(event, requests);
            break;
        case ViewEventKind::Scroll:
            zoom(event.y, state);
            break;
        case ViewEventKind::Key:
            key(event, state, requests);
            break;
        case ViewEventKind::Leave:
            release();
            break;
        case ViewEventKind::Close:
            requests.quit = true;
            break;
        case ViewEventKind::Text:
        case ViewEventKind::Refresh:
            break;
    }
}

void ViewInput::press(const ViewEvent& event, ViewRequests& requests) {
    if (event.button != MouseButton::Left || event.shift || isDown(Key::L)) return;
    if (click_ && event.seconds - click_->seconds <= kDoubleClickSeconds &&
        std::hypot(x_ - click_->x, y_ - click_->y) <= kClickReach) {
        requests.lookAt = ViewRequests::Point{x_, y_};
        click_.reset();
    } else {
        click_ = Click{x_, y_, event.seconds};
    }
}

void ViewInput::drag(double dx, double dy, ViewState& state) const {
    const double turn = std::numbers::pi / windowHeight_;
    const bool left = buttons_[size_t(MouseButton::Left)];
    if (buttons_[size_t(MouseButton::Right)] || (left && isDown(Key::L))) {
        state.rotationRad = std::remainder(state.rotationRad + dx * turn, 2 * std::numbers::pi);
    } else if (buttons_[size_t(MouseButton::Middle)] || (left && shift_)) {
        OrbitCamera& camera = state.camera;
        const double perUnit =
            2 * camera.distance * std::tan(camera.verticalFovDeg * std::numbers::pi / 360) / windowHeight_;
        camera.target += perUnit * (dy * camera.up() - dx * camera.right());
    } else if (left) {
        OrbitCamera& camera = state.camera;
        camera.azimuthRad = std::remainder(camera.azimuthRad - dx * turn, 2 * std::numbers::pi);
        camera.elevationRad = std::clamp(camera.elevationRad + dy * turn, -kSteepestRad, kSteepestRad);
    }
}

void ViewInput::zoom(double steps, ViewState& state) const {
    OrbitCamera& camera = state.camera;
    const double radius = sceneRadius(choices_.bounds), nearest = 0.02 * radius;
    const double wanted = camera.distance * std::pow(kZoomPerStep, std::clamp(steps, -100.0, 100.0));
    camera.distance = std::clamp(wanted, std::min(nearest, camera.distance), 100 * radius);
    // Where it can come no nearer to its target, both go on.
    if (wanted < camera.distance && steps > 0) camera.target -= 0.5 * nearest * steps * camera.toEye();
}

void ViewInput::key(const ViewEvent& event, ViewState& state, ViewRequests& requests) {
    if (event.key == Key::Unknown) return;
    PRT_CHECK(int(event.key) >= 0 && int(event.key) < kKeyCount);
    keys_[size_t(event.key)] = event.pressed;
    const KeyBinding* binding = event.pressed ? findBinding(event.key, event.shift) : nullptr;
    if (!binding || event.control || (event.repeated && !binding->repeats)) return;
    act(binding->action, state, requests);
}

double ViewInput::flyLength(const ViewState& state) const {
    return std::min(state.camera.distance, sceneRadius(choices_.bounds));
}

void ViewInput::fly(ViewAction action, double length, ViewState& state) const {
    OrbitCamera& camera = state.camera;
    switch (action) {
        case ViewAction::FlyForward:
            return flyBy(camera, 0, 0, length);
        case ViewAction::FlyBack:
            return flyBy(camera, 0, 0, -length);
        case ViewAction::FlyLeft:
            return flyBy(camera, -length, 0, 0);
        case ViewAction::FlyRight:
            return flyBy(camera, length, 0, 0);
        case ViewAction::FlyUp:
            return flyBy(camera, 0, length, 0);
        default:
            return flyBy(camera, 0, -length, 0);
    }
}

void ViewInput::advance(double seconds, ViewState& state) const {
    for (const KeyBinding& binding : keyBindings())
        if (isFlight(binding.action) && isDown(binding.key))
            fly(binding.action, seconds / kFlySeconds * flyLength(state), state);
}

bool ViewInput::isFlying() const {
    return std::ranges::any_of(keyBindings(),
                               [&](const KeyBinding& b) { return isFlight(b.action) && isDown(b.key); });
}

bool ViewInput::isDragging() const {
    return std::ranges::any_of(buttons_, [](bool down) { return down; });
}

void ViewInput::release() {
    buttons_ = {};
    keys_ = {};
    shift_ = false;
    click_.reset();
}

void ViewInput::act(ViewAction action, ViewState& state, ViewRequests& requests) const {
    const size_t environments = choices_.environments.size();
    const auto expose = [&](double stops) {
        state.autoExposure = false;
        state.exposureStops =
            std::clamp(state.exposureStops + stops, -kMostExposureStops, kMostExposureStops);
    };
    const auto turn = [&](double angle) {
        state.rotationRad = std::remainder(state.rotationRad + angle, 2 * std::numbers::pi);
    };
    const auto show = [&](Shown shown) {
        if (choices_.whyNot(shown).empty()) state.shown = shown;
    };
    switch (action) {
        using enum ViewAction;
        case Quit:
            requests.quit = true;
            break;
        case Help:
            state.help = !state.help;
            break;
        case Panel:
            state.panel = !state.panel;
            break;
        case Fit:
            fitScene(state.camera, choices_.bounds);
            break;
        case Reset: {
            const bool panel = state.panel;
            state = start_;
            state.panel = panel;
            break;
        }
        case NextTechnique:
            state.technique = stepped(state.technique, 1, choices_.techniques.size());
            break;
        case PreviousTechnique:
            state.technique = stepped(state.technique, -1, choices_.techniques.size());
            break;
        case NextEnvironment:
            state.solo = state.solo ? stepped(*state.solo, 1, environments) : 0;
            break;
        case PreviousEnvironment:
            state.solo = state.solo ? stepped(*state.solo, -1, environments) : environments - 1;
            break;
        case BlendEnvironments:
            state.solo.reset();
            break;
        case TurnLightLeft:
            turn(-kTurnStepRad);
            break;
        case TurnLightRight:
            turn(kTurnStepRad);
            break;
        case Brighter:
            expose(kExposureStep);
            break;
        case Darker:
            expose(-kExposureStep);
            break;
        case AutoExposure:
            state.autoExposure = !state.autoExposure;
            break;
        case ViewAction::ToneCurve:
            state.toneCurve = prt::ToneCurve((int(state.toneCurve) + 1) % 3);
            break;
        case Samples:
            state.samples = state.samples == 1 ? 4 : 1;
            break;
        case NormalMap:
            state.normalMap = !state.normalMap;
            break;
        case Background:
            state.background = !state.background;
            break;
        case ShowLit:
            show(Shown::Lit);
            break;
        case ShowWeight:
            show(Shown::Weight);
            break;
        case ShowCoefficient:
            show(Shown::Coefficient);
            break;
        case ShowAo:
            show(Shown::Ao);
            break;
        case ShowValidity:
            show(Shown::Validity);
            break;
        case ShowCharts:
            show(Shown::Charts);
            break;
        case ShowReference:
            show(Shown::Reference);
            break;
        case ShowDifference:
            show(Shown::Difference);
            break;
        case NextIndex:
            state.setIndex(state.index() + 1, choices_);
            break;
        case PreviousIndex:
            state.setIndex(state.index() - 1, choices_);
            break;
        case Screenshot:
            ++requests.screenshots;
            break;
        case FlyForward:
        case FlyBack:
        case FlyLeft:
        case FlyRight:
        case FlyUp:
        case FlyDown:
            // A tap moves a little; what holding the key moves comes from advance().
            fly(action, flyLength(state) / 20, state);
            break;
    }
}

}  // namespace prt::tools
