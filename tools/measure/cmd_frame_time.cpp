// prt measure frame-time: the paper's table of frame times [IwanickiSloan2012, Sec. 5].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"
#include "tools/command_line.h"
#include "tools/measure/commands.h"
#include "tools/measure/frame_time.h"
#include "tools/measure/output.h"
#include "tools/measure/view_arguments.h"
#include "tools/relight_arguments.h"
#include "tools/relight_techniques.h"

namespace prt::tools {
namespace {

constexpr double kWantedShare = 0.6;  // of the pixels, to be covered
constexpr int kPaperTexels = 512;     // along the edge of the paper's atlas
constexpr int kBytesPerFetch = 16;    // all images have four floats
constexpr Technique kReference{TechniqueKind::Unc, 6};

struct Arguments {
    RelightArguments relight;  // of these, what says what is drawn
    MeasureOptions options{.prefix = "frame-time"};
    std::string context = glContextKindName(GlContextKind::OsMesa);
    int frames = 20;
    bool distanceGiven = false;

    void addTo(CommandLine& line) {
        line.positional("BUNDLE", relight.bundlePath, "bundle made by prt precompute and prt compress");
        addLightOptions(line, relight, "blend");
        addTechniqueOption(line, relight,
                           "repeat to time several; unc6 is always timed where the bundle has six bands");
        line.choice("--context", context,
                    {glContextKindName(GlContextKind::OsMesa), glContextKindName(GlContextKind::Egl),
                     glContextKindName(GlContextKind::Window)},
                    "draw in software, through EGL, or on the display's GPU");
        line.integer("--frames", frames, 20, 100000, "of each technique, in turn");
        line.text("--size", relight.sizeText, "WIDTHxHEIGHT", "pixels");
        addCameraOptions(
            line, relight,
            "; where it is not given, the camera comes nearer until 60 % of the pixels are covered");
        line.flag("--no-normal-map", relight.noNormalMap, "shade with the mesh's own normals");
        addMeasureOptions(line, options);
    }
    void finish(const CommandLine& line) {
        finishTechniques(relight);
        relight.timeFrames = frames;
        relight.finish();
        distanceGiven = line.isGiven("--distance") || line.isGiven("--eye");
    }
};

// What ratios are taken to is timed whether or not it was named.
void addReference(RelightArguments& relight) {
    const Bundle bundle = Bundle::open(relight.bundlePath);
    if (relight.allTechniques || relight.isAsked(kReference) || !bundle.find("visibility.exr")) return;
    if (VisibilityReader(bundle.pathOf("visibility.exr").string()).header().shOrder >= kReference.number)
        relight.techniques.push_back(kReference);
}

class FrameTimeStudy {
  public:
    explicit FrameTimeStudy(const Arguments& arguments)
        : arguments_(arguments),
          relight_(arguments.relight),
          data_(loadRelightData(relight_)),
          techniques_(relight_, data_),
          options_{relight_.width, relight_.height, !relight_.noNormalMap},
          context_(makeContext(arguments.context)),
          renderer_(*context_, data_.scene, nullptr, nullptr) {
        techniques_.addTo(renderer_);
    }

    void run(const CommandLine& line) {
        const Stopwatch watch;
        const Camera camera = placeCamera();
        const double covered = coveredShare(renderer_.surface(camera, options_));
        warn(covered);
        const std::vector<Technique> named = withoutTwins(data_, techniques_);
        std::vector<Technique> drawn;
        for (const Technique technique : named) {
            techniques_.setLight(renderer_, technique, data_.weights, relight_.rotationRad());
            drawn.push_back(techniques_.drawn(technique));
        }
        const auto reference = std::ranges::find(named, kReference);
        const FrameTimes times = summarizeFrames(
            sampleFrames(renderer_, camera, options_, drawn, arguments_.frames),
            reference == named.end() ? std::nullopt : std::optional(size_t(reference - named.begin())));
        write(line, named, times, covered, watch.seconds());
    }

  private:
    Camera placeCamera() {
        const Bounds bounds = sceneBounds(data_.scene);
        RelightArguments view = relight_;
        if (!arguments_.distanceGiven) {
            const RenderOptions small{std::max(1, options_.width / 8), std::max(1, options_.height / 8),
                                      false};
            view.distance = coveringDistance(
                [&](double distance) {
                    view.distance = distance;
                    return coveredShare(renderer_.surface(view.camera(bounds), small));
                },
                kWantedShare + 0.02);  // the small picture does not say to the pixel
        }
        distance_ = view.distance;
        return view.camera(bounds);
    }

    const PointGrid& grid() const { return data_.visibility ? data_.visibility->grid : data_.pca->grid; }

    void warn(double covered) const {
        if (covered < kWantedShare)
            logWarning(
                fmt::format("only {:.0f} % of the pixels are covered: less than the paper's table has; move "
                            "the camera with --azimuth, --distance or --eye",
                            100 * covered));
        if (grid().domain == PointDomain::Vertex)
            logWarning("visibility is per vertex: the paper's table is of 512x512 texels");
        else if (grid().width != kPaperTexels || grid().height != kPaperTexels)
            logWarning(fmt::format("visibility has {}x{} texels: the paper's table is of 512x512",
                                   grid().width, grid().height));
    }

