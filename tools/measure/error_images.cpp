// Heat maps: colours of [SmithWalt2015].
#include "tools/measure/error_images.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/exr_file.h"
#include "precompute/mesh/texel_raster.h"
#include "tools/measure/output.h"
#include "tools/picture.h"

namespace prt::tools {
namespace {

constexpr uint8_t kEmpty = 200;           // grey of texels without a value
constexpr double kHighPercentile = 0.99;  // of the total, where the ramp ends

// Judged values spread over the charts.
class AtlasFill {
  public:
    AtlasFill(const JudgedPoints& points, const PointGrid& grid)
        : measured_(grid.count, 0), judged_(grid.count, kNoPoint) {
        PRT_CHECK_EQ(points.chart.size(), grid.count);
        std::vector<uint8_t> has(grid.count, 0);
        for (size_t p = 0; p < points.place.size(); ++p) {
            has[points.place[p]] = 1;
            measured_[points.place[p]] = 1;
            judged_[points.place[p]] = uint32_t(p);
        }
        const auto charted = double(std::count_if(points.chart.begin(), points.chart.end(),
                                                  [](uint32_t c) { return c != kNoPoint; }));
        const int reach = 4 + int(4 * std::sqrt(charted / double(points.place.size())));
        const std::vector<uint32_t> source =
            nearestFilledTexel(has, points.chart, grid.width, grid.height, reach);
        for (size_t t = 0; t < judged_.size(); ++t)
            if (points.chart[t] != kNoPoint && source[t] != kNoPoint) judged_[t] = judged_[source[t]];
    }

    /// NaN where there is none.
    std::vector<float> spread(const std::vector<float>& values) const {
        std::vector<float> result(judged_.size(), std::nanf(""));
        for (size_t t = 0; t < judged_.size(); ++t)
            if (judged_[t] != kNoPoint) result[t] = values[judged_[t]];
        return result;
    }
    const std::vector<uint32_t>& measured() const { return measured_; }

  private:
    std::vector<uint32_t> measured_, judged_;
};

double highEnd(std::vector<float> values) {
    const size_t place = size_t(kHighPercentile * double(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(place), values.end());
    return std::max(1e-6, double(values[place]));
}

void writeHeatMap(const std::filesystem::path& path, const std::vector<float>& texels, const PointGrid& grid,
                  double low, double high) {
    ByteImage image{grid.width, grid.height, 3, {}};
    image.pixels.reserve(3 * texels.size());
    for (const float value : texels) {
        std::array<uint8_t, 3> colour{kEmpty, kEmpty, kEmpty};
        if (!std::isnan(value))
            colour = rampColour(value > 0 ? std::log(double(value) / low) / std::log(high / low) : 0);
        image.pixels.insert(image.pixels.end(), colour.begin(), colour.end());
    }
    writePng(path, image);
}

}  // namespace

std::array<uint8_t, 3> rampColour(double value) {
    constexpr std::array<std::array<double, 3>, 9> kColours{{{68, 1, 84},
                                                             {71, 45, 123},
                                                             {59, 82, 139},
                                                             {44, 114, 142},
                                                             {33, 145, 140},
                                                             {40, 174, 128},
                                                             {94, 201, 98},
                                                             {173, 220, 48},
                                                             {253, 231, 37}}};
    const double x = std::clamp(value, 0.0, 1.0) * double(kColours.size() - 1);
    const size_t low = std::min(size_t(x), kColours.size() - 2);
    std::array<uint8_t, 3> colour;
    for (size_t c = 0; c < 3; ++c)
        colour[c] = uint8_t(
            std::lround(kColours[low][c] + (x - double(low)) * (kColours[low + 1][c] - kColours[low][c])));
    return colour;
}

std::vector<ErrorImage> writeErrorImages(const std::filesystem::path& directory, const ErrorResult& result,
                                         const JudgedPoints& points, const PointGrid& grid) {
    PRT_CHECK_EQ(result.maps.size(), result.environments.size());
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);
    if (failure) throw OutputError(directory.string(), "cannot be made: " + failure.message());
    const AtlasFill fill(points, grid);
    std::vector<ErrorImage> images;
    for (size_t e = 0; e < result.maps.size(); ++e) {
        const ErrorMap& map = result.maps[e];
        const std::string name = result.environments[e].environment, stem = fileStem(name);
        const double high = highEnd(map.total), low = high * std::pow(10.0, -kErrorImageDecades);
        const std::string raw = (directory / (stem + ".error.exr")).string();
        std::vector<std::pair<std::string, std::vector<float>>> channels;
        channels.emplace_back("total", fill.spread(map.total));
        for (size_t stage = 0; stage < kErrorStages; ++stage) {
            const std::vector<float>& values = map.alone[stage];
            if (std::any_of(values.begin(), values.end(), [](float value) { return value > 0; }))
                channels.emplace_back(errorStageName(ErrorStage(stage)), fill.spread(values));
        }
        ExrPartOut part;
        part.width = grid.width;
        part.height = grid.height;
        const size_t row = size_t(grid.width) * 4;
        for (auto& [stage, texels] : channels) {
            const std::filesystem::path file = directory / (stem + "." + stage + ".png");
            writeHeatMap(file, texels, grid, low, high);
            images.push_back({file.string(), raw, name, stage, low, high});
            for (float& value : texels)
                if (std::isnan(value)) value = 0;
            part.channels.push_back({stage, ExrType::Float, texels.data(), 4, row});
        }
        part.channels.push_back({"measured", ExrType::Uint, fill.measured().data(), 4, row});
        part.attributes.strings = {{"environmentName", name},
                                   {"unit", "share of the RMS of irradiance over all judged points"}};
        writeExr(raw, {part});
    }
    return images;
}

}  // namespace prt::tools
