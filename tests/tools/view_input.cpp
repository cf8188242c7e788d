// The viewer's model: what mouse and keys do to camera, light and choices, without a window.
#include <cmath>
#include <numbers>

#include "precompute/io/scene.h"
#include "tools/view/input.h"

namespace prt::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHeight = 400;  // of the window

ViewChoices choices() {
    ViewChoices choices;
    choices.techniques = {Technique::Unc, Technique::Pca, Technique::Sh2};
    choices.environments = {"a", "b", "c"};
    choices.components = 4;
    choices.coefficients = 9;
    choices.charts = true;
    choices.bounds = {Vec3f(-1, 0, -2), Vec3f(3, 2, 2)};
    return choices;
}

class ViewInputTest : public testing::Test {
  protected:
    ViewInputTest() : choices_(choices()) {
        state_.camera.target = Vec3d(1, 1, 0);
        state_.camera.distance = 5;
        state_.camera.azimuthRad = 0.4;
        state_.camera.elevationRad = 0.3;
        state_.weights = {1, 0.5, 0};
        start_ = state_;
        input_.emplace(choices_, start_);
        input_->setWindowHeight(kHeight);
    }
    void handle(const ViewEvent& event) { input_->handle(event, state_, requests_); }
    void moveTo(double x, double y) { handle({.kind = ViewEventKind::Cursor, .x = x, .y = y}); }
    void button(MouseButton which, bool pressed, bool shift = false, double seconds = 0) {
        handle({.kind = ViewEventKind::Button,
                .button = which,
                .pressed = pressed,
                .shift = shift,
                .seconds = seconds});
    }
    void drag(MouseButton which, double dx, double dy, bool shift = false) {
        moveTo(200, 200);
        button(which, true, shift);
        moveTo(200 + dx / 3, 200 + dy / 3);
        moveTo(200 + dx, 200 + dy);
        button(which, false, shift);
        moveTo(0, 0);
    }
    void key(Key which, bool pressed, bool shift = false, bool repeated = false) {
        handle({.kind = ViewEventKind::Key,
                .key = which,
                .pressed = pressed,
                .repeated = repeated,
                .shift = shift});
    }
    void tap(Key which, bool shift = false) {
        key(which, true, shift);
        key(which, false, shift);
    }
    void click(double x, double y, double seconds) {
        moveTo(x, y);
        button(MouseButton::Left, true, false, seconds);
        button(MouseButton::Left, false, false, seconds);
    }

    ViewChoices choices_;
    ViewState state_, start_;
    ViewRequests requests_;
    std::optional<ViewInput> input_;
};

// Where a point of the world falls in the picture, in units of the window from its middle.
Vec2f projected(const OrbitCamera& camera, const Vec3d& point) {
    const Vec3d offset = point - camera.eye();
    const double depth = -offset.dot(camera.toEye());
    const double scale = kHeight / 2 / std::tan(camera.verticalFovDeg * kPi / 360) / depth;
    return {float(scale * offset.dot(camera.right())), float(-scale * offset.dot(camera.up()))};
}

TEST_F(ViewInputTest, LeftDragOrbits) {
    drag(MouseButton::Left, 100, 40);
    EXPECT_NEAR(state_.camera.azimuthRad, 0.4 - 100 * kPi / kHeight, 1e-12);
    EXPECT_NEAR(state_.camera.elevationRad, 0.3 + 40 * kPi / kHeight, 1e-12);
    EXPECT_EQ(state_.camera.target, start_.camera.target);
    EXPECT_EQ(state_.camera.distance, start_.camera.distance);
    drag(MouseButton::Left, 0, 10 * kHeight);
    EXPECT_NEAR(state_.camera.elevationRad, kSteepestRad, 1e-12);
    drag(MouseButton::Left, 0, -20 * kHeight);
    EXPECT_NEAR(state_.camera.elevationRad, -kSteepestRad, 1e-12);
}

