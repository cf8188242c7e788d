// Tables of a bundle: tabulates environments for it [IwanickiSloan2012, Sec. 3.2] and writes them into it in
// one transaction.
#include "compress/tabulate_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "compress/renewal_command.h"
#include "compress/tables/fast_tables.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/environment_file.h"
#include "precompute/io/table_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr const char* kVisibility = "visibility.exr";
constexpr const char* kPca = "pca.exr";

void checkTabulateSettings(const TabulateSettings& settings) {
    if (settings.kind != "triple-product" && settings.kind != "light-cosine")
        throw UsageError("--kind", fmt::format("there is no kind of table called '{}'", settings.kind),
                         "use light-cosine or triple-product");
    checkTableOptions(settings.table);
    if (settings.environments.empty())
        throw UsageError("environments", "none is given",
                         "name one or more .exr or .hdr files, or sky:clear");
}

// What tables are made for: the visibility alone, or its compressed form.
struct TableTarget {
    int shOrder = 0;
    std::vector<float> mean, basis;
    std::map<std::string, std::string> madeFrom;
};

TableTarget tableTarget(const Bundle& bundle, const TabulateSettings& settings) {
    TableTarget target;
    if (settings.kind == "light-cosine") {
        // Only the order matters, and readers compare it: baking again with more rays leaves these current.
        bundle.require(kVisibility, "prt precompute");
        target.shOrder = readVisibilityFile(bundle.pathOf(kVisibility).string()).shOrder;
        return target;
    }
    bundle.require(kPca, fmt::format("prt compress {}", settings.bundlePath));
    PcaMap pca = readPcaFile(bundle.pathOf(kPca).string());
    target.shOrder = pca.shOrder;
    target.mean = std::move(pca.mean);
    target.basis = std::move(pca.basis);
    target.madeFrom = {{kPca, bundle.find(kPca)->xxh3}};
    return target;
}

// Makes the tables of all environments.
class TableMaker {
  public:
    TableMaker(const TableTarget& target, const TableOptions& options)
        : target_(target),
          options_(options),
          builder_(TableLayout(options.layout, options.size), target.shOrder, options.cosineBands()) {}

    NormalTable make(const Environment& environment, TabulateRow& row) {
        const TableLight light = projectTableLight(environment.view(), target_.shOrder, options_);
        row.sun = light.sun;
        row.windowWidth = light.windowWidth;
        NormalTable table;
        table.layout = options_.layout;
        table.size = options_.size;
        table.shOrder = target_.shOrder;
        table.kind = isTriple() ? TableKind::TripleProduct : TableKind::LightCosine;
        table.layers =
            isTriple() ? int(target_.basis.size() / target_.mean.size()) + 1 : shCount(target_.shOrder);
        table.attributes = {{"environmentName", environment.name},
                            {"environmentHash", environment.contentHash},
                            {"cosineBands", std::to_string(options_.cosineBands())},
                            {"window", options_.window},
                            {"extractSun", options_.extractSun ? "yes" : "no"}};
        if (isTriple()) table.attributes["pcaHash"] = target_.madeFrom.at(kPca);
        table.values = build(builder_, light.rest, table);
        if (options_.variant != TableOptions{}.variant)
            row.relativeDifferenceFromExact = differenceFromExact(environment, table);
        return table;
    }

  private:
    bool isTriple() const { return !target_.mean.empty(); }

    std::vector<float> build(LightTableBuilder& builder, const EnvironmentSh& light,
                             const NormalTable& table) const {
        std::vector<float> values(size_t(3) * size_t(table.layers) * table.texels());
        if (isTriple())
            builder.buildTripleProduct(light, target_.mean, target_.basis, values);
        else
            builder.buildLightCosine(light, values);
        return values;
    }

    double differenceFromExact(const Environment& environment, const NormalTable& table) {
        TableOptions exact = options_;
        exact.variant = TableOptions{}.variant;
        if (!exactBuilder_)
            exactBuilder_.emplace(TableLayout(exact.layout, exact.size), target_.shOrder,
                                  exact.cosineBands());
        const std::vector<float> values =
            build(*exactBuilder_, projectTableLight(environment.view(), target_.shOrder, exact).rest, table);
        double difference = 0, square = 0;
        for (size_t i = 0; i < values.size(); ++i) {
            difference += std::pow(double(table.values[i]) - double(values[i]), 2);
            square += std::pow(double(values[i]), 2);
        }
        return square > 0 ? std::sqrt(difference / square) : 0;
    }

    const TableTarget& target_;
    const TableOptions options_;
    LightTableBuilder builder_;
    std::optional<LightTableBuilder> exactBuilder_;
};

// What tables of one environment are remade for when it changes.
nlohmann::json tableSettingsJson(const TabulateSettings& settings, const TableTarget& target,
                                 const TabulateRow& row) {
    return {{"environment_hash", row.environmentHash},
            {"kind", settings.kind},
            {"layout", settings.table.layout},
            {"size", settings.table.size},
            {"variant", settings.table.variant},
            {"window", settings.table.window},
            {"extract_sun", settings.table.extractSun},
            {"sh_order", target.shOrder},
            {"cosine_bands", settings.table.cosineBands()}};
}

