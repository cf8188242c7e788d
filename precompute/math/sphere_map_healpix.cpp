// HEALPix: [Gorski2005] "HEALPix: A Framework for High-Resolution Discretization and Fast Analysis of Data
// Distributed on the Sphere". Twelve faces of equal area; between |z| ≤ 2/3 a cylindrical projection of equal
// area (their Eqs. 8-9), in the caps Collignon's (their Eqs. 4-5), both written over the face's own
// coordinates.
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;

/// Centre of a face: 2 − z·3/2 is kRow − 1, longitude is kColumn·π/4.
constexpr int kRow[12] = {2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4};
constexpr int kColumn[12] = {1, 3, 5, 7, 0, 2, 4, 6, 1, 3, 5, 7};

/// How the texel beyond a face's side or corner is found: in which face, and how its coordinates lie there.
enum Flip { kFlipX = 1, kFlipY = 2, kSwap = 4 };
struct Neighbour {
    int face[12];  ///< −1: three faces meet, there is none
    int flips[3];  ///< for each row of four faces; flip first, then swap
};
/// Index (x side) + 3·(y side), a side being 0 below, 1 within, 2 beyond.
constexpr Neighbour kNeighbours[9] = {
    {{8, 9, 10, 11, -1, -1, -1, -1, 10, 11, 8, 9}, {0, 0, kFlipX | kFlipY}},  // south
    {{5, 6, 7, 4, 8, 9, 10, 11, 9, 10, 11, 8}, {0, 0, kFlipY | kSwap}},       // south-east
    {{-1, -1, -1, -1, 5, 6, 7, 4, -1, -1, -1, -1}, {0, 0, 0}},                // east
    {{4, 5, 6, 7, 11, 8, 9, 10, 11, 8, 9, 10}, {0, 0, kFlipX | kSwap}},       // south-west
    {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, {0, 0, 0}},                      // the face
    {{1, 2, 3, 0, 0, 1, 2, 3, 5, 6, 7, 4}, {kFlipX | kSwap, 0, 0}},           // north-east
    {{-1, -1, -1, -1, 7, 4, 5, 6, -1, -1, -1, -1}, {0, 0, 0}},                // west
    {{3, 0, 1, 2, 3, 0, 1, 2, 4, 5, 6, 7}, {kFlipY | kSwap, 0, 0}},           // north-west
    {{2, 3, 0, 1, -1, -1, -1, -1, 0, 1, 2, 3}, {kFlipX | kFlipY, 0, 0}}};     // north

class HealpixMap : public SphereMap {
  public:
    HealpixMap(const std::string& name, int size) : SphereMap(name, 12, size, size) {}

    SpherePoint pointFromDirection(const Vec3d& direction) const override {
        const double length = direction.norm();
        PRT_CHECK_LT(0.0, length);
        const Vec3d unit = direction / length;
        double quarters = std::atan2(unit.y(), unit.x()) / (kPi / 2);  // of the circle
        if (quarters < 0) quarters += 4;
        if (quarters >= 4) quarters = 0;  // from a tiny negative number
        return std::abs(unit.z()) <= 2.0 / 3 ? beltPoint(unit.z(), quarters) : capPoint(unit, quarters);
    }

    Vec3d directionFromPoint(const SpherePoint& point) const override {
        PRT_CHECK(point.face >= 0 && point.face < 12);
        const double a = point.x / faceWidth(), b = point.y / faceWidth();
        const double row = kRow[point.face] - a - b;  // from the north pole, 0, to the south pole, 4
        double ring = 1, z, radius;
        if (row < 1 || row > 3) {
            ring = row < 1 ? row : 4 - row;
            const double depth = ring * ring / 3;  // 1 − |z|
            z = row < 1 ? 1 - depth : depth - 1;
            radius = std::sqrt(depth * (2 - depth));
        } else {
            z = (2 - row) * 2 / 3;
            radius = std::sqrt((1 - z) * (1 + z));
        }
        const double longitude = ring > 0 ? kPi / 4 * (kColumn[point.face] + (a - b) / ring) : 0;
        return {radius * std::cos(longitude), radius * std::sin(longitude), z};
    }

    double texelSolidAngle(int texel) const override {
        PRT_CHECK(texel >= 0 && texel < texelCount());
        return 4 * kPi / texelCount();
    }

    SphereTaps taps(const Vec3d& direction) const override {
        const SpherePoint point = pointFromDirection(direction);
        return bilinearTaps(point.x, point.y, [&](int x, int y) { return texelAround(point.face, x, y); });
    }

  private:
    SpherePoint at(int face, double a, double b) const {
        const double size = faceWidth();
        return {face, std::clamp(a, 0.0, 1.0) * size, std::clamp(b, 0.0, 1.0) * size};
    }

    /// |z| ≤ 2/3: lines of constant a and b are straight in (longitude, z).
    SpherePoint beltPoint(double z, double quarters) const {
        const double falling = 0.5 + quarters - 0.75 * z, rising = 0.5 + quarters + 0.75 * z;
        const int lineFalling = int(std::floor(falling)), lineRising = int(std::floor(rising));
        const int face = lineFalling == lineRising  ? 4 + lineFalling % 4
                         : lineFalling < lineRising ? lineFalling % 4
                                                    : 8 + lineRising % 4;
        return at(face, rising - lineRising, 1 - (falling - lineFalling));
    }

    SpherePoint capPoint(const Vec3d& unit, double quarters) const {
        const int quarter = std::min(3, int(quarters));
        const double within = quarters - quarter;
        // √(3(1 − |z|)) without cancellation: 0 at the pole, 1 where the cap ends
        const double radiusSquared = unit.x() * unit.x() + unit.y() * unit.y();
        const double ring = std::sqrt(3 * radiusSquared / (1 + std::abs(unit.z())));
        if (unit.z() >= 0) return at(quarter, 1 - (1 - within) * ring, 1 - within * ring);
        return at(8 + quarter, within * ring, (1 - within) * ring);
    }

    /// Number of the texel (x, y) of a face, of a neighbour where that lies outside, −1 where there is none.
    int texelAround(int face, int x, int y) const {
        const int size = faceWidth();
        const auto side = [size](int v) { return v < 0 ? 0 : v >= size ? 2 : 1; };
        const Neighbour& neighbour = kNeighbours[side(x) + 3 * side(y)];
        const int flips = neighbour.flips[face / 4], there = neighbour.face[face];
        if (there < 0) return -1;
        x = (x + size) % size;
        y = (y + size) % size;
        if (flips & kFlipX) x = size - 1 - x;
        if (flips & kFlipY) y = size - 1 - y;
        if (flips & kSwap) std::swap(x, y);
        return (there * size + y) * size + x;
    }
};

}  // namespace

std::unique_ptr<SphereMap> makeHealpixMap(const std::string& name, int size) {
    return std::make_unique<HealpixMap>(name, size);
}

}  // namespace prt
