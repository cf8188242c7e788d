// The table of frame times of [IwanickiSloan2012, Sec. 5].
#include "tools/measure/frame_time.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/base/check.h"

namespace prt::tools {

FrameSamples sampleFrames(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                          const std::vector<Technique>& techniques, int rounds) {
    PRT_CHECK_LE(1, rounds);
    const std::vector<std::vector<double>> none(techniques.size());
    FrameSamples samples{none, none};
    const auto draw = [&](std::optional<Technique> technique) {
        return renderer.frameMilliseconds(camera, technique, options, 1, 0);
    };
    draw(std::nullopt);  // shaders are compiled for the state they meet first
    for (const Technique technique : techniques) draw(technique);
    for (int round = 0; round < rounds; ++round) {
        for (size_t i = 0; i < techniques.size(); ++i) {
            const size_t next = (size_t(round) + i) % techniques.size();
            samples.base[next].push_back(draw(std::nullopt));
            samples.techniques[next].push_back(draw(techniques[next]));
        }
    }
    return samples;
}

Spread spreadOf(std::vector<double> values) {
    PRT_CHECK(!values.empty());
    std::ranges::sort(values);
    const auto at = [&](double share) {
        const double place = share * double(values.size() - 1);
        const size_t low = size_t(place), high = std::min(low + 1, values.size() - 1);
        return std::lerp(values[low], values[high], place - double(low));
    };
    return {at(0.5), at(0.25), at(0.75)};
}

FrameTimes summarizeFrames(const FrameSamples& samples, std::optional<size_t> reference) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    PRT_CHECK_EQ(samples.base.size(), samples.techniques.size());
    FrameTimes times;
    std::vector<std::vector<double>> light(samples.base.size());
    std::vector<double> base;
    for (size_t i = 0; i < light.size(); ++i) {
        PRT_CHECK_EQ(samples.base[i].size(), samples.techniques[i].size());
        base.insert(base.end(), samples.base[i].begin(), samples.base[i].end());
        for (size_t round = 0; round < samples.base[i].size(); ++round)
            light[i].push_back(samples.techniques[i][round] - samples.base[i][round]);
    }
    times.baseMs = spreadOf(std::move(base));
    const double unit = reference ? spreadOf(light[*reference]).median : kNone;
    for (size_t i = 0; i < light.size(); ++i) {
        TechniqueTime time{spreadOf(samples.techniques[i]).median, spreadOf(light[i]), {kNone, kNone, kNone}};
        std::vector<double> ratios;
        for (size_t round = 0; reference && round < light[i].size(); ++round)
            // A base pass that was disturbed may exceed its frame: such a round says nothing.
            if (light[*reference][round] > 0) ratios.push_back(light[i][round] / light[*reference][round]);
        if (unit > 0 && !ratios.empty()) {
            time.ratio = spreadOf(std::move(ratios));
            // The median of rounds' ratios is off where a few rounds were disturbed; that of medians is not.
            time.ratio.median = time.lightMs.median / unit;
        }
        times.techniques.push_back(time);
    }
    return times;
}

double coveringDistance(const std::function<double(double)>& coverage, double wanted) {
    double best = 1, most = -1;
    for (double distance = 1; distance >= 0.1; distance /= 1.1) {
        const double covered = coverage(distance);
        if (covered >= wanted) return distance;
        if (covered > most) {
            most = covered;
            best = distance;
        }
    }
    return best;
}

double coveredShare(const SurfaceImage& surface) {
    const auto covered = std::ranges::count_if(surface.triangle, [](uint32_t t) { return t != kNoTriangle; });
    return double(covered) / double(surface.pixels());
}

std::unique_ptr<GlContext> makeContext(std::string_view name) {
    if (name == glContextKindName(GlContextKind::Window))
        return std::make_unique<GlContext>(GlWindowOptions{.visible = false});
    return std::make_unique<GlContext>(name == glContextKindName(GlContextKind::Egl) ? GlContextKind::Egl
                                                                                     : GlContextKind::OsMesa);
}

double paperMilliseconds(std::string_view name) {
    constexpr std::pair<std::string_view, double> kTable[] = {
        {"unc6", 8.19},  {"unc4", 3.33},         {"unc3", 2.75},
        {"pca4", 1.40},  {"pca8", 2.08},         {"pca16", 3.61},
        {"pca24", 5.56}, {"sh-lightmap", 0.846}, {"preconvolved-ao", 0.648},
        {"sh2", 0.607}};
    for (const auto& [technique, milliseconds] : kTable)
        if (technique == name) return milliseconds;
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace prt::tools