nlohmann::json sunJson(const ExtractedSun& sun) {
    if (!sun.found) return nullptr;
    return {{"direction", {sun.direction.x(), sun.direction.y(), sun.direction.z()}},
            {"angular_radius_rad", sun.angularRadiusRad},
            {"radiance", sun.radiance},
            {"irradiance", sun.irradiance()},
            {"share", sun.share}};
}

ExtractedSun sunFromJson(const nlohmann::json& json) {
    ExtractedSun sun;
    if (!json.is_object()) return sun;
    sun.found = true;
    for (int k = 0; k < 3; ++k) sun.direction[k] = json.at("direction").at(size_t(k)).get<double>();
    sun.angularRadiusRad = json.at("angular_radius_rad").get<double>();
    sun.radiance = json.at("radiance").get<std::array<double, 3>>();
    sun.share = json.at("share").get<double>();
    return sun;
}

// The section lists every table of the bundle: those of earlier runs stay.
std::string tabulateSection(const Bundle& bundle, const TabulateSettings& settings, const TableTarget& target,
                            const std::vector<TabulateRow>& rows) {
    nlohmann::json section = nlohmann::json::parse(bundle.section("tabulate"), nullptr, false);
    if (!section.is_object()) section = nlohmann::json::object();
    for (const TabulateRow& row : rows) {
        if (row.upToDate) continue;
        nlohmann::json table = tableSettingsJson(settings, target, row);
        table["environment"] = row.environment;
        table["bytes"] = row.bytes;
        table["sun"] = sunJson(row.sun);
        if (std::isfinite(row.windowWidth) && row.windowWidth > 0) table["window_width"] = row.windowWidth;
        if (row.relativeDifferenceFromExact > 0)
            table["relative_difference_from_exact"] = row.relativeDifferenceFromExact;
        section["tables"][row.file] = std::move(table);
    }
    return section.dump();
}

// Whether a table of the bundle is current, and made from this environment with these settings; what is known
// of it goes into the row.
bool hasSameTable(const Bundle& bundle, const TabulateSettings& settings, const TableTarget& target,
                  TabulateRow& row) {
    if (!bundle.find(row.file) || !bundle.staleReason(row.file, true).empty()) return false;
    const nlohmann::json wanted = tableSettingsJson(settings, target, row);
    try {
        const nlohmann::json table =
            nlohmann::json::parse(bundle.section("tabulate")).at("tables").at(row.file);
        for (const auto& [key, value] : wanted.items())
            if (table.at(key) != value) return false;
        row.sun = sunFromJson(table.at("sun"));
        row.windowWidth = table.value("window_width", 0.0);
        row.relativeDifferenceFromExact = table.value("relative_difference_from_exact", 0.0);
    } catch (const nlohmann::json::exception&) {  // of an earlier version, or written by hand: made again
        return false;
    }
    row.upToDate = true;
    row.bytes = bundle.find(row.file)->bytes;
    return true;
}

}  // namespace

std::vector<TabulateRow> runTabulate(const TabulateSettings& settings) {
    checkTabulateSettings(settings);
    const Bundle bundle = Bundle::open(settings.bundlePath);
    const TableTarget target = tableTarget(bundle, settings);
    TableMaker maker(target, settings.table);

    BundleTransaction transaction(settings.bundlePath, false);
    std::vector<TabulateRow> rows;
    std::map<std::string, std::string> sources;  // of each file: the argument it is made from
    Progress progress("tabulating", settings.environments.size(), "environments");
    for (const std::string& source : settings.environments) {
        const Stopwatch watch;
        const Environment environment = loadEnvironment(source, settings.environmentOptions);
        TabulateRow row;
        row.environment = environment.name;
        row.file = tableFileName(environment.name, settings.kind, settings.table.layout);
        const auto [other, isNew] = sources.emplace(row.file, source);
        if (!isNew)
            throw UsageError(source,
                             fmt::format("its table would have the name of that of {}", other->second),
                             "give each environment once, and files of different names");
        row.environmentHash = environment.contentHash;
        if (!settings.force && hasSameTable(bundle, settings, target, row)) {
            rows.push_back(row);
            progress.advance(1);
            continue;
        }
        const NormalTable table = maker.make(environment, row);
        const std::filesystem::path staged =
            transaction.stage(row.file, target.madeFrom, tabulateCommand(settings, source));
        writeTableFile(staged.string(), table);
        row.bytes = size_t(std::filesystem::file_size(staged));
        row.seconds = watch.seconds();
        rows.push_back(row);
        progress.advance(1);
    }
    if (std::all_of(rows.begin(), rows.end(), [](const TabulateRow& row) { return row.upToDate; }))
        return rows;
    transaction.setSection("tabulate", tabulateSection(bundle, settings, target, rows));
    transaction.commit();
    return rows;
}

std::string tabulateCommand(const TabulateSettings& settings, const std::string& source) {
    return fmt::format("prt tabulate {} {} --kind {}{}{}", shellWord(settings.bundlePath), shellWord(source),
                       settings.kind, tableWords(settings.table),
                       environmentWords(settings.environmentOptions));
}

std::string tableFileName(const std::string& environmentName, const std::string& kind,
                          const std::string& layout) {
    return fmt::format("tables/{}.{}.{}.exr", environmentFileStem(environmentName), kind, layout);
}

}  // namespace prt
