// Results of `prt measure basis` as tables and as figures like [HabelWimmer2010, Fig. 3] and [Gautron2004,
// Figs. 4 and 5].
#include "tools/measure/basis_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "precompute/base/check.h"

namespace prt::tools {
namespace {

Table irradianceRows(const IrradianceComparison& comparison, std::span<const IrradianceResult> results) {
    Table table({"signal", "radiance", "basis", "order", "coefficients", "projection", "signals", "imse",
                 "relative_rmse"});
    for (const IrradianceResult& result : results)
        for (size_t i = 0; i < comparison.candidates().size(); ++i) {
            const IrradianceCandidate& candidate = comparison.candidates()[i];
            const IrradianceErrors& errors = result.errors;
            const auto add = [&](const char* projection, double sum) {
                table.add({result.signal, std::string(radianceName(result.model)), candidate.basis,
                           uint64_t(candidate.order), uint64_t(candidate.coefficients),
                           std::string(projection), uint64_t(errors.signals), sum / double(errors.signals),
                           std::sqrt(std::max(0.0, sum) / errors.energy)});
            };
            add("direct", errors.direct[i]);
            add("sh9", errors.viaSh9[i]);
        }
    return table;
}

/// The comparisons the paper draws, direct projection.
Table ratioRows(const IrradianceComparison& comparison, std::span<const IrradianceResult> results) {
    Table table({"signal", "radiance", "h6_rmse_to_zernike6", "h6_rmse_to_esh6", "h6_rmse_to_hsh9",
                 "h6_rmse_to_makhotkin9", "sh9_rmse_to_h6", "lsosh4_imse_to_h4", "sh4_imse_to_h4",
                 "zernike3_imse_to_hl2"});
    for (const IrradianceResult& result : results) {
        const auto imse = [&](const char* a, int countA, const char* b, int countB) {
            return result.errors.direct[comparison.find(a, countA)] /
                   result.errors.direct[comparison.find(b, countB)];
        };
        table.add({result.signal, std::string(radianceName(result.model)),
                   std::sqrt(imse("h", 6, "zernike", 6)), std::sqrt(imse("h", 6, "esh", 6)),
                   std::sqrt(imse("h", 6, "hsh", 9)), std::sqrt(imse("h", 6, "makhotkin", 9)),
                   std::sqrt(std::max(0.0, imse("sh", 9, "h", 6))), imse("lsosh", 4, "h", 4),
                   imse("sh", 4, "h", 4), imse("zernike", 3, "hl2", 3)});
    }
    return table;
}

Table costRows(std::span<const EvaluationCost> costs) {
    Table table({"basis", "order", "coefficients", "ns_per_evaluation", "additions", "multiplications",
                 "divisions", "square_roots"});
    for (const EvaluationCost& cost : costs)
        table.add({cost.basis, uint64_t(cost.order), uint64_t(cost.coefficients), cost.ns,
                   uint64_t(cost.additions), uint64_t(cost.multiplications), uint64_t(cost.divisions),
                   uint64_t(cost.squareRoots)});
    return table;
}

Panel irradiancePanel(const IrradianceComparison& comparison, const IrradianceResult& result, bool direct) {
    Panel panel{.title = fmt::format("{}, radiance {}, {}", result.signal,
                                     result.model == RadianceModel::AboveSurface ? "above the surface"
                                                                                 : "from the whole sphere",
                                     direct ? "projected directly" : "by way of SH-9"),
                .yLabel = "mean IMSE",
                .logY = true};
    // groups by number of coefficients, in the order of the candidates
    std::map<int, int> groups;
    for (const IrradianceCandidate& c : comparison.candidates()) groups.emplace(c.coefficients, 0);
    int group = 0;
    for (auto& [coefficients, index] : groups) index = group++;
    for (size_t i = 0; i < comparison.candidates().size(); ++i) {
        const IrradianceCandidate& c = comparison.candidates()[i];
        const std::string name = c.basis == "h" ? c.title : fmt::format("{} {}", c.title, c.coefficients);
        panel.bars.push_back({name, direct ? result.errors.imseDirect(i) : result.errors.imseViaSh9(i),
                              groups[c.coefficients]});
    }
    return panel;
}

/// What the terminal shows: errors of the figure's signals beside the cost.
std::string irradianceSummary(const IrradianceComparison& comparison, std::span<const IrradianceResult> shown,
                              std::span<const EvaluationCost> costs, const Table& ratios) {
    std::vector<std::string> columns = {"basis", "coefficients"};
    for (const IrradianceResult& result : shown)
        for (const char* projection : {"direct", "sh9"})
            columns.push_back(fmt::format("{}:{}:{}", result.signal, radianceName(result.model), projection));
    for (const char* name : {"ns", "add", "mul", "div", "sqrt"}) columns.emplace_back(name);
    Table table(columns);
    for (size_t i = 0; i < comparison.candidates().size(); ++i) {
        const IrradianceCandidate& c = comparison.candidates()[i];
        std::vector<Cell> cells = {c.title, uint64_t(c.coefficients)};
        for (const IrradianceResult& result : shown) {
            cells.emplace_back(result.errors.imseDirect(i));
            cells.emplace_back(result.errors.imseViaSh9(i));
        }
        // the functions of lsosh are those of sh
        const std::string evaluated = c.basis == "lsosh" ? "sh" : c.basis;
        const auto cost = std::find_if(costs.begin(), costs.end(), [&](const EvaluationCost& e) {
            return e.basis == evaluated && e.order == c.order;
        });
        PRT_CHECK(cost != costs.end());
        cells.emplace_back(cost->ns);
        for (const int count : {cost->additions, cost->multiplications, cost->divisions, cost->squareRoots})
            cells.emplace_back(uint64_t(count));
        table.add(std::move(cells));
    }
    return fmt::format(
        "Mean IMSE by signal, radiance and projection, and cost of one evaluation\n{}\n"
        "Ratios, direct projection\n{}",
        table.text(), ratios.text());
}

/// One curve per basis; esh twice, by the functions that are not zero and by the n² that its paper stores.
std::vector<Series> lobeSeries(const LobeResult& result, size_t lobe, bool error) {
    struct Curve {
        const char *basis, *title;
        bool stored;
    };
    constexpr Curve kCurves[] = {{"hsh", "HSH", false},
                                 {"sh", "SH", false},
                                 {"esh", "ESH (non-zero)", false},
                                 {"zernike", "Zernike", false},
                                 {"makhotkin", "Makhotkin", false},
                                 {"lsosh", "LSOSH", false},
                                 {"esh", "ESH (all n²)", true}};
    std::vector<Series> series;
    for (const Curve& curve : kCurves) {
        Series points{.name = curve.title, .points = {}, .dashed = curve.stored};
        for (const LobeAccuracy& row : result.accuracies)
            if (row.lobe == lobe && row.basis == curve.basis)
                points.points.push_back({double(curve.stored ? row.stored : row.coefficients),
                                         error ? 1 - row.accuracy : row.accuracy});
        series.push_back(std::move(points));
    }
    return series;
}

Figure lobeFigure(const LobeResult& result, bool error) {
    Figure figure{.title = fmt::format("{} ({}): {} by number of coefficients", result.signal, result.variant,
                                       error ? "energy missed" : "accuracy"),
                  .columns = result.lobes.size() % 4 == 0 ? 4 : 3,
                  .panels = {},
                  .panelWidthPx = 440,
                  .panelHeightPx = 420};
    double most = 0;
    for (const LobeAccuracy& row : result.accuracies) most = std::max(most, double(row.coefficients));
    for (size_t lobe = 0; lobe < result.lobes.size(); ++lobe) {
        const Lobe& shown = result.lobes[lobe];
        Panel panel{.title = result.signal == "phong"
                                 ? fmt::format("lobe tilted by {:g}°", shown.thetaDeg)
                                 : fmt::format("outgoing θ {:g}°, φ {:g}°", shown.thetaDeg, shown.phiDeg),
                    .xLabel = "coefficients",
                    .yLabel = error ? "1 − accuracy" : "accuracy",
                    .logY = error};
        panel.series = lobeSeries(result, lobe, error);
        for (Series& series : panel.series)
            std::erase_if(series.points,
                          [&](const auto& point) { return point[0] > most || (error && point[1] < 1e-6); });
        figure.panels.push_back(std::move(panel));
    }
    return figure;
}

std::string lobeSummary(std::span<const LobeResult> results) {
    std::string text;
    for (const LobeResult& result : results) {
        // accuracy by basis at the counts of whole bands
        Table table({"lobe", "basis", "1", "4", "9", "16", "25", "36", "64", "100"});
        for (size_t lobe = 0; lobe < result.lobes.size(); ++lobe)
            for (const char* basis : {"hsh", "sh", "esh", "zernike", "makhotkin", "lsosh"}) {
                std::vector<Cell> cells = {result.lobes[lobe].name, std::string(basis)};
                for (const int budget : {1, 4, 9, 16, 25, 36, 64, 100}) {
                    // the largest order that fits
                    const LobeAccuracy* best = nullptr;
                    for (const LobeAccuracy& row : result.accuracies)
                        if (row.lobe == lobe && row.basis == basis && row.coefficients <= budget) best = &row;
                    cells.emplace_back(best->accuracy);
                }
                table.add(std::move(cells));
            }
        text += fmt::format("{} ({}): accuracy with at most so many coefficients\n{}\n", result.signal,
                            result.variant, table.text());
    }
    return text;
}

}  // namespace

const char* radianceName(RadianceModel model) {
    return model == RadianceModel::AboveSurface ? "above" : "sphere";
}

Measurement irradianceMeasurement(const IrradianceComparison& comparison,
                                  std::span<const IrradianceResult> results,
                                  std::span<const EvaluationCost> costs,
                                  std::span<const std::string> figured) {
    std::vector<IrradianceResult> shown;
    for (const IrradianceResult& result : results)
        if (std::find(figured.begin(), figured.end(), result.signal) != figured.end())
            shown.push_back(result);
    const Table ratios = ratioRows(comparison, results);
    Measurement measurement{.name = "basis", .rows = irradianceRows(comparison, results)};
    measurement.more = {{"ratios", ratios}, {"cost", costRows(costs)}};
    Figure figure{.title = "Irradiance on the hemisphere: mean IMSE by basis and number of coefficients",
                  .columns = 2,
                  .panels = {},
                  .panelWidthPx = 680,
                  .panelHeightPx = 420};
    for (const IrradianceResult& result : shown)
        for (const bool direct : {true, false})
            figure.panels.push_back(irradiancePanel(comparison, result, direct));
    measurement.figures.emplace_back("", std::move(figure));
    measurement.summary = irradianceSummary(comparison, shown, costs, ratios);
    return measurement;
}

Measurement lobeMeasurement(std::span<const LobeResult> results, std::span<const LightError> wrongLight) {
    Measurement measurement{
        .name = "basis",
        .rows = Table({"signal", "variant", "lobe", "theta_deg", "phi_deg", "basis", "order", "coefficients",
                       "stored", "accuracy", "accuracy_hemisphere"})};
    for (const LobeResult& result : results)
        for (const LobeAccuracy& row : result.accuracies) {
            const Lobe& lobe = result.lobes[row.lobe];
            measurement.rows.add({result.signal, result.variant, lobe.name, lobe.thetaDeg, lobe.phiDeg,
                                  row.basis, uint64_t(row.order), uint64_t(row.coefficients),
                                  uint64_t(row.stored), row.accuracy, row.accuracyHemisphere});
        }
    Table wrong({"basis", "order", "relative_rms", "relative_median", "relative_max"});
    for (const LightError& error : wrongLight)
        wrong.add(
            {error.basis, uint64_t(error.order), error.relativeRms, error.relativeMedian, error.relativeMax});
    measurement.summary = lobeSummary(results) +
                          "Outgoing light from dot products with an environment's spherical harmonics: error "
                          "against the integral over the hemisphere\n" +
                          wrong.text();
    measurement.more.emplace_back("wrong_light", std::move(wrong));
    for (const LobeResult& result : results) {
        const std::string name = results.size() > 1 ? result.variant : "";
        measurement.figures.emplace_back(name, lobeFigure(result, false));
        measurement.figures.emplace_back(name.empty() ? "error" : name + "-error", lobeFigure(result, true));
    }
    return measurement;
}

}  // namespace prt::tools
