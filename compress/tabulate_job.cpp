// Tables of a bundle: tabulates environments for it [IwanickiSloan2012, Sec. 3.2] and writes them into it in
// one transaction.
#include "compress/tabulate_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "compress/renewal_command.h"
#include "compress/tables/normal_tables.h"
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
constexpr int kMaxTableSize = 1024;

void checkTabulateSettings(const TabulateSettings& settings) {
    if (settings.kind != "triple-product" && settings.kind != "light-cosine")
        throw UsageError("--kind", fmt::format("there is no kind of table called '{}'", settings.kind),
                         "use light-cosine or triple-product");
    if (settings.layout != "cube")
        throw UsageError("--layout", fmt::format("there is no layout called '{}'", settings.layout),
                         "use cube");
    if (settings.size < 1 || settings.size > kMaxTableSize)
        throw UsageError("--size", fmt::format("{} is out of range", settings.size),
                         fmt::format("use 1 to {}", kMaxTableSize));
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

NormalTable makeTable(const Environment& environment, const TableTarget& target, int size) {
    const EnvironmentSh light =
        projectEnvironment(environment.view(), tableEnvironmentShOrder(target.shOrder));
    NormalTable table;
    table.size = size;
    table.shOrder = target.shOrder;
    table.kind = TableKind::LightCosine;
    table.layers = shCount(target.shOrder);
    table.values = buildLightCosineTable(light, target.shOrder, size);
    table.attributes = {{"environmentName", environment.name},
                        {"environmentHash", environment.contentHash},
                        {"cosineBands", std::to_string(kTableCosineBands)}};
    if (!target.mean.empty()) {
        const int components = int(target.basis.size() / target.mean.size());
        table.kind = TableKind::TripleProduct;
        table.layers = components + 1;
        table.values = buildTripleProductTable(table.values, target.shOrder, size, target.mean, target.basis);
        table.attributes["pcaHash"] = target.madeFrom.at(kPca);
    }
    return table;
}

// The section lists every table of the bundle: those of earlier runs stay.
std::string tabulateSection(const Bundle& bundle, const TabulateSettings& settings, const TableTarget& target,
                            const std::vector<TabulateRow>& rows) {
    nlohmann::json section = nlohmann::json::parse(bundle.section("tabulate"), nullptr, false);
    if (!section.is_object()) section = nlohmann::json::object();
    for (const TabulateRow& row : rows)
        section["tables"][row.file] = {{"environment", row.environment},
                                       {"kind", settings.kind},
                                       {"layout", settings.layout},
                                       {"size", settings.size},
                                       {"sh_order", target.shOrder},
                                       {"cosine_bands", kTableCosineBands},
                                       {"environment_hash", row.environmentHash},
                                       {"bytes", row.bytes}};
    return section.dump();
}

// Whether a table of the bundle is current, and made from this environment with these settings.
bool hasSameTable(const Bundle& bundle, const TabulateSettings& settings, const TableTarget& target,
                  const TabulateRow& row) {
    if (!bundle.find(row.file) || !bundle.staleReason(row.file, true).empty()) return false;
    const nlohmann::json section = nlohmann::json::parse(bundle.section("tabulate"), nullptr, false);
    const nlohmann::json* table =
        section.is_object() && section.contains("tables") && section["tables"].contains(row.file)
            ? &section["tables"][row.file]
            : nullptr;
    const auto is = [&](const char* key, const nlohmann::json& value) {
        return table->contains(key) && (*table)[key] == value;
    };
    return table && table->is_object() && is("environment_hash", row.environmentHash) &&
           is("kind", settings.kind) && is("layout", settings.layout) && is("size", settings.size) &&
           is("sh_order", target.shOrder) && is("cosine_bands", kTableCosineBands);
}

}  // namespace

std::vector<TabulateRow> runTabulate(const TabulateSettings& settings) {
    checkTabulateSettings(settings);
    const Bundle bundle = Bundle::open(settings.bundlePath);
    const TableTarget target = tableTarget(bundle, settings);

    BundleTransaction transaction(settings.bundlePath, false);
    std::vector<TabulateRow> rows;
    std::map<std::string, std::string> sources;  // of each file: the argument it is made from
    Progress progress("tabulating", settings.environments.size(), "environments");
    for (const std::string& source : settings.environments) {
        const Stopwatch watch;
        const Environment environment = loadEnvironment(source, settings.environmentOptions);
        TabulateRow row;
        row.environment = environment.name;
        row.file = tableFileName(environment.name, settings.kind, settings.layout);
        const auto [other, isNew] = sources.emplace(row.file, source);
        if (!isNew)
            throw UsageError(source,
                             fmt::format("its table would have the name of that of {}", other->second),
                             "give each environment once, and files of different names");
        row.environmentHash = environment.contentHash;
        if (!settings.force && hasSameTable(bundle, settings, target, row)) {
            row.upToDate = true;
            row.bytes = bundle.find(row.file)->bytes;
            rows.push_back(row);
            progress.advance(1);
            continue;
        }
        const NormalTable table = makeTable(environment, target, settings.size);
        const std::filesystem::path staged = transaction.stage(
            row.file, target.madeFrom,
            fmt::format("prt tabulate {} {} --kind {} --layout {} --size {}{}", settings.bundlePath,
                        shellWord(source), settings.kind, settings.layout, settings.size,
                        environmentWords(settings.environmentOptions)));
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

std::string tableFileName(const std::string& environmentName, const std::string& kind,
                          const std::string& layout) {
    std::string name = environmentName;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
    return fmt::format("tables/{}.{}.{}.exr", name, kind, layout);
}

}  // namespace prt