TEST_F(ViewInputTest, PanKeepsTheTargetUnderTheCursor) {
    for (const bool shift : {false, true}) {
        state_ = start_;
        const Vec3d grabbed = state_.camera.target;
        drag(shift ? MouseButton::Left : MouseButton::Middle, 60, -35, shift);
        const Vec2f at = projected(state_.camera, grabbed);
        EXPECT_NEAR(at.x(), 60, 1e-3);
        EXPECT_NEAR(at.y(), -35, 1e-3);
        EXPECT_EQ(state_.camera.azimuthRad, start_.camera.azimuthRad);
        EXPECT_EQ(state_.rotationRad, 0);
    }
}

TEST_F(ViewInputTest, LightTurnsWithRightDragAndWithL) {
    drag(MouseButton::Right, 50, 20);
    EXPECT_NEAR(state_.rotationRad, 50 * kPi / kHeight, 1e-12);
    key(Key::L, true);
    drag(MouseButton::Left, -80, 0);
    key(Key::L, false);
    EXPECT_NEAR(state_.rotationRad, -30 * kPi / kHeight, 1e-12);
    EXPECT_EQ(state_.camera, start_.camera);
    drag(MouseButton::Right, 2 * kHeight, 0);  // a whole turn
    EXPECT_NEAR(state_.rotationRad, -30 * kPi / kHeight, 1e-9);
}

TEST_F(ViewInputTest, WheelZoomsAndFliesOn) {
    handle({.kind = ViewEventKind::Scroll, .y = 2});
    EXPECT_NEAR(state_.camera.distance, 5 * 0.81, 1e-12);
    handle({.kind = ViewEventKind::Scroll, .y = -2});
    EXPECT_NEAR(state_.camera.distance, 5, 1e-12);
    EXPECT_EQ(state_.camera.target, start_.camera.target);
    for (int i = 0; i < 60; ++i) handle({.kind = ViewEventKind::Scroll, .y = 1});
    const double radius = sceneRadius(choices_.bounds);
    EXPECT_NEAR(state_.camera.distance, 0.02 * radius, 1e-9);
    const Vec3d moved = state_.camera.target - start_.camera.target;
    EXPECT_GT(-moved.dot(state_.camera.toEye()), 0);
    EXPECT_NEAR(moved.cross(state_.camera.toEye()).norm(), 0, 1e-9);
    for (int i = 0; i < 300; ++i) handle({.kind = ViewEventKind::Scroll, .y = -1});
    EXPECT_NEAR(state_.camera.distance, 100 * radius, 1e-6);
}

TEST_F(ViewInputTest, FlightFollowsTheHorizonAndScalesWithTime) {
    key(Key::W, true);
    const Vec3d tapped = state_.camera.target;
    EXPECT_TRUE(input_->isFlying());
    input_->advance(0.5, state_);
    const Vec3d moved = state_.camera.target - tapped;
    const double speed = std::min(5.0, sceneRadius(choices_.bounds)) / ViewInput::kFlySeconds;
    EXPECT_NEAR(moved.norm(), 0.5 * speed, 1e-12);
    EXPECT_NEAR(moved.y(), 0, 1e-12);
    EXPECT_LT(moved.dot(state_.camera.toEye()), 0);
    key(Key::W, false);
    EXPECT_FALSE(input_->isFlying());
    const ViewState before = state_;
    input_->advance(1, state_);
    EXPECT_EQ(state_, before);
    for (const auto& [one, other] :
         {std::pair{Key::A, Key::D}, std::pair{Key::W, Key::S}, std::pair{Key::PageUp, Key::PageDown}}) {
        state_ = start_;
        tap(one);
        EXPECT_GT((state_.camera.target - start_.camera.target).norm(), 0.01);
        tap(other);
        EXPECT_NEAR((state_.camera.target - start_.camera.target).norm(), 0, 1e-12);
    }
}

TEST_F(ViewInputTest, LosingTheKeyboardStopsEverything) {
    key(Key::W, true);
    button(MouseButton::Left, true);
    EXPECT_TRUE(input_->isFlying() && input_->isDragging());
    handle({.kind = ViewEventKind::Leave});
    EXPECT_FALSE(input_->isFlying() || input_->isDragging());
    const ViewState before = state_;
    moveTo(300, 300);
    EXPECT_EQ(state_, before);
}

