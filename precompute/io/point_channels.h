// Values of the points of a grid as channels of EXR files. Internal.
#pragma once

#include <string>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/visibility_file.h"

namespace prt {

/// Pixels of the image: more than the grid's points where its last row is not full.
inline size_t gridPixels(const PointGrid& grid) { return size_t(grid.width) * size_t(grid.height); }
/// Contract: a size above 0, and as many points as fit.
void checkGrid(const PointGrid& grid);

/// Attributes "domain" and, per vertex, "vertexCount".
void setDomain(const PointGrid& grid, ExrAttributes& attributes);
/// @throws InputError  absent, unknown or not of the part's size
PointGrid readGrid(const ExrPartInfo& part, const std::string& path);

/// "V.00", "V.01", …
std::vector<std::string> indexedNames(const std::string& prefix, int count);
/// @throws InputError  one of them is not there
void checkChannels(const ExrPartInfo& part, const std::vector<std::string>& names, const std::string& path);

/// Values of [count×components], with zeros behind the last point where the grid is larger.
template <class Value>
class PaddedPoints {
  public:
    PaddedPoints(const std::vector<Value>& values, const PointGrid& grid, size_t components) {
        PRT_CHECK_EQ(values.size(), grid.count * components);
        data_ = values.data();
        if (grid.count == gridPixels(grid)) return;
        padded_ = values;
        padded_.resize(gridPixels(grid) * components);
        data_ = padded_.data();
    }
    const Value* data() const { return data_; }

  private:
    const Value* data_;
    std::vector<Value> padded_;
};

/// Channels over interleaved 4-byte values.
/// @param names  one per component
template <class Channel, class Pointer>
void addInterleaved(std::vector<Channel>& channels, const std::vector<std::string>& names, ExrType type,
                    Pointer data, int width, size_t stride) {
    for (size_t i = 0; i < names.size(); ++i)
        channels.push_back({names[i], type, data + i, stride * 4, size_t(width) * stride * 4});
}

}  // namespace prt
