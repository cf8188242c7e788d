// prt info: what a bundle holds.
#include <fmt/format.h>

#include "compress/shipped_bytes.h"
#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/exr_file.h"
#include "precompute/io/visibility_file.h"
#include "precompute/math/sh.h"
#include "tools/command_line.h"
#include "tools/commands.h"
#include "tools/report.h"

namespace prt::tools {
namespace {

std::string describe(const std::string& name) {
    if (name == "mesh.glb")
        return "mesh: TEXCOORD_0 materials, TEXCOORD_1 atlas, normals, tangents, textures";
    if (name == "visibility.exr")
        return "visibility: V.00... SH coefficients, validity, ao, geometric normal";
    if (name == "pca.exr") return "compressed visibility: weights w.00..., basis (mean, then vectors)";
    if (name.find(".light-cosine.") != std::string::npos)
        return "table: light x cosine, n*n values per colour";
    if (name.find(".triple-product.") != std::string::npos)
        return "table: light x cosine x component, four components per RGBA layer, mean";
    if (name.ends_with(".sun.exr"))
        return "sun of an environment: visible share of its disc, direction, irradiance";
    if (name.starts_with("lightmaps/"))
        return "lightmap of an environment: SH of the light that arrives, with its bounces";
    return "";
}

// A file of the bundle that may be read.
bool isCurrent(const Bundle& bundle, const std::string& name) {
    return bundle.find(name) && bundle.staleReason(name, false).empty();
}

// What a point and a normal take where prt export ships them, by format.
class ShippedBytes {
  public:
    explicit ShippedBytes(const Bundle& bundle) {
        if (isCurrent(bundle, "visibility.exr")) {
            const VisibilityReader reader(bundle.pathOf("visibility.exr").string());
            domain_ = pointDomainName(reader.header().grid.domain);
            coefficients_ = shCount(reader.header().shOrder);
        }
        if (isCurrent(bundle, "pca.exr")) components_ = componentsOf(bundle.pathOf("pca.exr").string());
    }

    void print() const {
        if (rows().empty()) return;
        fmt::print("\nbytes as prt export ships them, per {} and per normal of one environment's table\n",
                   domain_);
        for (const Row& row : rows()) {
            fmt::print("  {:<44}", fmt::format("{} ({} values)", row.what, row.values));
            for (const auto& [encoding, bytes] : row.bytes) fmt::print("  {} {}", encoding, bytes);
            fmt::print("\n");
        }
    }
    std::vector<Report> reports() const {
        std::vector<Report> reports;
        for (const Row& row : rows()) {
            Report bytes, report;
            for (const auto& [encoding, count] : row.bytes) bytes.set(encoding, uint64_t(count));
            report.set("what", row.what)
                .set("values", row.values)
                .set("per", row.perPoint ? domain_ : "normal")
                .set("bytes", bytes);
            reports.push_back(std::move(report));
        }
        return reports;
    }

  private:
    struct Row {
        std::string what;
        int values;
        bool perPoint;
        std::vector<std::pair<std::string, size_t>> bytes;
    };

    static int componentsOf(const std::string& path) {
        const ExrReader reader(path);
        for (const ExrPartInfo& part : reader.parts())
            if (part.attributes.ints.contains("componentCount"))
                return requireInt(part.attributes, "componentCount", 1, 1 << 14, path);
        return 0;
    }
    std::vector<Row> rows() const {
        std::vector<Row> rows;
        const auto add = [&](const std::string& what, int values, bool isWeights) {
            if (values == 0) return;
            Row points{what, values, true, {}}, table{what + ", table", values, false, {}};
            for (const std::string& encoding : pointEncodings())
                if (isWeights || !encoding.starts_with("unorm"))
                    points.bytes.emplace_back(encoding, shippedBytes(values, encoding));
            for (const std::string& encoding : tableEncodings())
                table.bytes.emplace_back(encoding, shippedTableBytes(values, isWeights, encoding));
            rows.push_back(std::move(points));
            rows.push_back(std::move(table));
        };
        add("visibility coefficients", coefficients_, false);
        add("weights of components", components_, true);
        return rows;
    }

    std::string domain_ = "point";
    int coefficients_ = 0, components_ = 0;
};

}  // namespace

void runInfoCommand(int argc, char** argv) {
    std::string path;
    bool fast = false;
    CommandLine line("prt info",
                     "Explains a bundle: files, conventions, settings, statistics, and what is stale.",
                     "Example:\n  prt info out/house.prt --json -");
    line.positional("BUNDLE", path, "bundle directory");
    line.flag("--fast", fast, "compare sizes only, do not hash the files");
    if (!line.parse(argc, argv)) return;

    const Bundle bundle = Bundle::open(path);
    const bool text = line.common().json != "-";
    uint64_t total = 0;
    std::vector<Report> files;
    if (text) fmt::print("{}: prt bundle, format {}\n\nfiles\n", path, kBundleFormatVersion);
    for (const BundleFile& file : bundle.files()) {
        const std::string stale = bundle.staleReason(file.name, !fast);
        total += file.bytes;
        if (text) {
            fmt::print("  {:<44} {:>10.3f} MB  {}\n", file.name, double(file.bytes) * 1e-6,
                       describe(file.name));
            if (!stale.empty())
                fmt::print("  {:<44} STALE: {}{}\n", "", stale,
                           file.madeBy.empty() ? "" : "; renew it with: " + file.madeBy);
        }
        Report madeFrom, row;
        for (const auto& [input, hash] : file.madeFrom) madeFrom.set(input, hash);
        row.set("name", file.name)
            .set("bytes", file.bytes)
            .set("xxh3_128", file.xxh3)
            .set("stale", !stale.empty())
            .set("stale_reason", stale)
            .set("made_from", madeFrom)
            .set("made_by", file.madeBy)
            .set("holds", describe(file.name));
        files.push_back(std::move(row));
    }
    Report report;
    report.set("bundle", path).set("format_version", kBundleFormatVersion);
    Report conventions;
    for (const auto& [name, meaning] : bundle.conventions()) conventions.set(name, meaning);
    report.set("conventions", conventions).set("files", files).set("bytes", total);
    const ShippedBytes shipped(bundle);
    report.set("shipped_bytes", shipped.reports());
    for (const std::string& name : bundle.sectionNames()) report.setJson(name, bundle.section(name));
    if (text) {
        fmt::print("  {:<44} {:>10.3f} MB\n", "all", double(total) * 1e-6);
        shipped.print();
        fmt::print("\nconventions\n");
        for (const auto& [name, meaning] : bundle.conventions()) fmt::print("  {:<22}{}\n", name, meaning);
        for (const std::string& name : bundle.sectionNames())
            fmt::print("\n{}\n{}\n", name, bundle.section(name));
    }
    report.write(line.common().json);
}

}  // namespace prt::tools
