// Basis functions as surfaces over the directions, as in [HabelWimmer2010, Fig. 2] and [Gautron2004, Fig.
// 10].
#include "tools/measure/basis_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

using std::numbers::pi;

constexpr int kRows = 41, kColumns = 81;

/// Values of all functions on a grid of directions, pole to rim (or other pole).
struct FunctionGrid {
    std::vector<Vec3d> directions;            ///< [kRows×kColumns]
    std::vector<std::vector<double>> values;  ///< [functions] of the same
};

FunctionGrid sampleFunctions(const Basis& basis) {
    FunctionGrid grid;
    grid.values.resize(size_t(basis.count()));
    const double span = basis.domain() == BasisDomain::Sphere ? pi : pi / 2;
    std::vector<double> at(size_t(basis.count()));
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const double theta = span * row / (kRows - 1), phi = 2 * pi * column / (kColumns - 1);
            Vec3d direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                            std::cos(theta));
            if (span < pi) direction.z() = std::max(0.0, direction.z());
            basis.eval(direction, at);
            grid.directions.push_back(direction);
            for (size_t i = 0; i < at.size(); ++i) grid.values[i].push_back(at[i]);
        }
    return grid;
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

}  // namespace

std::vector<FunctionLabel> functionLabels(const Basis& basis) {
    std::vector<FunctionLabel> labels;
    if (basis.name() == "h") {
        labels = {{"H1", 0, 0}, {"H2", 1, -1}, {"H3", 1, 0}, {"H4", 1, 1}, {"H5", 2, -2}, {"H6", 2, 2}};
        labels.resize(size_t(basis.count()));
        return labels;
    }
    if (basis.name() == "hl2") return {{"h1", 0, -1}, {"h2", 0, 0}, {"h3", 0, 1}};
    const bool everySecond = basis.name() == "zernike" || basis.name() == "esh";
    for (int band = 0; band < basis.order(); ++band)
        for (int m = -band; m <= band; m += everySecond ? 2 : 1)
            labels.push_back(
                {fmt::format("{} = {}, m = {}", basis.name() == "zernike" ? 'n' : 'l', band, m), band, m});
    PRT_CHECK_EQ(labels.size(), size_t(basis.count()));
    return labels;
}

Figure basisFigure(const Basis& basis, const std::string& title) {
    const std::vector<FunctionLabel> labels = functionLabels(basis);
    const FunctionGrid grid = sampleFunctions(basis);
    int widest = 0, bands = 0;
    for (size_t i = 0; i < labels.size(); ++i) {
        widest = std::max(widest, std::abs(labels[i].m));
        bands = std::max(bands, labels[i].band + 1);
    }
    Figure figure{
        .title = title, .columns = 2 * widest + 1, .panels = {}, .panelWidthPx = 230, .panelHeightPx = 220};
    figure.panels.resize(size_t(bands * figure.columns));
    for (size_t i = 0; i < labels.size(); ++i) {
        Panel& panel = figure.panels[size_t(labels[i].band * figure.columns + labels[i].m + widest)];
        panel.title = labels[i].title;
        const double scale = largest(grid.values[i]);
        panel.surface = {kRows, kColumns, {}};
        for (size_t k = 0; k < grid.directions.size(); ++k) {
            const double value = grid.values[i][k] / scale;
            const Vec3d point = std::abs(value) * grid.directions[k];
            panel.surface.points.push_back({point.x(), point.y(), point.z(), value});
        }
    }
    return figure;
}

Table functionTable() {
    return Table({"signal", "basis", "order", "coefficients", "function", "band", "m", "lowest", "highest"});
}

void addFunctionRows(const Basis& basis, Table& table) {
    const std::vector<FunctionLabel> labels = functionLabels(basis);
    const FunctionGrid grid = sampleFunctions(basis);
    for (size_t i = 0; i < labels.size(); ++i) {
        const auto [low, high] = std::minmax_element(grid.values[i].begin(), grid.values[i].end());
        table.add({std::string("functions"), basis.name(), uint64_t(basis.order()), uint64_t(basis.count()),
                   uint64_t(i), uint64_t(labels[i].band), double(labels[i].m), *low, *high});
    }
}

}  // namespace prt::tools
