// Visibility by ray casting and its projection [IwanickiSloan2012, Sec. 3], plain or by least squares of what
// irradiance sees; directions from [Keinert2015];
// Morton order [Morton1966].
#include "precompute/visibility/trace_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/accumulate.h"

namespace prt {
namespace {

constexpr size_t kBlock = 256;  // items that take one direction at a time
constexpr size_t kChunk = 512;  // directions between two projections
// A row of the lists of visible directions; not a power of two, so that rows do not share cache sets.
constexpr size_t kListStride = kChunk + 32;

constexpr int kInsideDirections = 128;   // over the sphere; half of them lie above the horizon
constexpr float kInsideAoLimit = 0.35f;  // more open points are not examined: an inside point is nearly dark

// The directions, and their basis functions as a table of padded rows.
struct DirectionTable {
    std::vector<Vec3f> directions;
    std::vector<float> x, y, z;
    std::vector<float> basis;  // [N × stride]
    size_t stride = 0;

    DirectionTable(int rays, int shOrder) : directions(sphericalFibonacci(rays)) {
        const size_t columns = size_t(shCount(shOrder));
        stride = paddedColumns(columns);
        for (const Vec3f& direction : directions) {
            x.push_back(direction.x());
            y.push_back(direction.y());
            z.push_back(direction.z());
        }
        basis.assign(directions.size() * stride, 0.0f);
        for (size_t k = 0; k < directions.size(); ++k)
            evalSh(shOrder, directions[k], std::span(&basis[k * stride], columns));
    }
};

// What projection weighted for irradiance needs; nothing where projection is plain.
struct Weighting {
    CosineTable weight;
    IrradianceProjection projection;

    Weighting(int shOrder, const IrradianceWeight& parameters)
        : weight(irradianceWeightTable(parameters)), projection(shOrder, parameters) {}
};

uint32_t hash32(uint32_t x) {  // finaliser of MurmurHash3
    x ^= x >> 16;
    x *= 0x85ebca6bu;
    x ^= x >> 13;
    x *= 0xc2b2ae35u;
    return x ^ (x >> 16);
}

// Cone around the normals of a block.
struct NormalCone {
    Vec3f axis = Vec3f::Zero();
    float sinAngle = 1;
    // False only if no normal of the block has the direction above its horizon.
    bool mayFace(const Vec3f& direction) const { return axis.dot(direction) > -sinAngle - 1e-4f; }
};

// Everything one thread needs while it traces a block.
class BlockTracer {
  public:
    BlockTracer(const RayCaster& caster, const BakeItems& items, const DirectionTable& table,
                const Weighting* weighting)
        : caster_(caster),
          items_(items),
          table_(table),
          weighting_(weighting),
          lists_(kBlock * kListStride),
          sums_(kBlock * table.stride) {}

    /// Traces the items named by `block`. @return rays
    uint64_t trace(std::span<const uint32_t> block) {
        begin(block);
        uint64_t rays = 0;
        for (size_t start = 0; start < table_.directions.size(); start += kChunk) {
            throwIfInterrupted();
            const size_t end = std::min(start + kChunk, table_.directions.size());
            listCounts_.fill(0);
            for (size_t k = start; k < end; ++k)
                if (cone_.mayFace(table_.directions[k])) rays += traceDirection(k, uint16_t(k - start));
            for (size_t i = 0; i < block.size(); ++i) project(i, start);
        }
        return rays;
    }
    /// @param out  [n²] the expansion of item i of the block
    void expansion(size_t i, std::span<float> out) const {
        const float sampleSr = float(4 * std::numbers::pi / double(table_.directions.size()));
        for (size_t c = 0; c < out.size(); ++c) out[c] = sums_[i * table_.stride + c] * sampleSr;
        const Vec3f normal = itemNormal(i);
        if (weighting_ && normal != Vec3f::Zero())
            weighting_->projection.solve(normal, out, openness(i) * float(std::numbers::pi), out);
    }
    float ao(size_t i) const { return openSum_[i] > 0 ? seenSum_[i] / openSum_[i] : 0.0f; }

