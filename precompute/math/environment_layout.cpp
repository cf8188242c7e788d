// Layouts of environment pictures. Sources: OpenEXR ImfEnvmap.h (cube with texels on the edges), P. Debevec,
// "Rendering Synthetic Objects into Real Scenes" (1998; angular maps, crosses), OpenGL 4.5 (cube faces).
#include "precompute/math/environment_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/environment.h"
#include "precompute/math/sphere_map_parts.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMaxHeight = 4096;

struct Shape {
    const char* name;
    int columns, rows;  ///< squares side by side and above each other
    bool detected;      ///< by its shape
    int minSize;
};
constexpr std::array<Shape, 8> kShapes{{{"latitude-longitude", 2, 1, true, 1},
                                        {"cube-vertical-strip", 1, 6, true, 1},
                                        {"cube-horizontal-strip", 6, 1, true, 1},
                                        {"horizontal-cross", 4, 3, true, 1},
                                        {"vertical-cross", 3, 4, true, 1},
                                        {"openexr-cube", 1, 6, false, 2},
                                        {"dual-paraboloid", 2, 1, false, 2},
                                        {"angular-map", 1, 1, true, 2}}};

const Shape& shapeOf(EnvironmentLayout layout) { return kShapes[size_t(layout)]; }

/// Point on the surface of the cube [−1, 1]³ that OpenEXR shows at (s, t) of a face, t downwards.
Vec3d onOpenExrFace(int face, double s, double t) {
    switch (face) {
        case 0:
            return {1, -t, s};
        case 1:
            return {-1, -t, -s};
        case 2:
            return {s, 1, -t};
        case 3:
            return {s, -1, t};
        case 4:
            return {-s, -t, 1};
        default:
            return {s, -t, -1};
    }
}

/// Solid angle of the rectangle [s0, s1]×[t0, t1] of a face of the cube [−1, 1]³.
double faceSolidAngle(double s0, double s1, double t0, double t1) {
    const auto corner = [](double s, double t) { return std::atan2(s * t, std::sqrt(s * s + t * t + 1)); };
    return corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0);
}

/// sin(πr)/(πr), with the limit.
double sinc(double r) { return r < 1e-6 ? 1.0 : std::sin(kPi * r) / (kPi * r); }

/// Side of the smallest texel, as an angle. Around −Z angular maps are finer still (tangentially they shrink
/// to nothing), but there next to nothing is left of the sphere: counted is what they have 135° from +Z.
double smallestTexelRad(EnvironmentLayout layout, int size) {
    switch (layout) {
        case EnvironmentLayout::LatLong:
            return kPi / size;
        case EnvironmentLayout::DualParaboloid:
            return std::sqrt(kPi) / size;
        case EnvironmentLayout::AngularMap:
            return 2 * kPi / size * sinc(0.75);
        default:
            return std::sqrt(faceSolidAngle(1 - 2.0 / size, 1, 1 - 2.0 / size, 1));
    }
}

}  // namespace

const std::vector<std::string>& environmentLayoutNames() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> list;
        for (const Shape& shape : kShapes) list.emplace_back(shape.name);
        return list;
    }();
    return names;
}

std::optional<EnvironmentLayout> environmentLayoutFromName(const std::string& name) {
    for (size_t i = 0; i < kShapes.size(); ++i)
        if (name == kShapes[i].name) return EnvironmentLayout(i);
    return std::nullopt;
}

bool environmentLayoutFits(EnvironmentLayout layout, int width, int height) {
    const Shape& shape = shapeOf(layout);
    const int size = width / shape.columns;
    return size >= shape.minSize && width == size * shape.columns && height == size * shape.rows;
}

std::optional<EnvironmentLayout> detectEnvironmentLayout(int width, int height) {
    for (size_t i = 0; i < kShapes.size(); ++i)
        if (kShapes[i].detected && environmentLayoutFits(EnvironmentLayout(i), width, height))
            return EnvironmentLayout(i);
    return std::nullopt;
}

