// Pictures of distant light in the layouts that files come in. This header is the one place where they are
// described; everything is resampled to latitude-longitude (math/environment.h), whose centre is +Z and which
// shows +X left of the centre: the sphere from the inside, up at the top.
//
//   name                  width : height  what it shows
//   latitude-longitude        2 : 1       as math/environment.h
//   cube-vertical-strip       1 : 6       the faces of an OpenGL cube texture, +X, −X, +Y, −Y, +Z, −Z from
//   cube-horizontal-strip     6 : 1       the top or from the left, orientation of math/sphere_map.h
//   horizontal-cross          4 : 3       a cube cut open, seen from the inside. Around the middle row from
//   vertical-cross            3 : 4       the left +X, +Z, −X (and −Z); above and below +Z lie +Y and −Y.
//                                         In the vertical cross −Z hangs upside down under −Y
//   openexr-cube              1 : 6       ImfEnvmap.h: its own face orientation, outer texel centres on the
//                                         edges of the cube
//   dual-paraboloid           2 : 1       z ≥ 0 left, z < 0 right, as math/sphere_map.h
//   angular-map               1 : 1       a disc, its centre +Z, its rim −Z; the angle from +Z grows in
//                                         proportion to the radius; +Y up, −X right. Corners show nothing
//
// Strips are textures, looked up by direction, which show the sphere from the outside; crosses and angular
// maps are pictures, seen from the inside. For files made the other way there is `mirrored`, which swaps the
// sphere's +X and −X. [Debevec1998]'s frame has −Z in the centre and +X to the right, both in angular maps
// and in latitude-longitude images; taking the centre of all of them as +Z is one and the same half turn.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/sphere_map.h"
#include "precompute/math/vec.h"

namespace prt {

/// See the table above.
enum class EnvironmentLayout {
    LatLong,
    CubeVerticalStrip,
    CubeHorizontalStrip,
    HorizontalCross,
    VerticalCross,
    OpenExrCube,
    DualParaboloid,
    AngularMap,
};

/// Names as in the table above, in the order of EnvironmentLayout.
const std::vector<std::string>& environmentLayoutNames();
/// @return  the layout of that name, or nothing
std::optional<EnvironmentLayout> environmentLayoutFromName(const std::string& name);
/// Whether a picture of this many texels can be in a layout (its shape; faces of at least one texel, two
/// where the outer centres lie on edges).
bool environmentLayoutFits(EnvironmentLayout layout, int width, int height);
/// The layout that a shape suggests. 2 : 1 is taken for latitude-longitude, never for a dual paraboloid;
/// 1 : 6 for a strip of OpenGL faces, never for OpenEXR's cube (whose files say so by an attribute); square
/// for an angular map.
/// @return  nothing where no layout has the shape
std::optional<EnvironmentLayout> detectEnvironmentLayout(int width, int height);
/// Shapes that detectEnvironmentLayout knows, for messages: "2:1 (latitude-longitude), …".
std::string environmentShapeList();

/// Where a picture shows what.
class EnvironmentLayoutMap {
  public:
    /// @param width, height  a shape that fits
    EnvironmentLayoutMap(EnvironmentLayout layout, int width, int height);

    /// Unit direction of a texel's centre; nothing where the texel shows nothing (beside the arms of a cross,
    /// beyond the rim of an angular map).
    std::optional<Vec3d> texelDirection(int x, int y) const;
    /// Solid angle of the part of the sphere that a texel covers, sr; 0 where it shows nothing; all sum to
    /// 4π. Exact, except for angular maps: there the mean of 16×16 points per texel (sum right to 1e-4 from
    /// 16 texels a side).
    double texelSolidAngle(int x, int y) const;
    /// Bilinear lookup: texels numbered y·width + x, weights ≥ 0 that sum to 1. Cubes of area texels are
    /// filtered across their edges, angular maps across their rim; nothing outside the picture's content is
    /// ever mixed in.
    /// @param direction  any length > 0
    SphereTaps taps(const Vec3d& direction) const;

    EnvironmentLayout layout() const { return layout_; }
    int width() const { return width_; }
    int height() const { return height_; }
    /// Texels along the side of a face (of the disc of an angular map; rows of latitude-longitude).
    int size() const { return size_; }

  private:
    /// A point of a cube face of math/sphere_map.h, and where the picture shows it.
    struct FacePlace {
        int column, row;  ///< of the square
        bool mirrored, turned;
    };
    FacePlace facePlace(int face) const;
    int cubeTexel(int face, int x, int y) const;
    std::optional<CubePoint> cubePoint(int x, int y) const;
    SphereTaps cubeTaps(const Vec3d& direction) const;
    SphereTaps openExrCubeTaps(const Vec3d& direction) const;
    SphereTaps angularTaps(const Vec3d& direction) const;
    int angularTexel(int x, int y) const;

    EnvironmentLayout layout_;
    int width_, height_, size_;
    std::unique_ptr<SphereMap> map_;
};

/// Rows that latLongFromLayout makes: about as many texels along the equator as the picture has, 1 to 4096.
int latLongHeightForLayout(EnvironmentLayout layout, int width, int height);

/// Resamples a picture to latitude-longitude. A texel is the mean of bilinear lookups in n×n points of equal
/// solid angle, so many that they lie half the side of the picture's smallest texel apart: none is left out
/// of a picture larger than its target, and what a single bright texel gives is kept (measured on faces of
/// 32²: to 3 %, and 5e-3 of a picture of random texels). n is 2 for dual paraboloids and 4 for the others,
/// more where the target's height is limited. Costs 0.2 to 0.7 s on one thread for faces of 256² (a target of
/// 1024×512), in proportion to their texels.
/// @param rgb       [height×width×3], shape that fits the layout
/// @param mirrored  the picture shows +X where this layout has −X, and the other way round
/// @return          [h×2·h×3], h = latLongHeightForLayout
std::vector<float> latLongFromLayout(EnvironmentLayout layout, int width, int height,
                                     std::span<const float> rgb, bool mirrored = false);

}  // namespace prt