  private:
    bool isSinglePoint(size_t i) const {
        const uint32_t item = block_[i];
        return items_.firstPoint.empty() || items_.firstPoint[item + 1] == items_.firstPoint[item] + 1;
    }
    // Zero where the item has no points.
    Vec3f itemNormal(size_t i) const {
        const uint32_t item = block_[i];
        if (!items_.firstPoint.empty() && items_.firstPoint[item + 1] == items_.firstPoint[item])
            return Vec3f::Zero();
        return items_.normals.empty() ? items_.points[item].normal : items_.normals[item];
    }
    // What is seen of the cosine about the item's normal, 1 where nothing blocks it: the ambient occlusion,
    // but for parts of other normals.
    float openness(size_t i) const {
        const Vec3f normal = itemNormal(i);
        if (isSinglePoint(i) && selectedNormal(i) == normal) return ao(i);
        float open = 0;
        for (const Vec3f& direction : table_.directions) open += std::max(0.0f, normal.dot(direction));
        return open > 0 ? seenAboutNormal_[i] / open : 0.0f;
    }
    Vec3f selectedNormal(size_t i) const { return {normalX_[i], normalY_[i], normalZ_[i]}; }

    // Adds the visible directions of the chunk that starts at direction `start`.
    void project(size_t i, size_t start) {
        const float* basis = &table_.basis[start * table_.stride];
        const uint16_t* rows = &lists_[i * kListStride];
        float* sum = &sums_[i * table_.stride];
        if (!weighting_) {
            addTableRows(basis, table_.stride, rows, listCounts_[i], sum);
            return;
        }
        const Vec3f normal = itemNormal(i);
        weighRows({&table_.x[start], &table_.y[start], &table_.z[start]},
                  std::min(kChunk, table_.directions.size() - start), normal.data(), weighting_->weight, rows,
                  listCounts_[i], cosines_.data(), weights_.data());
        addWeightedTableRows(basis, table_.stride, rows, weights_.data(), listCounts_[i], sum);
        if (isSinglePoint(i) && selectedNormal(i) == normal) return;
        for (size_t j = 0; j < listCounts_[i]; ++j) seenAboutNormal_[i] += std::max(0.0f, cosines_[rows[j]]);
    }

    void select(size_t i, uint32_t point) {
        const SurfacePoint& p = items_.points[point];
        normalX_[i] = p.normal.x();
        normalY_[i] = p.normal.y();
        normalZ_[i] = p.normal.z();
        origin_[i] = offset_[point - firstOffset_[i] + offsetStart_[i]];
    }

    void begin(std::span<const uint32_t> block) {
        block_ = block;
        std::fill(sums_.begin(), sums_.end(), 0.0f);
        seenSum_.fill(0);
        openSum_.fill(0);
        seenAboutNormal_.fill(0);
        offset_.clear();
        many_.clear();
        Vec3f axis = Vec3f::Zero();
        for (size_t i = 0; i < block.size(); ++i) {
            const uint32_t item = block[i];
            const uint32_t first = items_.firstPoint.empty() ? item : items_.firstPoint[item];
            const uint32_t last = items_.firstPoint.empty() ? item + 1 : items_.firstPoint[item + 1];
            firstOffset_[i] = first;
            offsetStart_[i] = uint32_t(offset_.size());
            for (uint32_t p = first; p < last; ++p) {
                const SurfacePoint& point = items_.points[p];
                offset_.push_back(caster_.offsetOrigin(point.position, point.normal));
                axis += point.normal;
            }
            if (last > first + 1) many_.push_back(uint32_t(i));
            if (last > first)
                select(i, first);
            else
                normalX_[i] = normalY_[i] = normalZ_[i] = 0;  // faces no direction
        }
        setCone(axis);
    }

    void setCone(Vec3f axis) {
        cone_ = {};
        if (!(axis.norm() > 1e-3f)) return;
        axis.normalize();
        float smallest = 1;
        for (size_t i = 0; i < block_.size(); ++i) {
            const uint32_t count =
                uint32_t((i + 1 < block_.size() ? offsetStart_[i + 1] : offset_.size()) - offsetStart_[i]);
            for (uint32_t p = firstOffset_[i]; p < firstOffset_[i] + count; ++p)
                smallest = std::min(smallest, axis.dot(items_.points[p].normal));
        }
        cone_.axis = axis;
        cone_.sinAngle = smallest > 0 ? std::sqrt(std::max(0.0f, 1 - smallest * smallest)) : 2.0f;
    }