std::string environmentShapeList() {
    std::string list;
    for (const Shape& shape : kShapes)
        if (shape.detected)
            list += (list.empty() ? "" : ", ") + std::to_string(shape.columns) + ":" +
                    std::to_string(shape.rows) + " (" + shape.name + ")";
    return list;
}

EnvironmentLayoutMap::EnvironmentLayoutMap(EnvironmentLayout layout, int width, int height)
    : layout_(layout), width_(width), height_(height), size_(width / shapeOf(layout).columns) {
    PRT_CHECK(environmentLayoutFits(layout, width, height));
    if (layout == EnvironmentLayout::LatLong) map_ = makeSphereMap("latitude-longitude", size_);
    if (layout == EnvironmentLayout::DualParaboloid) map_ = makeSphereMap("dual-paraboloid", size_);
}

// Seen from the inside a face of math/sphere_map.h is mirrored: left and right for those around, and since
// those above and below join +Z, likewise for them.
EnvironmentLayoutMap::FacePlace EnvironmentLayoutMap::facePlace(int face) const {
    constexpr std::array<FacePlace, 6> kHorizontal{{{0, 1, true, false},
                                                    {2, 1, true, false},
                                                    {1, 0, true, false},
                                                    {1, 2, true, false},
                                                    {1, 1, true, false},
                                                    {3, 1, true, false}}};
    switch (layout_) {
        case EnvironmentLayout::CubeVerticalStrip:
            return {0, face, false, false};
        case EnvironmentLayout::CubeHorizontalStrip:
            return {face, 0, false, false};
        case EnvironmentLayout::HorizontalCross:
            return kHorizontal[size_t(face)];
        default:
            return face == 5 ? FacePlace{1, 3, true, true} : kHorizontal[size_t(face)];
    }
}

int EnvironmentLayoutMap::cubeTexel(int face, int x, int y) const {
    const FacePlace place = facePlace(face);
    if (place.mirrored) x = size_ - 1 - x;
    if (place.turned) {
        x = size_ - 1 - x;
        y = size_ - 1 - y;
    }
    return (place.row * size_ + y) * width_ + place.column * size_ + x;
}

std::optional<CubePoint> EnvironmentLayoutMap::cubePoint(int x, int y) const {
    for (int face = 0; face < 6; ++face) {
        const FacePlace place = facePlace(face);
        if (x / size_ != place.column || y / size_ != place.row) continue;
        double inX = x % size_ + 0.5, inY = y % size_ + 0.5;
        if (place.turned) {
            inX = size_ - inX;
            inY = size_ - inY;
        }
        return CubePoint{face, place.mirrored ? size_ - inX : inX, inY};
    }
    return std::nullopt;
}

std::optional<Vec3d> EnvironmentLayoutMap::texelDirection(int x, int y) const {
    PRT_CHECK(x >= 0 && x < width_ && y >= 0 && y < height_);
    switch (layout_) {
        case EnvironmentLayout::LatLong:
            return latLongDirection(x + 0.5, y + 0.5, width_, height_);
        case EnvironmentLayout::DualParaboloid:
            return map_->directionFromPoint({x / size_, x % size_ + 0.5, y + 0.5});
        case EnvironmentLayout::OpenExrCube:
            return onOpenExrFace(y / size_, 2.0 * x / (size_ - 1) - 1, 2.0 * (y % size_) / (size_ - 1) - 1)
                .normalized();
        case EnvironmentLayout::AngularMap: {
            const double u = 2 * (x + 0.5) / size_ - 1, v = 1 - 2 * (y + 0.5) / size_;
            const double r = std::hypot(u, v);
            if (r > 1) return std::nullopt;
            return Vec3d(-kPi * sinc(r) * u, kPi * sinc(r) * v, std::cos(kPi * r));
        }
        default: {
            const std::optional<CubePoint> point = cubePoint(x, y);
            if (!point) return std::nullopt;
            return cubeDirection(*point, size_);
        }
    }
}