TEST_F(ViewInputTest, DoubleClickAsksForTheTarget) {
    click(120, 80, 1.0);
    EXPECT_FALSE(requests_.lookAt);
    click(122, 81, 1.3);
    ASSERT_TRUE(requests_.lookAt);
    EXPECT_EQ(requests_.lookAt->x, 122);
    requests_ = {};
    click(122, 81, 1.4);  // the third of a row begins anew
    EXPECT_FALSE(requests_.lookAt);
    click(122, 81, 2.4);  // too late
    click(160, 81, 2.5);  // too far
    EXPECT_FALSE(requests_.lookAt);
}

TEST_F(ViewInputTest, ChoicesRunAround) {
    for (const size_t expected : {1u, 2u, 0u}) {
        tap(Key::T);
        EXPECT_EQ(state_.technique, expected);
    }
    tap(Key::T, true);
    EXPECT_EQ(state_.technique, 2u);
    EXPECT_EQ(state_.effectiveWeights(), (std::vector<double>{1, 0.5, 0}));
    tap(Key::E);
    EXPECT_EQ(state_.effectiveWeights(), (std::vector<double>{1, 0, 0}));
    tap(Key::E, true);
    EXPECT_EQ(state_.effectiveWeights(), (std::vector<double>{0, 0, 1}));
    tap(Key::Digit0);
    EXPECT_EQ(state_.effectiveWeights(), (std::vector<double>{1, 0.5, 0}));
    for (const ToneCurve expected : {ToneCurve::Filmic, ToneCurve::Neutral, ToneCurve::None}) {
        tap(Key::C);
        EXPECT_EQ(state_.toneCurve, expected);
    }
}

TEST_F(ViewInputTest, NumbersOfWhatIsShownRunAround) {
    tap(Key::Digit2);
    EXPECT_EQ(state_.shown, Shown::Weight);
    tap(Key::Left);
    EXPECT_EQ(state_.weight, 3);
    tap(Key::Right);
    tap(Key::Right);
    EXPECT_EQ(state_.weight, 1);
    tap(Key::Digit3);
    EXPECT_EQ(state_.index(), 0);
    tap(Key::Left);
    EXPECT_EQ(state_.coefficient, 8);
    EXPECT_EQ(state_.weight, 1);
    tap(Key::Digit1);
    tap(Key::Right);
    EXPECT_EQ(state_.coefficient, 8);
}

TEST_F(ViewInputTest, WhatIsNotThereIsNotShown) {
    choices_.components = 0;
    choices_.charts = false;
    input_.emplace(choices_, start_);
    tap(Key::Digit2);
    tap(Key::Digit6);
    EXPECT_EQ(state_.shown, Shown::Lit);
    EXPECT_THAT(choices_.whyNot(Shown::Weight), testing::HasSubstr("prt compress"));
    EXPECT_EQ(choices_.whyNot(Shown::Ao), "");
}

TEST_F(ViewInputTest, SwitchesSwitch) {
    for (const auto& [which, flag] :
         {std::pair{Key::N, &ViewState::normalMap}, std::pair{Key::B, &ViewState::background},
          std::pair{Key::X, &ViewState::autoExposure}, std::pair{Key::H, &ViewState::help},
          std::pair{Key::F1, &ViewState::help}, std::pair{Key::Tab, &ViewState::panel}}) {
        const bool before = state_.*flag;
        tap(which);
        EXPECT_EQ(state_.*flag, !before);
        tap(which);
        EXPECT_EQ(state_.*flag, before);
    }
    tap(Key::M);
    EXPECT_EQ(state_.samples, 4);
    tap(Key::M);
    EXPECT_EQ(state_, start_);
}

