// Images of the sphere. This header is the one place where the cube layout is described.
//
// Cube: six square faces in OpenGL order (+X, −X, +Y, −Y, +Z, −Z) and orientation, stacked vertically in
// files: face f is rows f·size … (f+1)·size − 1. With (s, t) in [−1, 1], s to the right along a row and t
// downwards over rows (the order in which OpenGL takes rows), the direction of a point of the face is, before
// normalisation:
//   +X ( 1, −t, −s)   −X (−1, −t,  s)   +Y ( s,  1,  t)   −Y ( s, −1, −t)   +Z ( s, −t,  1)   −Z (−s, −t, −1)
#pragma once

#include <array>

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

}  // namespace prt