double EnvironmentLayoutMap::texelSolidAngle(int x, int y) const {
    PRT_CHECK(x >= 0 && x < width_ && y >= 0 && y < height_);
    switch (layout_) {
        case EnvironmentLayout::LatLong:
            return latLongTexelSolidAngle(y, width_, height_);
        case EnvironmentLayout::DualParaboloid:
            return map_->texelSolidAngle((x / size_ * size_ + y) * size_ + x % size_);
        case EnvironmentLayout::OpenExrCube: {
            const auto edge = [&](double at) { return std::clamp(2 * at / (size_ - 1) - 1, -1.0, 1.0); };
            return faceSolidAngle(edge(x - 0.5), edge(x + 0.5), edge(y % size_ - 0.5), edge(y % size_ + 0.5));
        }
        case EnvironmentLayout::AngularMap: {
            constexpr int kPoints = 16;
            double sum = 0;
            for (int i = 0; i < kPoints * kPoints; ++i) {
                const double r = std::hypot(2 * (x + (i % kPoints + 0.5) / kPoints) / size_ - 1,
                                            2 * (y + (double(i / kPoints) + 0.5) / kPoints) / size_ - 1);
                if (r < 1) sum += sinc(r);
            }
            return sum / (kPoints * kPoints) * kPi * kPi * 4 / (double(size_) * size_);
        }
        default: {
            const std::optional<CubePoint> point = cubePoint(x, y);
            return point ? cubeTexelSolidAngle(int(point->x), int(point->y), size_) : 0.0;
        }
    }
}

SphereTaps EnvironmentLayoutMap::openExrCubeTaps(const Vec3d& direction) const {
    const double x = direction.x(), y = direction.y(), z = direction.z();
    const double ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
    int face;
    double s, t, major;
    if (ax >= ay && ax >= az) {
        face = x >= 0 ? 0 : 1;
        s = x >= 0 ? z : -z;
        t = -y;
        major = ax;
    } else if (ay >= az) {
        face = y >= 0 ? 2 : 3;
        s = x;
        t = y >= 0 ? -z : z;
        major = ay;
    } else {
        face = z >= 0 ? 4 : 5;
        s = z >= 0 ? -x : x;
        t = -y;
        major = az;
    }
    PRT_CHECK_LT(0.0, major);
    // The outer centres lie on the edges, so faces meet without a seam.
    const double column = (s / major + 1) / 2 * (size_ - 1), row = (t / major + 1) / 2 * (size_ - 1);
    const int x0 = std::clamp(int(column), 0, size_ - 2), y0 = std::clamp(int(row), 0, size_ - 2);
    const double fx = std::clamp(column - x0, 0.0, 1.0), fy = std::clamp(row - y0, 0.0, 1.0);
    const int first = (face * size_ + y0) * size_ + x0;
    return {{{first, float((1 - fx) * (1 - fy))},
             {first + 1, float(fx * (1 - fy))},
             {first + size_, float((1 - fx) * fy)},
             {first + size_ + 1, float(fx * fy)}}};
}

// A centre beyond the rim is what lies as far inside it on the other side: going on over −Z.
int EnvironmentLayoutMap::angularTexel(int x, int y) const {
    const double u = 2 * (x + 0.5) / size_ - 1, v = 2 * (y + 0.5) / size_ - 1, r = std::hypot(u, v);
    if (r <= 1) return y * width_ + x;
    for (double inside = 2 - r;; inside -= 0.5 / size_) {
        const int column = std::clamp(int((1 - u * inside / r) / 2 * size_), 0, size_ - 1);
        const int row = std::clamp(int((1 - v * inside / r) / 2 * size_), 0, size_ - 1);
        if (std::hypot(2 * (column + 0.5) / size_ - 1, 2 * (row + 0.5) / size_ - 1) <= 1)
            return row * width_ + column;
    }
}

SphereTaps EnvironmentLayoutMap::angularTaps(const Vec3d& direction) const {
    const double across = std::hypot(direction.x(), direction.y());
    const double r = std::atan2(across, direction.z()) / kPi;
    const double u = across > 0 ? -direction.x() / across * r : r;
    const double v = across > 0 ? -direction.y() / across * r : 0;
    const bool inside = r < 1 - 3.0 / size_;  // all four centres
    return bilinearTaps((u + 1) / 2 * size_, (v + 1) / 2 * size_,
                        [&](int x, int y) { return inside ? y * width_ + x : angularTexel(x, y); });
}

