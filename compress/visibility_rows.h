// Coefficients of visibility, some points at a time: from memory, or from files that do not fit into it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/visibility_file.h"
#include "precompute/math/vec.h"

namespace prt {

/// Consecutive points. What spans are empty hold for all points alike.
struct VisibilityTile {
    size_t first = 0;                   ///< index of the first point
    std::span<const float> rows;        ///< [P×n²]
    std::span<const Vec3f> normals;     ///< [P] geometric, unit; zero where there is none
    std::span<const uint8_t> use;       ///< [P] non-zero for points that count; empty = all
    std::span<const uint8_t> surface;   ///< [P] zero where there is no surface, only zeros; empty = all
    std::span<const float> rowWeights;  ///< [P] what a point counts; empty = all 1
};

/// Points that can be gone through any number of times.
class VisibilityRows {
  public:
    virtual ~VisibilityRows() = default;
    virtual int shOrder() const = 0;
    virtual size_t count() const = 0;
    /// Calls body with all points in order, whole rows of the grid at a time; spans live until it returns.
    /// @throws InputError  the file is damaged; Interrupted; what body throws
    virtual void forEachTile(const std::function<void(const VisibilityTile&)>& body) const = 0;
};

/// All points as one tile.
class VisibilityInMemory final : public VisibilityRows {
  public:
    /// @param all  spans must outlive this
    VisibilityInMemory(int shOrder, const VisibilityTile& all) : shOrder_(shOrder), all_(all) {}
    int shOrder() const override { return shOrder_; }
    size_t count() const override { return all_.normals.size(); }
    void forEachTile(const std::function<void(const VisibilityTile&)>& body) const override { body(all_); }

  private:
    int shOrder_;
    VisibilityTile all_;
};

/// What each point of rows firstRow … firstRow + rows − 1 of a grid counts.
using RowWeightSource = std::function<void(int firstRow, int rows, std::vector<float>& weights)>;

/// Points of visibility.exr, read anew on every pass. Those that are Valid count.
///
/// Memory: a tile of at least two chunks of the file (32 rows of the image), 4 MB of coefficients where rows
/// are short, and what OpenEXR holds of chunks; nothing that grows with the number of rows but 8 bytes per
/// chunk of the file.
class VisibilityOnDisk final : public VisibilityRows {
  public:
    /// @param weights  what points count; none: all the same
    /// @throws InputError  as VisibilityReader
    explicit VisibilityOnDisk(const std::string& path, RowWeightSource weights = {});

    /// Grid, order, projection and attributes.
    const VisibilityMap& header() const { return reader_->header(); }
    void setRowWeights(RowWeightSource weights) { weights_ = std::move(weights); }
    int shOrder() const override { return header().shOrder; }
    size_t count() const override { return header().grid.count; }
    void forEachTile(const std::function<void(const VisibilityTile&)>& body) const override;

  private:
    std::unique_ptr<VisibilityReader> reader_;
    RowWeightSource weights_;
};

}  // namespace prt
