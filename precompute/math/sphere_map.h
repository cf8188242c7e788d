// Images of the sphere. This header is the one place where their layouts are described.
//
// Everywhere x runs along a row, y over the rows, and texel centres are at half-integers. (s, t) in [−1, 1]
// stand for a place on a face of `size` texels a side: s = 2x/size − 1, t = 2y/size − 1 except where said
// otherwise.
//
// Cube ("cube", "cube-seamless"): six square faces in OpenGL order (+X, −X, +Y, −Y, +Z, −Z) and orientation,
// stacked vertically in files: face f is rows f·size … (f+1)·size − 1. The direction of a point of a face (t
// downwards: the order in which OpenGL takes rows) is, before normalisation:
//   +X ( 1, −t, −s)   −X (−1, −t,  s)   +Y ( s,  1,  t)   −Y ( s, −1, −t)   +Z ( s, −t,  1)   −Z (−s, −t, −1)
//
// All layouts. "Right, top" is what lies at the right and top edge of a face when its first row is on top;
// "seen from" says whether such an image shows the sphere from the inside or from the outside.
//
//   layout                  faces                               centre   right, top      seen from
//   cube, cube-seamless     6, as above                         axes     as above        outside
//   dual-paraboloid,        2: z ≥ 0 (left in files),           +Z       +X, +Y          outside
//   dual-orthographic          z < 0 (right)                    −Z       −X, +Y
//   octahedral,             1; its corners are −Z               +Z       +X, +Y          outside
//   equal-area-octahedral
//   latitude-longitude      1, 2·size wide (environment.h)      +Z       −X, +Y          inside
//   healpix                 12: 0…3 around +Z, 4…7 around       below    north-east,     inside
//                           the equator, 8…11 around −Z                  south-east
//
// Dual maps: a direction (x, y, z) falls on the disc at (x, y) / (1 + |z|) for the paraboloid and at (x, y)
// for the orthographic projection; the face of −Z is mirrored in x, like the cube's, so that the two faces
// side by side in an image are joined at +X. The disc goes to the square by the concentric map, in which
// squares around the centre are circles. The square is shrunk so that the equator lies on the outer ring of
// texel centres: s = (2x − size) / (size − 1). Directions on the equator therefore have a texel on both faces
// (column x of one is column size − 1 − x of the other); what a texel of the ring covers beyond the equator
// counts for nothing, and points there stand for the nearest of the equator. Lookups never reach beyond the
// ring: they are plain bilinear within one face, and continuous.
//
// Octahedral maps: (|x|, |y|) / (|x| + |y| + |z|), or for equal areas r·(1 − φ, φ) with r = √(1 − |z|) and
// φ = 2/π·atan(|y| / |x|), is a point (u, v) with u + v ≤ 1; below the equator it is turned over the
// diagonal to (1 − v, 1 − u); s has the sign of x, t that of −y. Lookups are bilinear with a border of one
// texel around the image, as engines store it: going out over an edge leads back in over the same edge,
// mirrored in its middle (texel (size, y) is (size − 1, size − 1 − y)), and the corner beyond a corner is
// the opposite corner. At even sizes the fold runs through texel centres: they err more than odd ones, by
// 1.2 to 1.7 times the squared error for spherical harmonics of order 3.
//
// Latitude-longitude: lookups repeat in longitude and clamp in latitude, which is what samplers do without
// borders; closer than half a texel to a pole they depend on the longitude, so the pole itself is no limit.
// (A border that goes on over the poles would take 2 to 8 % off the squared error.)
//
// HEALPix: faces are squares standing on a corner, numbered as in [Gorski2005], x to the north-east and y to
// the north-west. Interleaving the bits of their texels (y x y x …) gives the NESTED number within the face
// where size is a power of two, which it need not be here. With a = x/size, b = y/size, J = 2, 3, 4 in the
// three rows of four faces and C = 1, 3, 5, 7; 0, 2, 4, 6; 1, 3, 5, 7, a point lies at i = J − a − b from the
// north pole (0) to the south pole (4):
//   1 ≤ i ≤ 3       z = 2/3·(2 − i)    longitude = π/4·(C + a − b)
//   i < 1           z = 1 − i²/3       longitude = π/4·(C + (a − b)/i), and likewise with 4 − i in the south
// with longitude from +X towards +Y. Lookups are bilinear over the face and a border of neighbours; where
// three faces meet, the missing texel is the mean of the other three, as on a cube.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "precompute/math/vec.h"

