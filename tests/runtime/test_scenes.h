// Small scenes, visibility and tables with known answers for the runtime's tests.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/image.h"
#include "precompute/io/scene.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"

namespace prt::test {

/// Rectangle through `centre` with edges 2·right and 2·up (both half-edges), facing cross(right, up); uv0 and
/// uv1 run from (0, 0) at the top left to (1, 1) at the bottom right.
Scene quad(const Vec3f& centre, const Vec3f& right, const Vec3f& up);

/// Puts b behind a: vertices, triangles, materials and textures.
void append(Scene& a, const Scene& b);

/// Sphere with its poles on the y axis; uv1 is its longitude and latitude.
Scene sphere(const Vec3f& centre, float radius, int rings);

/// Adds an image to the scene and returns its index; pixel(x, y) gives RGB, rows from the top.
int addTexture(Scene& scene, int width, int height,
               const std::function<std::array<uint8_t, 3>(int x, int y)>& pixel);

/// The same coefficients at every point.
VisibilityMap uniformVisibility(const PointGrid& grid, int shOrder, const std::vector<float>& coefficients);
/// Smooth pseudo-random numbers in place of coefficients, different at every point.
VisibilityMap noisyVisibility(const PointGrid& grid, int shOrder, unsigned seed);
/// SH of the half-space around a normal.
std::vector<float> hemisphereSh(int shOrder, const Vec3f& normal);

PointGrid texelGrid(int width, int height);

/// A dim sky with a bright patch, at another place and of another colour for every number.
Environment patchSky(int number);

/// Light-cosine table of an environment given as a function of the direction.
NormalTable lightCosineTable(const std::function<Vec3f(const Vec3d&)>& light, int shOrder, int size);
/// Triple-product table of the same light for a basis.
NormalTable tripleProductTable(const NormalTable& lightCosine, const PcaMap& pca);
/// A table of noise of any shape.
NormalTable noisyTable(TableKind kind, int shOrder, int layers, int size, unsigned seed,
                       const std::string& layout = "cube");

/// All n² unit vectors as the basis and a mean of m: weights are the coefficients less m.
PcaMap completePca(const VisibilityMap& visibility, float mean);

}  // namespace prt::test