SphereTaps EnvironmentLayoutMap::cubeTaps(const Vec3d& direction) const {
    const CubePoint point = cubePointFromDirection(direction, size_);
    const auto inside = [&](double at) { return at >= 0.5 && at < size_ - 0.5; };
    if (inside(point.x) && inside(point.y))
        return bilinearTaps(point.x, point.y, [&](int x, int y) { return cubeTexel(point.face, x, y); });
    const std::array<CubeTap, 4> across = cubeSeamlessTaps(direction, size_);
    SphereTaps taps;
    for (size_t i = 0; i < 4; ++i)
        taps[i] = {cubeTexel(across[i].face, across[i].x, across[i].y), across[i].weight};
    return taps;
}

SphereTaps EnvironmentLayoutMap::taps(const Vec3d& direction) const {
    switch (layout_) {
        case EnvironmentLayout::LatLong:
            return map_->taps(direction);
        case EnvironmentLayout::DualParaboloid: {
            SphereTaps taps = map_->taps(direction);
            for (SphereTap& tap : taps) {
                const int row = tap.texel / size_;  // of the faces stacked
                tap.texel = row % size_ * width_ + row / size_ * size_ + tap.texel % size_;
            }
            return taps;
        }
        case EnvironmentLayout::OpenExrCube:
            return openExrCubeTaps(direction);
        case EnvironmentLayout::AngularMap:
            return angularTaps(direction);
        default:
            return cubeTaps(direction);
    }
}

int latLongHeightForLayout(EnvironmentLayout layout, int width, int height) {
    PRT_CHECK(environmentLayoutFits(layout, width, height));
    const int size = width / shapeOf(layout).columns;
    const bool whole = layout == EnvironmentLayout::LatLong || layout == EnvironmentLayout::AngularMap;
    return std::min(whole ? size : 2 * size, kMaxHeight);
}

std::vector<float> latLongFromLayout(EnvironmentLayout layout, int width, int height,
                                     std::span<const float> rgb, bool mirrored) {
    PRT_CHECK_EQ(rgb.size(), size_t(width) * size_t(height) * 3);
    const EnvironmentLayoutMap map(layout, width, height);
    const int rows = latLongHeightForLayout(layout, width, height), columns = 2 * rows;
    const int points = int(std::ceil(2 * kPi / rows / smallestTexelRad(layout, map.size())));
    std::vector<double> sines, cosines;  // of the longitudes of all points of a row
    for (int i = 0; i < columns * points; ++i) {
        const double longitude = kPi - 2 * kPi * (i + 0.5) / (columns * points);
        sines.push_back(mirrored ? -std::sin(longitude) : std::sin(longitude));
        cosines.push_back(std::cos(longitude));
    }
    std::vector<float> image(size_t(rows) * size_t(columns) * 3);
    parallelFor(size_t(rows), 1, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) {
            const double top = std::cos(kPi * double(y) / rows),
                         bottom = std::cos(kPi * double(y + 1) / rows);
            for (int x = 0; x < columns; ++x) {
                double sum[3] = {0, 0, 0};
                for (int i = 0; i < points * points; ++i) {
                    const double up = top + (bottom - top) * (double(i / points) + 0.5) / points;
                    const double out = std::sqrt(std::max(0.0, (1 - up) * (1 + up)));
                    const size_t at = size_t(x * points + i % points);
                    for (const SphereTap& tap : map.taps({sines[at] * out, up, cosines[at] * out}))
                        for (size_t c = 0; c < 3; ++c)
                            sum[c] += double(tap.weight) * double(rgb[size_t(tap.texel) * 3 + c]);
                }
                for (size_t c = 0; c < 3; ++c)
                    image[(y * size_t(columns) + size_t(x)) * 3 + c] = float(sum[c] / (points * points));
            }
        }
    });
    return image;
}

}  // namespace prt
