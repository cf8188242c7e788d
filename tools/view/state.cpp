// Sources: none; a camera on a sphere around its target.
#include "tools/view/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

constexpr std::array<const char*, kShownCount> kShownNames = {
    "lit", "weight", "coefficient", "ao", "validity", "charts", "reference", "difference"};

}  // namespace

const char* shownName(Shown shown) { return kShownNames[size_t(shown)]; }

std::optional<Shown> shownFromName(const std::string& name) {
    const auto found = std::ranges::find(kShownNames, name);
    if (found == kShownNames.end()) return std::nullopt;
    return Shown(found - kShownNames.begin());
}

Vec3d OrbitCamera::toEye() const {
    return {std::sin(azimuthRad) * std::cos(elevationRad), std::sin(elevationRad),
            std::cos(azimuthRad) * std::cos(elevationRad)};
}

Vec3d OrbitCamera::right() const { return {std::cos(azimuthRad), 0, -std::sin(azimuthRad)}; }

Vec3d OrbitCamera::up() const { return toEye().cross(right()); }

Camera OrbitCamera::camera() const {
    Camera result;
    result.target = target.cast<float>();
    result.eye = eye().cast<float>();
    result.verticalFovDeg = float(verticalFovDeg);
    return result;
}

OrbitCamera OrbitCamera::around(const Camera& camera) {
    OrbitCamera orbit;
    orbit.target = camera.target.cast<double>();
    orbit.verticalFovDeg = double(camera.verticalFovDeg);
    const Vec3d offset = camera.eye.cast<double>() - orbit.target;
    orbit.distance = offset.norm();
    PRT_CHECK(orbit.distance > 0);
    orbit.elevationRad = std::clamp(std::asin(std::clamp(offset.y() / orbit.distance, -1.0, 1.0)),
                                    -kSteepestRad, kSteepestRad);
    if (offset.x() != 0 || offset.z() != 0) orbit.azimuthRad = std::atan2(offset.x(), offset.z());
    return orbit;
}

void OrbitCamera::lookAt(const Vec3d& point) {
    const Vec3d from = eye();
    const Vec3d offset = from - point;
    const double range = offset.norm();
    if (!(range > 0)) return;
    target = point;
    distance = range;
    elevationRad =
        std::clamp(std::asin(std::clamp(offset.y() / range, -1.0, 1.0)), -kSteepestRad, kSteepestRad);
    if (offset.x() != 0 || offset.z() != 0) azimuthRad = std::atan2(offset.x(), offset.z());
}

std::string ViewChoices::whyNot(Shown shown) const {
    if (shown == Shown::Weight && components == 0) return "no pca.exr; run prt compress";
    if ((shown == Shown::Coefficient || shown == Shown::Ao || shown == Shown::Validity) && coefficients == 0)
        return "no visibility.exr; run prt precompute";
    if (shown == Shown::Charts && !charts) return "points are vertices: there is no atlas";
    return {};
}

int ViewChoices::indexCount(Shown shown) const {
    if (shown == Shown::Weight) return std::max(components, 1);
    if (shown == Shown::Coefficient) return std::max(coefficients, 1);
    return 1;
}

std::vector<double> ViewState::effectiveWeights() const {
    if (!solo) return weights;
    std::vector<double> alone(weights.size(), 0.0);
    alone[*solo] = 1;
    return alone;
}

int ViewState::index() const {
    return shown == Shown::Weight ? weight : shown == Shown::Coefficient ? coefficient : 0;
}

void ViewState::setIndex(int index, const ViewChoices& choices) {
    const int count = choices.indexCount(shown);
    index = (index % count + count) % count;
    if (shown == Shown::Weight) weight = index;
    if (shown == Shown::Coefficient) coefficient = index;
}

double sceneRadius(const Bounds& bounds) {
    const double radius = 0.5 * (bounds.high.cast<double>() - bounds.low.cast<double>()).norm();
    return radius > 0 ? radius : 1;
}

void fitScene(OrbitCamera& camera, const Bounds& bounds) {
    camera.target = 0.5 * (bounds.low.cast<double>() + bounds.high.cast<double>());
    camera.distance = sceneRadius(bounds) / std::sin(camera.verticalFovDeg * std::numbers::pi / 360);
}

void flyBy(OrbitCamera& camera, double right, double up, double forward) {
    const Vec3d level(-std::sin(camera.azimuthRad), 0, -std::cos(camera.azimuthRad));
    camera.target += right * camera.right() + up * Vec3d::UnitY() + forward * level;
}

}  // namespace prt::tools