TEST_F(ViewInputTest, ExposureAndTurnByKeysRepeat) {
    tap(Key::Equal);
    key(Key::Equal, true, false, true);
    EXPECT_NEAR(state_.exposureStops, 2.0 / 3, 1e-12);
    tap(Key::Minus);
    EXPECT_NEAR(state_.exposureStops, 1.0 / 3, 1e-12);
    for (int i = 0; i < 200; ++i) tap(Key::KeypadAdd);
    EXPECT_EQ(state_.exposureStops, ViewInput::kMostExposureStops);
    tap(Key::X);
    tap(Key::Minus);
    EXPECT_FALSE(state_.autoExposure) << "a hand on the exposure ends automatic exposure";
    tap(Key::RightBracket);
    key(Key::RightBracket, true, false, true);
    EXPECT_NEAR(state_.rotationRad, 10 * kPi / 180, 1e-12);
    key(Key::N, true, false, true);
    EXPECT_TRUE(state_.normalMap) << "a held key switches once";
}

TEST_F(ViewInputTest, FitResetQuitAndScreenshots) {
    drag(MouseButton::Left, 10, 10);
    tap(Key::F);
    EXPECT_EQ(state_.camera.target, Vec3d(1, 1, 0));
    const double radius = std::sqrt(4.0 + 1 + 4);
    EXPECT_NEAR(state_.camera.distance * std::sin(20 * kPi / 180), radius, 1e-6);
    EXPECT_NE(state_.camera.azimuthRad, start_.camera.azimuthRad);
    tap(Key::Tab);
    tap(Key::R);
    EXPECT_FALSE(state_.panel) << "the panel stays as it is";
    state_.panel = true;
    EXPECT_EQ(state_, start_);
    tap(Key::P);
    tap(Key::F12);
    EXPECT_EQ(requests_.screenshots, 2);
    EXPECT_FALSE(requests_.quit);
    tap(Key::Escape);
    EXPECT_TRUE(requests_.quit);
    requests_ = {};
    handle({.kind = ViewEventKind::Close});
    EXPECT_TRUE(requests_.quit);
}

TEST(OrbitCamera, IsTheCameraItWasMadeFrom) {
    Camera camera;
    camera.eye = {-7.5f, 3.4f, 13.5f};
    camera.target = {0.2f, 2.3f, 0.5f};
    camera.verticalFovDeg = 38;
    const Camera again = OrbitCamera::around(camera).camera();
    EXPECT_LT((again.eye - camera.eye).norm(), 2e-6);
    EXPECT_EQ(again.target, camera.target);
    EXPECT_EQ(again.verticalFovDeg, 38);
    camera.eye = camera.target + Vec3f(0, 5, 0);
    const OrbitCamera above = OrbitCamera::around(camera);
    EXPECT_NEAR(above.elevationRad, kSteepestRad, 1e-12);
    EXPECT_NEAR(above.distance, 5, 1e-6);
}

TEST(OrbitCamera, LooksAtAPointFromWhereItIs) {
    OrbitCamera camera;
    camera.distance = 4;
    camera.azimuthRad = 1;
    camera.elevationRad = 0.2;
    const Vec3d eye = camera.eye(), point(0.5, -0.3, 0.8);
    camera.lookAt(point);
    EXPECT_LT((camera.eye() - eye).norm(), 1e-12);
    EXPECT_EQ(camera.target, point);
    // Right, up and back are a right-handed frame.
    EXPECT_LT((camera.right().cross(camera.up()) - camera.toEye()).norm(), 1e-12);
    const OrbitCamera before = camera;
    camera.lookAt(camera.eye());
    EXPECT_EQ(camera, before);
}

TEST(ViewBindings, OneKeyDoesOneThing) {
    for (const KeyBinding& binding : keyBindings()) {
        EXPECT_EQ(findBinding(binding.key, binding.shift), &binding) << binding.name;
        if (!binding.shift) {
            EXPECT_EQ(keyFromName(binding.name), binding.key);
        }
    }
    EXPECT_EQ(findBinding(Key::N, true), findBinding(Key::N, false));
    EXPECT_EQ(findBinding(Key::Home, false), nullptr);
    EXPECT_EQ(keyFromName("Nonsense"), Key::Unknown);
}

TEST(ShownNames, AreInverse) {
    for (int i = 0; i < kShownCount; ++i) EXPECT_EQ(shownFromName(shownName(Shown(i))), Shown(i));
    EXPECT_FALSE(shownFromName("nothing"));
}

}  // namespace
}  // namespace prt::tools