namespace prt {

/// A point of a cube face; x and y in texels, texel centres at half-integers.
struct CubePoint {
    int face;
    double x, y;
};

/// Unit direction of a point of a face (x, y may be anywhere in [0, size]).
Vec3d cubeDirection(const CubePoint& point, int size);
/// Unit direction of a texel's centre.
Vec3f cubeTexelDirection(int face, int x, int y, int size);
/// The face and point that a direction (any length > 0) falls on.
CubePoint cubePointFromDirection(const Vec3d& direction, int size);
/// Exact solid angle of a texel, sr.
double cubeTexelSolidAngle(int x, int y, int size);

/// One texel and its weight in a filtered lookup.
struct CubeTap {
    int face = 0, x = 0, y = 0;
    float weight = 0;
};
/// The four texels (at a corner of the cube three, the fourth weighing 0) that a bilinear lookup with
/// filtering across faces (GL_TEXTURE_CUBE_MAP_SEAMLESS) mixes; weights sum to 1.
std::array<CubeTap, 4> cubeSeamlessTaps(const Vec3d& direction, int size);

/// Neighbouring texel across the edge of a face.
/// @param x, y  at most one of them outside [0, size), and by one texel only
CubeTap cubeTexelAcrossEdge(int face, int x, int y, int size);

/// Largest size that makeSphereMap takes, texels along the side of a face.
inline constexpr int kMaxSphereMapSize = 8192;

/// A point of a map; x and y in texels of the face, texel centres at half-integers.
struct SpherePoint {
    int face;
    double x, y;
};

/// A texel, numbered (face·faceHeight + y)·faceWidth + x, and its weight in a filtered lookup.
struct SphereTap {
    int texel = 0;
    float weight = 0;
};
/// Taps of one lookup; unused ones weigh 0.
using SphereTaps = std::array<SphereTap, 4>;

/// A parameterization of the sphere by textures. Immutable; every function may be called from any thread.
class SphereMap {
  public:
    virtual ~SphereMap() = default;

    /// What makeSphereMap was given.
    const std::string& name() const { return name_; }
    int faceCount() const { return faceCount_; }
    int faceWidth() const { return faceWidth_; }
    int faceHeight() const { return faceHeight_; }
    /// All stored texels, duplicates on shared equators counted.
    int texelCount() const { return faceCount_ * faceWidth_ * faceHeight_; }

    /// The point that shows a direction.
    /// @param direction  any length > 0
    /// @return face in [0, faceCount), x in [0, faceWidth], y in [0, faceHeight]
    virtual SpherePoint pointFromDirection(const Vec3d& direction) const = 0;
    /// What a point shows.
    /// @param point  face in [0, faceCount), x in [0, faceWidth], y in [0, faceHeight]
    /// @return unit
    virtual Vec3d directionFromPoint(const SpherePoint& point) const = 0;
    /// Centre of a texel.
    /// @param texel  in [0, texelCount)
    SpherePoint texelCentre(int texel) const;
    /// Unit direction of a texel's centre.
    /// @param texel  in [0, texelCount)
    Vec3d texelDirection(int texel) const;
    /// Exact solid angle of the part of the sphere that the texel's square covers, sr; all texels sum to 4π.
    /// @param texel  in [0, texelCount)
    virtual double texelSolidAngle(int texel) const = 0;
    /// Bilinear lookup as graphics hardware does it for this map.
    /// @param direction  any length > 0
    /// @return texels in [0, texelCount), weights ≥ 0 that sum to 1
    virtual SphereTaps taps(const Vec3d& direction) const = 0;

  protected:
    SphereMap(std::string name, int faceCount, int faceWidth, int faceHeight);

  private:
    std::string name_;
    int faceCount_, faceWidth_, faceHeight_;
};

/// What makeSphereMap offers.
struct SphereMapFamily {
    std::string name;   ///< "cube-seamless", …
    std::string title;  ///< for legends
    int minSize;        ///< 2 where the equator lies on a ring of centres, else 1
};
/// All layouts, the paper's four first.
const std::vector<SphereMapFamily>& sphereMapFamilies();

/// @param name  "cube" (each face filtered alone, clamped to its edge: DX9), "cube-seamless" (filtered across
///              edges: DX10), "dual-paraboloid", "dual-orthographic", "octahedral", "equal-area-octahedral",
///              "latitude-longitude", "healpix"; all described at the top of this file
/// @param size  texels along the side of a face (rows of latitude-longitude, N_side of HEALPix), from the
///              family's minSize to kMaxSphereMapSize
/// @throws InputError  unknown name, size out of range
/// @source [IwanickiSloan2012, Appendix A], [ShirleyChiu1997], [Clarberg2008], [Gorski2005]
std::unique_ptr<SphereMap> makeSphereMap(const std::string& name, int size);

}  // namespace prt
