// The curves and claims of [IwanickiSloan2012, Sec. 5].
#include "tools/measure/compression_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

// Above this ratio of the highest to the lowest error, results count as sensitive to the bands of the light.
constexpr double kSensitive = 1.5;

std::string techniqueOf(const CompressionRow& row) {
    return row.components > 0 ? fmt::format("pca{}", row.components) : fmt::format("unc{}", row.shOrder);
}

std::vector<int> ordersOf(const CompressionResult& result) {
    std::vector<int> orders;
    for (const CompressionOrder& order : result.orders) orders.push_back(order.shOrder);
    return orders;
}

// Two series for each order: vectors, and the one point without compression.
template <class X, class Y>
std::vector<Series> seriesOf(const CompressionResult& result, const X& x, const Y& y) {
    std::vector<Series> all;
    for (const int shOrder : ordersOf(result)) {
        Series curve{.name = fmt::format("order {}, vectors", shOrder), .points = {}},
            point{.name = fmt::format("order {}, uncompressed", shOrder), .points = {}};
        for (const CompressionRow& row : result.rows)
            if (row.shOrder == shOrder)
                (row.components > 0 ? curve : point).points.push_back({x(row), y(row)});
        all.push_back(std::move(curve));
        all.push_back(std::move(point));
    }
    return all;
}

double bytesOf(const CompressionRow& row) { return double(row.bytes); }
double fetchesOf(const CompressionRow& row) { return double(row.cost.fetches); }
double shippedOf(const CompressionRow& row) { return row.shipped; }
double truthOf(const CompressionRow& row) { return row.truth; }

Panel lightPanel(const CompressionResult& result) {
    Panel panel{.title = "By bands of the light",
                .xLabel = "bands of the light",
                .yLabel = "relative RMSE by compression",
                .logY = true};
    for (const LightOrderRow& row : result.lights) {
        if (row.components == shCount(row.shOrder)) continue;  // nothing but rounding
        const std::string name = fmt::format("order {}, {} vectors", row.shOrder, row.components);
        if (panel.series.empty() || panel.series.back().name != name) panel.series.push_back({name, {}});
        panel.series.back().points.push_back({double(row.lightOrder), row.compression});
    }
    return panel;
}

}  // namespace

Table compressionTable(const CompressionResult& result, const std::string& encoding, int tableSize) {
    Table table({"technique", "order", "components", "format", "bytes_per_point", "table_bytes", "fetches",
                 "multiply_adds", "coefficient_rmse", "compression_rmse", "shipped_rmse", "truth_rmse"});
    for (const CompressionRow& row : result.rows) {
        const bool isPca = row.components > 0;
        const int values = isPca ? row.components : shCount(row.shOrder);
        table.add({techniqueOf(row), uint64_t(row.shOrder), uint64_t(row.components),
                   isPca ? encoding : std::string("half"), uint64_t(row.bytes),
                   uint64_t(tableBytes(values, isPca, tableSize)), uint64_t(row.cost.fetches),
                   uint64_t(row.cost.multiplyAdds), row.coefficients, row.compression, row.shipped,
                   row.truth});
    }
    return table;
}

Table orderTable(const CompressionResult& result) {
    Table table({"order", "truncation_rmse", "uncompressed_rmse"});
    for (const CompressionOrder& order : result.orders)
        table.add({uint64_t(order.shOrder), order.truncation, order.uncompressed});
    return table;
}

Table claimTable(const CompressionResult& result) {
    Table table({"order", "components", "compression_rmse", "truncation_rmse", "truth_rmse",
                 "uncompressed_rmse", "enough", "faithful", "least_enough", "least_faithful"});
    const auto word = [](bool is) { return std::string(is ? "yes" : "no"); };
    const auto count = [](int components) {
        return components > 0 ? double(components) : std::numeric_limits<double>::quiet_NaN();
    };
    for (const CompressionClaim& claim : checkClaims(result))
        table.add({uint64_t(claim.shOrder), uint64_t(claim.components), claim.compression, claim.truncation,
                   claim.truth, claim.uncompressed, word(claim.isEnough), word(claim.isFaithful),
                   count(claim.leastEnough), count(claim.leastFaithful)});
    return table;
}

Table lightTable(const CompressionResult& result) {
    Table table({"order", "components", "light_order", "compression_rmse"});
    for (const LightOrderRow& row : result.lights)
        table.add(
            {uint64_t(row.shOrder), uint64_t(row.components), uint64_t(row.lightOrder), row.compression});
    return table;
}

Table sensitivityTable(const CompressionResult& result) {
    Table table({"order", "components", "lowest_rmse", "highest_rmse", "ratio", "ratio_seen"});
    for (const LightSensitivity& row : lightSensitivity(result))
        if (row.components < shCount(row.shOrder))
            table.add({uint64_t(row.shOrder), uint64_t(row.components), row.lowest, row.highest,
                       row.highest / row.lowest, row.highestSeen / row.lowestSeen});
    return table;
}

