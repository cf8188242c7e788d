// What the viewer shows: everything that keys, mouse and panel change, and nothing that needs a window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/io/scene.h"
#include "precompute/io/surface_image.h"
#include "precompute/math/vec.h"
#include "runtime/technique.h"

namespace prt::tools {

/// A camera that turns around its target.
struct OrbitCamera {
    Vec3d target = Vec3d::Zero();
    double azimuthRad = 0;    ///< of the eye around the target, from +Z towards +X
    double elevationRad = 0;  ///< of the eye above the horizon, at most kSteepestRad either way
    double distance = 1;      ///< > 0, scene units
    double verticalFovDeg = 40;

    bool operator==(const OrbitCamera&) const = default;
    /// From the target to the eye, unit.
    Vec3d toEye() const;
    Vec3d eye() const { return target + distance * toEye(); }
    /// Unit, horizontal, towards the right of the picture.
    Vec3d right() const;
    /// Unit, towards the top of the picture.
    Vec3d up() const;
    Camera camera() const;

    /// The orbit of a camera; one that looks steeper than kSteepestRad is turned to that.
    static OrbitCamera around(const Camera& camera);
    /// Moves the target to a point and keeps the eye where it is, as far as kSteepestRad allows.
    void lookAt(const Vec3d& point);
};
inline constexpr double kSteepestRad = 89 * 3.14159265358979323846 / 180;

/// What the picture is of.
enum class Shown { Lit, Weight, Coefficient, Ao, Validity, Charts, Reference, Difference };
inline constexpr int kShownCount = 8;
/// "lit", "weight", "coefficient", "ao", "validity", "charts", "reference", "difference".
const char* shownName(Shown shown);
std::optional<Shown> shownFromName(const std::string& name);
/// Whether it is traced with rays, or compared with what is.
constexpr bool needsReference(Shown shown) { return shown == Shown::Reference || shown == Shown::Difference; }
/// Whether it shows values of points, without light.
constexpr bool showsPoints(Shown shown) { return shown != Shown::Lit && !needsReference(shown); }

/// What there is to choose from; constant while a bundle is shown.
struct ViewChoices {
    std::vector<Technique> techniques;      ///< at least one
    std::vector<std::string> environments;  ///< names, at least one
    int components = 0;                     ///< vectors of pca.exr; 0: none
    int coefficients = 0;                   ///< n² of visibility.exr; 0: none
    bool charts = false;                    ///< per texel, with an atlas
    Bounds bounds{Vec3f::Zero(), Vec3f::Zero()};
    /// Why there is nothing to show of a kind; empty where there is.
    std::string whyNot(Shown shown) const;
    /// Numbers that stepIndex runs through: vectors, coefficients, or 1.
    int indexCount(Shown shown) const;
};

struct ViewState {
    OrbitCamera camera;
    size_t technique = 0;         ///< index into the choices
    std::vector<double> weights;  ///< [environments] >= 0
    std::optional<size_t> solo;   ///< the one environment that alone shines, with weight 1
    double rotationRad = 0;       ///< turn of the environments about the up axis
    double exposureStops = 0;
    bool autoExposure = false;
    ToneCurve toneCurve = ToneCurve::None;
    int samples = 1;
    bool normalMap = true, background = true;
    Shown shown = Shown::Lit;
    int weight = 0, coefficient = 0;  ///< which is shown
    bool panel = true, help = false;

    bool operator==(const ViewState&) const = default;
    /// [environments] as they shine: weights, or 1 for the one that is alone.
    std::vector<double> effectiveWeights() const;
    /// Number of the vector or coefficient that is shown; 0 for other kinds.
    int index() const;
    /// Chooses it, wrapped around at the ends.
    void setIndex(int index, const ViewChoices& choices);
};

/// Puts the middle of the scene in the middle of the picture, as far away as prt relight does by itself
/// (its bounding sphere touches the picture's upper and lower edge); the direction stays.
void fitScene(OrbitCamera& camera, const Bounds& bounds);
/// Moves eye and target.
/// @param right, up, forward  scene units; forward follows the horizon, up is the world's
void flyBy(OrbitCamera& camera, double right, double up, double forward);
/// Radius of the scene's bounding sphere, > 0.
double sceneRadius(const Bounds& bounds);

}  // namespace prt::tools
