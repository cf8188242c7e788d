// prt info: what a bundle holds.
#include <fmt/format.h>

#include "precompute/base/log.h"
#include "precompute/io/bundle.h"
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
    return "";
}

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
    for (const std::string& name : bundle.sectionNames()) report.setJson(name, bundle.section(name));
    if (text) {
        fmt::print("  {:<44} {:>10.3f} MB\n", "all", double(total) * 1e-6);
        fmt::print("\nconventions\n");
        for (const auto& [name, meaning] : bundle.conventions()) fmt::print("  {:<22}{}\n", name, meaning);
        for (const std::string& name : bundle.sectionNames())
            fmt::print("\n{}\n{}\n", name, bundle.section(name));
    }
    report.write(line.common().json);
}

}  // namespace prt::tools