Table storageTable(const CompressionResult& result, const std::string& encoding) {
    Table table({"order", "method", "values", "format", "bytes_per_point"});
    for (const int shOrder : ordersOf(result)) {
        for (const CompressionRow& row : result.rows)
            if (row.shOrder == shOrder)
                table.add({uint64_t(shOrder), techniqueOf(row),
                           uint64_t(row.components > 0 ? row.components : shCount(shOrder)),
                           row.components > 0 ? encoding : std::string("half"), uint64_t(row.bytes)});
        for (const TransferStorage& transfer : transferStorage(shOrder))
            table.add({uint64_t(shOrder), "transfer-" + transfer.method, uint64_t(transfer.values),
                       std::string("half"), uint64_t(transfer.bytes)});
    }
    return table;
}

Table frameTable(const std::vector<FrameTime>& times) {
    Table table({"technique", "order", "components", "frame_ms", "ratio"});
    for (const FrameTime& row : times)
        table.add(
            {row.components > 0 ? fmt::format("pca{}", row.components) : fmt::format("unc{}", row.shOrder),
             uint64_t(row.shOrder), uint64_t(row.components), row.milliseconds, row.ratio});
    return table;
}

Table pictureTable(const std::vector<PictureRow>& pictures) {
    Table table({"figure", "picture", "against", "relative_rmse", "file", "difference_file"});
    for (const PictureRow& row : pictures)
        table.add({row.figure, row.picture, row.against,
                   row.differenceFile.empty() ? std::numeric_limits<double>::quiet_NaN() : row.relativeRmse,
                   row.file, row.differenceFile});
    return table;
}

std::string verdictText(const CompressionResult& result) {
    std::string text;
    const auto least = [](int components) {
        return components > 0 ? fmt::format("{}", components) : std::string("none");
    };
    for (const CompressionClaim& claim : checkClaims(result))
        text += fmt::format(
            "{} vectors for order {}: {}; compression changes irradiance by {:.4f}, truncation to that order "
            "by {:.4f}; against ray-traced truth {:.4f}, uncompressed {:.4f}: {}. Fewest measured that are "
            "enough: {}; within a tenth of uncompressed: {}\n",
            claim.components, claim.shOrder, claim.isEnough ? "enough" : "not enough", claim.compression,
            claim.truncation, claim.truth, claim.uncompressed,
            claim.isFaithful ? "within a tenth" : "more than a tenth above", least(claim.leastEnough),
            least(claim.leastFaithful));
    for (const LightSensitivity& row : lightSensitivity(result)) {
        if (row.components == shCount(row.shOrder)) continue;
        const double ratio = row.highest / row.lowest;
        text += fmt::format("Order {}, {} vectors, by bands of the light: {:.4f} to {:.4f}, {} (ratio {:.2f}",
                            row.shOrder, row.components, row.lowest, row.highest,
                            ratio > kSensitive ? "sensitive" : "not sensitive", ratio);
        const double seen = row.highestSeen / row.lowestSeen;
        text += std::isfinite(seen) ? fmt::format("; from {} bands on {:.2f})\n", row.shOrder + 2, seen)
                                    : std::string(")\n");
    }
    return text;
}

Figure compressionFigure(const CompressionResult& result) {
    Figure figure{.title = "Compression of visibility", .columns = 2, .panels = {}};
    const char* const error = "relative RMSE of irradiance";
    const char* const bytes = "bytes of a point";
    figure.panels.push_back({.title = "Against uncompressed visibility of the order",
                             .xLabel = bytes,
                             .yLabel = error,
                             .logX = true,
                             .logY = true,
                             .series = seriesOf(result, bytesOf, shippedOf)});
    figure.panels.push_back({.title = "Against ray-traced truth",
                             .xLabel = bytes,
                             .yLabel = error,
                             .logX = true,
                             .series = seriesOf(result, bytesOf, truthOf)});
    figure.panels.push_back({.title = "Work of a pixel",
                             .xLabel = bytes,
                             .yLabel = "texture fetches",
                             .logX = true,
                             .series = seriesOf(result, bytesOf, fetchesOf)});
    figure.panels.push_back({.title = "Error for work",
                             .xLabel = "texture fetches",
                             .yLabel = error,
                             .series = seriesOf(result, fetchesOf, truthOf)});
    figure.panels.push_back(lightPanel(result));
    Panel bars{.title = "Storage beside transfer matrices", .yLabel = "bytes of a point", .logY = true};
    int group = 0;
    for (const int shOrder : ordersOf(result)) {
        for (const CompressionRow& row : result.rows)
            if (row.shOrder == shOrder && row.components < shCount(shOrder))
                bars.bars.push_back(
                    {fmt::format("{}: {}", shOrder, techniqueOf(row)), double(row.bytes), group});
        for (const TransferStorage& transfer : transferStorage(shOrder))
            bars.bars.push_back(
                {fmt::format("{}: {}", shOrder, transfer.method), double(transfer.bytes), group});
        ++group;
    }
    figure.panels.push_back(std::move(bars));
    return figure;
}

}  // namespace prt::tools