    uint64_t traceDirection(size_t k, uint16_t kInChunk) {
        const Vec3f direction = table_.directions[k];
        for (const uint32_t i : many_) select(i, subPointOfDirection(items_, block_[i], uint32_t(k)));
        std::array<float, kBlock> cosine;
        for (size_t i = 0; i < block_.size(); ++i)
            cosine[i] =
                normalX_[i] * direction.x() + normalY_[i] * direction.y() + normalZ_[i] * direction.z();
        size_t count = 0;
        for (size_t i = 0; i < block_.size(); ++i) {
            facing_[count] = uint16_t(i);
            count += cosine[i] > 0;
        }
        for (size_t j = 0; j < count; ++j) rayOrigin_[j] = origin_[facing_[j]];
        caster_.occluded(std::span(rayOrigin_.data(), count), direction, std::span(blocked_.data(), count));
        for (size_t j = 0; j < count; ++j) {
            const size_t i = facing_[j];
            const bool visible = !blocked_[j];
            openSum_[i] += cosine[i];
            seenSum_[i] += visible ? cosine[i] : 0.0f;
            lists_[i * kListStride + listCounts_[i]] = kInChunk;
            listCounts_[i] = uint16_t(listCounts_[i] + visible);
        }
        return count;
    }

    const RayCaster& caster_;
    const BakeItems& items_;
    const DirectionTable& table_;
    const Weighting* weighting_;
    std::span<const uint32_t> block_;
    NormalCone cone_;
    std::vector<Vec3f> offset_;    // ray origins of all sub-points of the block
    std::vector<uint32_t> many_;   // places in the block with more than one sub-point
    std::vector<uint16_t> lists_;  // [kBlock × kListStride] visible directions of the chunk
    std::vector<float> sums_;      // [kBlock × stride]
    std::array<uint32_t, kBlock> firstOffset_{}, offsetStart_{};
    std::array<float, kBlock> normalX_{}, normalY_{}, normalZ_{}, seenSum_{}, openSum_{};
    std::array<float, kBlock> seenAboutNormal_{};  // of items of several normals
    std::array<float, kChunk> cosines_, weights_;  // of one item's directions, and of the visible
    std::array<Vec3f, kBlock> origin_, rayOrigin_;
    std::array<uint16_t, kBlock> facing_{}, listCounts_{};
    std::array<uint8_t, kBlock> blocked_{};
};

// Inside: at least a quarter of the rays hit something, and most of those meet its back.
bool looksInside(const RayCaster& caster, const BakeItems& items, uint32_t item,
                 std::span<const Vec3f> directions, std::span<const uint8_t> doubleSided) {
    int rays = 0, hits = 0, backs = 0;
    for (size_t k = 0; k < directions.size(); ++k) {
        const SurfacePoint& point = items.points[subPointOfDirection(items, item, uint32_t(k))];
        if (!(point.normal.dot(directions[k]) > 0)) continue;
        ++rays;
        const RayHit hit = caster.firstHit(caster.offsetOrigin(point.position, point.normal), directions[k]);
        if (hit.triangle == RayHit{}.triangle) continue;
        ++hits;
        backs += hit.backFace && (doubleSided.empty() || !doubleSided[hit.triangle]);
    }
    return backs * 2 > hits && hits * 4 >= rays;
}

void findInside(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                BakeResult& result) {
    const std::vector<Vec3f> directions = sphericalFibonacci(kInsideDirections);
    std::atomic<size_t> insideCount{0};
    parallelFor(items.count(), 64, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            if (result.ao[i] >= kInsideAoLimit) continue;
            if (!items.firstPoint.empty() && items.firstPoint[i] == items.firstPoint[i + 1]) continue;
            result.inside[i] = looksInside(caster, items, uint32_t(i), directions, options.doubleSided);
            insideCount += result.inside[i];
        }
    });
    if (insideCount * 2 <= items.count()) return;
    result.windingSuspect = true;
    std::fill(result.inside.begin(), result.inside.end(), uint8_t(0));
    logWarning(fmt::format(
        "{} of {} points see mostly back faces: the mesh is wound inside out or inconsistently, and "
        "points inside geometry are not looked for; turn its faces outwards",
        insideCount.load(), items.count()));
}