    Table table(const std::vector<Technique>& named, const FrameTimes& times, double covered) const {
        Table rows({"technique", "median_ms", "light_ms", "light_low_ms", "light_high_ms", "ratio_to_unc6",
                    "ratio_low", "ratio_high", "times_faster", "paper_ratio_to_unc6", "fetches",
                    "multiply_adds", "bytes_per_pixel", "gigabytes_per_s"});
        const double pixels = covered * double(options_.width) * double(options_.height);
        for (size_t i = 0; i < named.size(); ++i) {
            const TechniqueTime& time = times.techniques[i];
            const TechniqueCost cost =
                techniqueCost(named[i], data_.source(), data_.domain(), relight_.tables.cosineBands());
            const double bytes = double(cost.fetches) * kBytesPerFetch;
            const std::string name = techniqueName(named[i]);
            rows.add({name, time.frameMs, time.lightMs.median, time.lightMs.low, time.lightMs.high,
                      time.ratio.median, time.ratio.low, time.ratio.high, 1 / time.ratio.median,
                      paperMilliseconds(name) / paperMilliseconds("unc6"), uint64_t(cost.fetches),
                      uint64_t(cost.multiplyAdds), bytes, bytes * pixels / time.lightMs.median * 1e-6});
        }
        return rows;
    }

    // What fits on a terminal.
    static std::string shortText(const Table& rows) {
        const std::vector<std::string> columns = {"technique",     "median_ms",      "light_ms",
                                                  "ratio_to_unc6", "times_faster",   "paper_ratio_to_unc6",
                                                  "fetches",       "gigabytes_per_s"};
        Table chosen(columns);
        for (size_t row = 0; row < rows.rowCount(); ++row) {
            std::vector<Cell> cells;
            for (const std::string& column : columns) cells.push_back(rows.cell(row, column));
            chosen.add(std::move(cells));
        }
        return chosen.text();
    }

    void write(const CommandLine& line, const std::vector<Technique>& named, const FrameTimes& times,
               double covered, double seconds) const {
        Measurement measurement{.name = "frame-time", .rows = table(named, times, covered)};
        Panel panel{
            .title = fmt::format("{}x{}, {}", options_.width, options_.height, context_->rendererName()),
            .yLabel = "milliseconds, base pass subtracted"};
        for (size_t i = 0; i < named.size(); ++i)
            panel.bars.push_back(
                {techniqueName(named[i]), times.techniques[i].lightMs.median, int(named[i].kind)});
        measurement.figures = {{"", Figure{.title = "Time of a frame by technique",
                                           .columns = 1,
                                           .panels = {panel},
                                           .panelWidthPx = 900}}};
        measurement.summary = fmt::format(
            "{}\nbase pass: {:.1f} ms (quartiles {:.1f}, {:.1f}), {}x{}, {:.1f} % of the pixels covered, {} "
            "frames of each in turn\n{} ({})\n",
            shortText(measurement.rows), times.baseMs.median, times.baseMs.low, times.baseMs.high,
            options_.width, options_.height, 100 * covered, arguments_.frames, context_->rendererName(),
            glContextKindName(context_->kind()));
        Report report;
        report.set("bundle", relight_.bundlePath)
            .set("context", glContextKindName(context_->kind()))
            .set("gpu", context_->rendererName())
            .set("gl_version", context_->versionName())
            .set("width", options_.width)
            .set("height", options_.height)
            .set("normal_map", options_.normalMap)
            .set("distance", distance_)
            .set("covered_percent", 100 * covered)
            .set("domain", std::string(pointDomainName(grid().domain)))
            .set("grid_width", grid().width)
            .set("grid_height", grid().height)
            .set("frames", arguments_.frames)
            .set("base_ms", times.baseMs.median)
            .set("base_low_ms", times.baseMs.low)
            .set("base_high_ms", times.baseMs.high)
            .set("seconds", seconds);
        writeMeasurement(measurement, arguments_.options, line.common(), std::move(report));
    }

    const Arguments& arguments_;
    const RelightArguments& relight_;
    RelightData data_;
    RelightTechniques techniques_;
    RenderOptions options_;
    std::unique_ptr<GlContext> context_;
    Renderer renderer_;
    double distance_ = 1;
};

}  // namespace

void runMeasureFrameTime(int argc, char** argv) {
    Arguments arguments;
    CommandLine line(
        "prt measure frame-time",
        "Time of a frame by technique: the paper's table. Frames of all techniques and of a base "
        "pass (geometry, normal map, albedo) are drawn in turn; the base pass is subtracted.",
        techniqueHelp() +
            "Example:\n  prt measure frame-time house.prt --env sky:sunset --context egl --json -");
    arguments.addTo(line);
    if (!line.parse(argc, argv)) return;
    arguments.finish(line);
    checkMeasureOutput(arguments.options);
    addReference(arguments.relight);
    FrameTimeStudy(arguments).run(line);
}

}  // namespace prt::tools
