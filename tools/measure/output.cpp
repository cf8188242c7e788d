#include "tools/measure/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <sstream>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tools/measure/timing.h"

namespace prt::tools {
namespace {

std::string fileName(const std::string& prefix, const std::string& name, const std::string& extension) {
    return prefix + (name.empty() ? "" : "-" + name) + "." + extension;
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> items;
    std::istringstream stream(text);
    for (std::string item; std::getline(stream, item, ',');) items.push_back(item);
    if (!text.empty() && text.back() == ',') items.emplace_back();
    return items;
}

}  // namespace

void addMeasureOptions(CommandLine& line, MeasureOptions& options) {
    line.text("-o,--output", options.prefix, "PREFIX", "writes PREFIX.csv, and PREFIX.svg or PREFIX.png");
    line.choice("--plot", options.plot, {"svg", "png", "none"}, "format of the plot; needs gnuplot");
}

void checkMeasureOutput(const MeasureOptions& options) {
    const AtomicFile file(fileName(options.prefix, "", "csv"));  // gone again at once
}

void writeMeasurement(const Measurement& measurement, const MeasureOptions& options,
                      const CommonOptions& common, Report report) {
    std::vector<std::string> written;
    const auto writeTable = [&](const std::string& name, const Table& table) {
        written.push_back(fileName(options.prefix, name, "csv"));
        writeFileAtomically(written.back(), table.csv());
    };
    writeTable("", measurement.rows);
    for (const auto& [name, table] : measurement.more) writeTable(name, table);
    if (options.plot != "none") {
        for (const auto& [name, figure] : measurement.figures) {
            const std::string path = fileName(options.prefix, name, options.plot);
            if (!drawFigure(figure, options.plot, path)) {
                logNote("no plot: gnuplot is not installed (Debian: gnuplot-nox)");
                break;
            }
            written.push_back(path);
        }
    }
    report.set("measure", measurement.name).set("cpu", cpuName());
    report.set("rows", measurement.rows.reports());
    for (const auto& [name, table] : measurement.more) report.set(name, table.reports());
    report.write(common.json);
    if (common.json == "-") return;
    fmt::print("{}", measurement.summary.empty() ? measurement.rows.text() : measurement.summary);
    fmt::print("\nwritten: {}\n", fmt::join(written, " "));
}

std::string fileStem(std::string name) {
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
    return name;
}

std::vector<int> parseIntegerList(const std::string& option, const std::string& text, int low, int high) {
    std::set<int> values;
    for (const std::string& item : split(text)) {
        int first = 0, last = 0;
        const char* end = item.data() + item.size();
        auto parsed = std::from_chars(item.data(), end, first);
        last = first;
        if (parsed.ec == std::errc() && parsed.ptr != end && *parsed.ptr == '-')
            parsed = std::from_chars(parsed.ptr + 1, end, last);
        if (parsed.ec != std::errc() || parsed.ptr != end)
            throw UsageError(option, fmt::format("'{}' is not a list of numbers", text),
                             "for example 3,6 or 3-6");
        if (first < low || last > high || first > last)
            throw UsageError(option, fmt::format("'{}' is outside {}..{}", item, low, high));
        for (int value = first; value <= last; ++value) values.insert(value);
    }
    if (values.empty()) throw UsageError(option, "an empty list", "for example 3,6 or 3-6");
    return {values.begin(), values.end()};
}

std::vector<std::string> parseNameList(const std::string& option, const std::string& text,
                                       const std::vector<std::string>& allowed) {
    if (text == "all") return allowed;
    std::vector<std::string> names;
    for (const std::string& item : split(text)) {
        if (std::find(allowed.begin(), allowed.end(), item) == allowed.end())
            throw UsageError(option, fmt::format("'{}' is not one of {}", item, fmt::join(allowed, ", ")));
        if (std::find(names.begin(), names.end(), item) == names.end()) names.push_back(item);
    }
    if (names.empty())
        throw UsageError(option, "an empty list", fmt::format("any of {}", fmt::join(allowed, ", ")));
    return names;
}

}  // namespace prt::tools