// Spreads the low 21 bits to every third bit.
uint64_t spreadBits(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

}  // namespace

std::vector<uint32_t> mortonOrder(std::span<const Vec3f> positions) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3d low(kInfinity, kInfinity, kInfinity), high = -low;
    for (const Vec3f& p : positions) {
        low = low.cwiseMin(p.cast<double>());
        high = high.cwiseMax(p.cast<double>());
    }
    const double edge = positions.empty() ? 0 : (high - low).maxCoeff();
    const double scale = edge > 0 ? 2097151.0 / edge : 0;
    std::vector<std::pair<uint64_t, uint32_t>> keys(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        const Vec3d q = (positions[i].cast<double>() - low) * scale;
        keys[i] = {
            spreadBits(uint64_t(q.x())) << 2 | spreadBits(uint64_t(q.y())) << 1 | spreadBits(uint64_t(q.z())),
            uint32_t(i)};
    }
    std::sort(keys.begin(), keys.end());
    std::vector<uint32_t> order(positions.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = keys[i].second;
    return order;
}

uint32_t subPointOfDirection(const BakeItems& items, uint32_t item, uint32_t direction) {
    if (items.firstPoint.empty()) return item;
    const uint32_t last = items.firstPoint[item + 1] - 1;
    uint32_t point = items.firstPoint[item];
    if (point == last) return point;
    const uint32_t deal = direction * 0x6a09e667u + hash32(item);  // frac(√2)·2^32
    while (point < last && deal >= items.shareEnd[point]) ++point;
    return point;
}

BakeResult bakeItems(const RayCaster& caster, const BakeItems& items, const BakeOptions& options,
                     const char* unit) {
    if (options.shOrder < 1 || options.shOrder > kMaxBundleShOrder)
        throw UsageError("order", fmt::format("{} is out of range", options.shOrder),
                         fmt::format("choose 1 to {}", kMaxBundleShOrder));
    if (options.rays < 1 || options.rays > kMaxBakeRays)
        throw UsageError("rays", fmt::format("{} is out of range", options.rays),
                         fmt::format("choose 1 to {}", kMaxBakeRays));
    PRT_CHECK(items.normals.empty() || items.normals.size() == items.count());
    PRT_CHECK(items.firstPoint.empty() || !items.normals.empty() ||
              options.projection.kind == ProjectionKind::Plain);
    PRT_CHECK(options.doubleSided.empty() || options.doubleSided.size() == caster.triangleCount());

    const size_t count = items.count(), columns = size_t(shCount(options.shOrder));
    BakeResult result;
    result.coefficients.assign(count * columns, 0.0f);
    result.ao.assign(count, 0.0f);
    result.inside.assign(count, 0);

    const Stopwatch watch;
    const DirectionTable table(options.rays, options.shOrder);
    std::optional<Weighting> weighting;
    if (options.projection.kind == ProjectionKind::Irradiance)
        weighting.emplace(options.shOrder, options.projection.weight);
    std::vector<Vec3f> positions(count, Vec3f::Zero());
    for (size_t i = 0; i < count; ++i) {
        const size_t point = items.firstPoint.empty() ? i : items.firstPoint[i];
        if (point < items.points.size()) positions[i] = items.points[point].position;
    }
    const std::vector<uint32_t> order = mortonOrder(positions);
    std::atomic<uint64_t> rays{0};
    Progress progress("tracing", count, unit);
    parallelFor(count, kBlock, [&](size_t begin, size_t end) {
        const std::span block(&order[begin], end - begin);
        const auto tracer =
            std::make_unique<BlockTracer>(caster, items, table, weighting ? &*weighting : nullptr);
        rays += tracer->trace(block);
        for (size_t i = 0; i < block.size(); ++i) {
            tracer->expansion(i, {&result.coefficients[size_t(block[i]) * columns], columns});
            result.ao[block[i]] = tracer->ao(i);
        }
        progress.advance(block.size());
    });
    if (options.findInside) findInside(caster, items, options, result);
    result.rays = rays;
    result.traceSeconds = watch.seconds();
    return result;
}

}  // namespace prt
