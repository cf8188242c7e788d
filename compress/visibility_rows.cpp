// Tiles of visibility.exr: bands of the image, sized by what compressed files decode at once.
#include "compress/visibility_rows.h"

#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/log.h"
#include "precompute/io/exr_file.h"

namespace prt {
namespace {

constexpr size_t kTileBytes = size_t(4) << 20;

// Whole chunks; two at least, so that two threads can decode. Not a matter of how many threads there are:
// sums are the same for any number.
int tileRows(const VisibilityMap& header) {
    const size_t chunkBytes = size_t(kExrChunkRows) * size_t(header.grid.width) *
                              size_t(header.shOrder * header.shOrder) * sizeof(float);
    return kExrChunkRows * int(std::max<size_t>(2, kTileBytes / chunkBytes));
}

}  // namespace

VisibilityOnDisk::VisibilityOnDisk(const std::string& path, RowWeightSource weights)
    : reader_(std::make_unique<VisibilityReader>(path)), weights_(std::move(weights)) {}

void VisibilityOnDisk::forEachTile(const std::function<void(const VisibilityTile&)>& body) const {
    const int height = header().grid.height, step = tileRows(header());
    VisibilityRowBlock block;
    Progress progress("compressing", uint64_t(height), "rows");
    std::vector<uint8_t> use, surface;
    std::vector<float> rowWeights;
    for (int row = 0; row < height; row += step) {
        const int rows = std::min(step, height - row);
        reader_->read(row, rows, block);
        const size_t points = block.validity.size();
        use.resize(points);
        surface.resize(points);
        for (size_t i = 0; i < points; ++i) {
            use[i] = block.validity[i] == Validity::Valid;
            surface[i] = block.validity[i] != Validity::Empty;
        }
        if (weights_) {
            weights_(row, rows, rowWeights);
            PRT_CHECK_LE(points, rowWeights.size());
        }
        body({block.first, block.coefficients, block.normals, use, surface,
              weights_ ? std::span<const float>(rowWeights).first(points) : std::span<const float>()});
        progress.advance(uint64_t(rows));
    }
}

}  // namespace prt
