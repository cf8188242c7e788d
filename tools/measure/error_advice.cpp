// From gains to commands.
#include "tools/measure/error_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compress/renewal_command.h"
#include "precompute/math/sh.h"

namespace prt::tools {
namespace {

constexpr double kSmallestError = 1e-4;  // of prt precompute --error
constexpr int kMoreBands = 2;

// What turns a stage's knob one notch; empty where there is none to turn.
class Knobs {
  public:
    Knobs(const std::string& path, const JudgedBundle& bundle, const ErrorResult& result,
          const ErrorStudy& study, const std::vector<std::string>& sources)
        : path_(shellWord(path)), bundle_(bundle), result_(result), study_(study), sources_(sources) {}

    std::string command(ErrorStage stage) const {
        switch (stage) {
            case ErrorStage::Sampling:
                return finerSampling();
            case ErrorStage::Truncation:
                return moreBands();
            case ErrorStage::Projection:
                return bundle_.visibility.projection.kind == ProjectionKind::Plain
                           ? withOption(bundle_.bakeCommand, "--projection", "irradiance")
                           : "";
            case ErrorStage::Pca:
                return moreVectors();
            case ErrorStage::Quantisation:
                return finerFormats();
            case ErrorStage::Tables:
                return finerTables();
        }
        return "";
    }

  private:
    std::string finerSampling() const {
        const auto& attributes = bundle_.visibility.attributes;
        const auto bound = attributes.find("errorBound");
        if (bound != attributes.end()) {
            const double error = std::atof(bound->second.c_str()) / 2;
            return error < kSmallestError
                       ? ""
                       : withOption(bundle_.bakeCommand, "--error", fmt::format("{:g}", error));
        }
        const auto rays = attributes.find("rays");
        const int count = rays == attributes.end() ? 0 : std::atoi(rays->second.c_str());
        if (count <= 0) return withOption(bundle_.bakeCommand, "--error", "0.005");
        if (count > kMaxBakeRays / 2) return "";
        return withOption(bundle_.bakeCommand, "--rays", std::to_string(2 * count));
    }
    std::string moreBands() const {
        const int now = bundle_.visibility.shOrder, more = std::min(kMaxBundleShOrder, now + kMoreBands);
        if (now >= kMaxBundleShOrder) return "";
        std::string command = withOption(bundle_.bakeCommand, "--order", std::to_string(more));
        if (result_.isCompressed)
            command += fmt::format(" && prt compress {} --components {}", path_,
                                   (result_.components * shCount(more) + shCount(now) - 1) / shCount(now));
        return command;
    }
    std::string moreVectors() const {
        const int all = shCount(bundle_.visibility.shOrder), now = result_.components;
        if (!result_.isCompressed || now >= all) return "";
        return fmt::format("prt compress {} --components {}", path_,
                           std::min(all, std::max(now + 4, now * 3 / 2)));
    }
    std::string finerFormats() const {
        const bool isOfWeights = result_.mean.weights.relativeRmse >= result_.mean.tableFormat.relativeRmse;
        if (isOfWeights && study_.weights != "float")
            return fmt::format("prt export {} -o FOLDER --weights {} --tables {}", path_,
                               study_.weights == "unorm8" && result_.isCompressed ? "unorm16" : "float",
                               study_.tables);
        if (study_.tables == "float") return "";
        return fmt::format("prt export {} -o FOLDER --weights {} --tables {}", path_, study_.weights,
                           study_.tables == "half" ? "float" : "half");
    }
    std::string finerTables() const {
        TableOptions finer = study_.table;
        if (result_.mean.bands.relativeRmse > result_.mean.lookup.relativeRmse) {
            if (finer.variant == "exact" && finer.window == "none") return "";
            finer.variant = "exact";
            finer.window = "none";
        } else {
            finer.size *= 2;
            if (finer.size > kLargestJudgedTable) return "";
        }
        std::string environments;
        for (const std::string& source : sources_) environments.append(1, ' ').append(shellWord(source));
        if (sources_.empty()) environments = " sky:clear sky:overcast sky:sunset";
        return fmt::format("prt tabulate {}{} --kind {}{}", path_, environments,
                           result_.isCompressed ? "triple-product" : "light-cosine", tableWords(finer));
    }

    std::string path_;
    const JudgedBundle& bundle_;
    const ErrorResult& result_;
    const ErrorStudy& study_;
    const std::vector<std::string>& sources_;
};

}  // namespace

std::string withOption(const std::string& command, const std::string& option, const std::string& value) {
    const std::string key = " " + option + " ";
    const size_t at = command.find(key);
    if (at == std::string::npos) return command + key + value;
    const size_t begin = at + key.size(), end = std::min(command.find(' ', begin), command.size());
    return command.substr(0, begin) + value + command.substr(end);
}

std::vector<ErrorKnob> knobsOf(const std::string& path, const JudgedBundle& bundle, const ErrorResult& result,
                               const ErrorStudy& study, const std::vector<std::string>& sources) {
    const Knobs knobs(path, bundle, result, study, sources);
    std::vector<ErrorKnob> found;
    for (size_t s = 0; s < kErrorStages; ++s) {
        const ErrorFigure& without = result.mean.without[s];
        ErrorKnob knob{ErrorStage(s), result.mean.gain(ErrorStage(s)), without.relativeRmse, ""};
        if (knob.gain <= without.noise) continue;
        knob.command = knobs.command(knob.stage);
        if (!knob.command.empty()) found.push_back(std::move(knob));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const ErrorKnob& a, const ErrorKnob& b) { return a.gain > b.gain; });
    return found;
}

std::string knobText(const std::vector<ErrorKnob>& knobs, double total) {
    if (knobs.empty()) return "no knob gains more than the noise of this measurement\n";
    std::string text;
    for (size_t k = knobs.size(); k-- > 0;)
        text += fmt::format("{}: {} ({:.4f} would become {:.4f} if it were exact): {}\n",
                            k == 0 ? "turn first" : "then", errorStageName(knobs[k].stage), total,
                            knobs[k].left, knobs[k].command);
    return text;
}

}  // namespace prt::tools
