// Layouts of tables over the normal: [IwanickiSloan2012, Sec. 3.2 and Appendix A] with the concentric map of
// [ShirleyChiu1997], and octahedra [PraunHoppe2003] with the border that engines store [Majercik2019].
#include "precompute/math/table_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <tuple>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {

const std::vector<std::string>& TableLayout::names() {
    static const std::vector<std::string> all = {"cube", "dual-paraboloid", "octahedral"};
    return all;
}

int TableLayout::minSize(const std::string& name) { return name == "dual-paraboloid" ? 2 : 1; }

TableLayout::Kind TableLayout::kindOf(const std::string& name) {
    const auto found = std::find(names().begin(), names().end(), name);
    if (found == names().end())
        throw InputError(fmt::format("table layout '{}'", name), "there is none of this name",
                         fmt::format("one of {}", fmt::join(names(), ", ")));
    return Kind(std::distance(names().begin(), found));
}

std::array<int, 2> TableLayout::imageSize(const std::string& name, int size) {
    switch (kindOf(name)) {
        case Kind::DualParaboloid:
            return {2 * size, size};
        case Kind::Octahedral:
            return {size + 2, size + 2};
        default:
            return {size, 6 * size};
    }
}

TableLayout::TableLayout(const std::string& name, int size) : name_(name), kind_(kindOf(name)), size_(size) {
    if (size < minSize(name) || size > kMaxSize)
        throw InputError(fmt::format("table layout {}", name),
                         fmt::format("size {} is outside {}..{}", size, minSize(name), kMaxSize));
    map_ = makeSphereMap(kind_ == Kind::Cube ? "cube-seamless" : name, size);
    std::tie(width_, height_) = std::tuple_cat(imageSize(name, size));
}

int TableLayout::imageFromMap(int mapTexel) const {
    const int x = mapTexel % size_, row = mapTexel / size_;
    switch (kind_) {
        case Kind::DualParaboloid:
            return row % size_ * width_ + row / size_ * size_ + x;
        case Kind::Octahedral:
            return (row + 1) * width_ + x + 1;
        default:
            return mapTexel;
    }
}

int TableLayout::mapFromImage(int texel) const {
    int x = texel % width_, y = texel / width_;
    if (kind_ == Kind::DualParaboloid) return (x / size_ * size_ + y) * size_ + x % size_;
    if (kind_ == Kind::Cube) return texel;
    // A texel of the border repeats the one that lies over the edge, mirrored in the edge's middle; a corner
    // the opposite one.
    const int last = size_ - 1;
    x -= 1;
    y -= 1;
    const bool overX = x < 0 || x > last, overY = y < 0 || y > last;
    x = std::clamp(x, 0, last);
    y = std::clamp(y, 0, last);
    return (overX ? last - y : y) * size_ + (overY ? last - x : x);
}

Vec3d TableLayout::normal(int texel) const {
    PRT_CHECK(texel >= 0 && texel < texelCount());
    return map_->texelDirection(mapFromImage(texel));
}

SphereTaps TableLayout::taps(const Vec3d& direction) const {
    SphereTaps taps = map_->taps(direction);
    for (SphereTap& tap : taps) tap.texel = imageFromMap(tap.texel);
    return taps;
}

int TableLayout::mirrored(int texel, MirrorAxis axis) const {
    PRT_CHECK(texel >= 0 && texel < texelCount());
    const int x = texel % width_, y = texel / width_;
    if (kind_ == Kind::Cube) {
        Vec3d direction = normal(texel);
        direction[int(axis)] = -direction[int(axis)];
        const CubePoint point = cubePointFromDirection(direction, size_);
        return (point.face * size_ + std::min(int(point.y), size_ - 1)) * size_ +
               std::min(int(point.x), size_ - 1);
    }
    if (axis == MirrorAxis::Y) return (height_ - 1 - y) * width_ + x;
    if (kind_ == Kind::Octahedral) return axis == MirrorAxis::X ? y * width_ + width_ - 1 - x : -1;
    // The square of −Z is mirrored in x: negating z reverses whole rows, negating x each square.
    if (axis == MirrorAxis::Z) return y * width_ + width_ - 1 - x;
    return y * width_ + x / size_ * size_ + size_ - 1 - x % size_;
}

}  // namespace prt
