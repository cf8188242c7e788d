// Spectra of sampling errors along lines on a surface: periodograms under a Hann window [Press2007,
// Sec. 13.4].
#include "tools/measure/sampling_banding.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "precompute/math/irradiance_norm.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "precompute/visibility/orientations.h"
#include "tools/measure/basis_signals.h"

namespace prt::tools {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kPictureTruth = 2;  // pictures have so many times fewer directions of truth
const Vec3d kBallCentre(0.7, 0.7, 0);
constexpr double kBallRadius = 0.6;
constexpr int kBallRings = 96;
constexpr double kErrorGain = 16;  // of pictures

Vec3f times(const Mat3d& matrix, const Vec3f& v) { return (matrix * v.cast<double>()).cast<float>(); }

void addQuad(Scene& scene, const std::array<Vec3f, 4>& corners) {
    const auto first = uint32_t(scene.positions.size());
    scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
    for (const uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) scene.indices.push_back(first + k);
}

// Quads of a surface (s, t) in [0, 1]², the front where ∂s × ∂t points.
template <class Place>
void addPatch(Scene& scene, int columns, int rows, const Place& place) {
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const auto at = [&](int a, int b) {
                return Vec3f(place(double(i + a) / columns, double(j + b) / rows).template cast<float>());
            };
            addQuad(scene, {at(0, 0), at(1, 0), at(1, 1), at(0, 1)});
        }
}

void addBlock(Scene& scene, const Vec3d& low, const Vec3d& high) {
    const Vec3d size = high - low;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d u = Vec3d::Zero(), v = Vec3d::Zero(), w = Vec3d::Zero();
        u[(axis + 1) % 3] = size[(axis + 1) % 3];
        v[(axis + 2) % 3] = size[(axis + 2) % 3];
        w[axis] = size[axis];
        addPatch(scene, 1, 1, [&](double s, double t) { return Vec3d(low + w + s * u + t * v); });
        addPatch(scene, 1, 1, [&](double s, double t) { return Vec3d(low + t * u + s * v); });
    }
}

std::vector<SurfacePoint> floorLine(int count) {
    std::vector<SurfacePoint> points;
    for (int k = 0; k < count; ++k)
        points.push_back({Vec3f(float(-1.9 + 3.8 * (k + 0.5) / count), 0, 1.2f), Vec3f(0, 1, 0), 0});
    return points;
}

// Just outside of the ball's faces, with the normals of the sphere.
std::vector<SurfacePoint> ballLine(int count) {
    std::vector<SurfacePoint> points;
    for (int k = 0; k < count; ++k) {
        const double angle = 2 * kPi * (k + 0.5) / count;
        const Vec3d normal(std::sin(angle), 0, std::cos(angle));
        points.push_back(
            {(kBallCentre + 1.0005 * kBallRadius * normal).cast<float>(), normal.cast<float>(), 0});
    }
    return points;
}

std::vector<SurfacePoint> floorGrid(int size) {
    std::vector<SurfacePoint> points;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            points.push_back({Vec3f(float(-2 + 4 * (x + 0.5) / size), 0, float(-2 + 4 * (y + 0.5) / size)),
                              Vec3f(0, 1, 0), 0});
    return points;
}

enum class Dealing { Random, Tiled };
// One of the bakes that are compared.
struct Variant {
    std::string set;
    int directions;  // 0: adaptive
    int turns;
    Dealing dealing = Dealing::Random;
};
std::vector<Variant> variantsOf(const BandingStudy& study) {
    std::vector<Variant> variants;
    for (const int count : study.counts) variants.push_back({"fibonacci", count, 1});
    for (const int count : study.counts) variants.push_back({"fibonacci-rotated", count, study.rotated});
    for (const int count : study.counts)
        variants.push_back({"fibonacci-tiled4", count, kOrientations, Dealing::Tiled});
    variants.push_back({"adaptive-fibonacci", 0, 1});
    variants.push_back({"adaptive-fibonacci-dealt4", 0, 4});
    variants.push_back({"adaptive-fibonacci-tiled4", 0, 4, Dealing::Tiled});
    variants.push_back({"adaptive-fibonacci-rotated", 0, study.rotated});
    return variants;
}

// Tiled: of N orientations every √N × √N points have each, and so have N points of a row.
std::vector<int> dealt(const Variant& variant, size_t count, int rowLength, uint64_t seed) {
    SignalRandom random(seed);
    const int side = int(std::lround(std::sqrt(variant.turns)));
    std::vector<int> result;
    for (size_t p = 0; p < count; ++p) {
        const int x = int(p) % rowLength, y = int(p) / rowLength;
        result.push_back(variant.dealing == Dealing::Random ? int(random.uniform() * variant.turns)
                                                            : (x + y % side * side) % variant.turns);
    }
    return result;
}

// A scene and what it is baked with.
class Bakery {
  public:
    explicit Bakery(const BandingStudy& study)
        : study_(study), bakes_(bandingScene(), study.rotated + 1, study.seed) {}
    /// @param rowLength  of the points
    BakeResult bake(std::span<const SurfacePoint> points, int rowLength, const Variant& variant) const {
        return bakes_.bake(points, dealt(variant, points.size(), rowLength, study_.seed),
                           options(variant.directions));
    }
    /// In an orientation that no other bake takes.
    std::vector<float> truth(std::span<const SurfacePoint> points, int directions) const {
        return bakes_.bake(points, std::vector<int>(points.size(), study_.rotated), options(directions))
            .coefficients;
    }

  private:
    BakeOptions options(int directions) const {
        BakeOptions options;
        options.shOrder = study_.shOrder;
        options.projection = study_.projection;
        options.rays = std::max(1, directions);
        options.error = directions > 0 ? 0 : study_.error;
        return options;
    }
    const BandingStudy& study_;
    TurnedBakes bakes_;
};

// Irradiance under the sun of a point by its expansion, 1 for an open point that faces the sun.
const Vec3d& sunDirection() {
    static const Vec3d direction = Vec3d(0.3, 0.75, -0.6).normalized();
    return direction;
}
double sunIrradiance(int shOrder, std::span<const float> coefficients, const Vec3f& normal) {
    const double cosine = std::max(0.0, sunDirection().dot(normal.cast<double>()));
    return cosine * evalShExpansion(shOrder, coefficients, sunDirection());
}

// Errors along a line: [points × width] signals, and the length of a vector of them.
struct ErrorLine {
    size_t points = 0, width = 1;
    std::vector<double> values;
    std::function<double(std::span<const double>)> length;
};

ErrorLine sunErrors(const BandingStudy& study, std::span<const SurfacePoint> points,
                    std::span<const float> baked, std::span<const float> truth) {
    const size_t n = size_t(shCount(study.shOrder));
    ErrorLine line{points.size(), 1, {}, [](std::span<const double> v) { return std::abs(v[0]); }};
    for (size_t p = 0; p < points.size(); ++p)
        line.values.push_back(sunIrradiance(study.shOrder, baked.subspan(p * n, n), points[p].normal) -
                              sunIrradiance(study.shOrder, truth.subspan(p * n, n), points[p].normal));
    return line;
}

// Expansions in a frame of the surface that moves along smoothly.
ErrorLine naturalErrors(const BandingStudy& study, const IrradianceNorm& norm,
                        std::span<const SurfacePoint> points, std::span<const float> baked,
                        std::span<const float> truth) {
    const size_t n = size_t(shCount(study.shOrder));
    ErrorLine line{points.size(), n, {}, [&norm](std::span<const double> v) {
                       const std::vector<float> single(v.begin(), v.end());
                       return norm.evaluate(Vec3f(0, 0, 1), single);
                   }};
    for (size_t p = 0; p < points.size(); ++p) {
        std::vector<float> difference(n);
        for (size_t i = 0; i < n; ++i) difference[i] = baked[p * n + i] - truth[p * n + i];
        const Frame frame = frameAround(points[p].normal);
        Mat3d localFromWorld;
        localFromWorld.row(0) = frame.tangent.cast<double>();
        localFromWorld.row(1) = frame.bitangent.cast<double>();
        localFromWorld.row(2) = frame.normal.cast<double>();
        rotateSh(localFromWorld, study.shOrder, difference, difference);
        line.values.insert(line.values.end(), difference.begin(), difference.end());
    }
    return line;
}

// Complex spectrum under a Hann window that keeps the mean square of noise.
std::vector<std::complex<double>> windowed(std::span<const double> signal) {
    const size_t count = signal.size();
    PRT_CHECK(std::has_single_bit(count) && count >= 4);
    double mean = 0;
    for (const double value : signal) mean += value / double(count);
    std::vector<double> samples;
    for (size_t k = 0; k < count; ++k) {
        const double hann = 1 - std::cos(2 * kPi * (double(k) + 0.5) / double(count));
        samples.push_back(std::sqrt(2.0 / 3) * hann * (signal[k] - mean));
    }
    Eigen::FFT<double> transform;
    std::vector<std::complex<double>> spectrum;
    transform.fwd(spectrum, samples);
    spectrum.resize(count / 2 + 1);
    for (size_t k = 0; k < spectrum.size(); ++k)
        spectrum[k] *= (k == 0 || k == count / 2 ? 1 : std::numbers::sqrt2) / double(count);
    return spectrum;
}

// Power by frequency of all signals together.
std::vector<double> lineSpectrum(const ErrorLine& line) {
    const size_t frequencies = line.points / 2 + 1;
    std::vector<double> real(frequencies * line.width), imaginary(frequencies * line.width);
    std::vector<double> signal(line.points);
    for (size_t c = 0; c < line.width; ++c) {
        for (size_t p = 0; p < line.points; ++p) signal[p] = line.values[p * line.width + c];
        const std::vector<std::complex<double>> spectrum = windowed(signal);
        for (size_t k = 0; k < frequencies; ++k) {
            real[k * line.width + c] = spectrum[k].real();
            imaginary[k * line.width + c] = spectrum[k].imag();
        }
    }
    std::vector<double> power;
    for (size_t k = 0; k < frequencies; ++k) {
        const double a = line.length(std::span(real).subspan(k * line.width, line.width)),
                     b = line.length(std::span(imaginary).subspan(k * line.width, line.width));
        power.push_back(a * a + b * b);
    }
    return power;
}

double percentileStep(const ErrorLine& line) {
    std::vector<double> steps, change(line.width);
    for (size_t p = 1; p < line.points; ++p) {
        for (size_t c = 0; c < line.width; ++c)
            change[c] = line.values[p * line.width + c] - line.values[(p - 1) * line.width + c];
        steps.push_back(line.length(change));
    }
    const auto place = steps.begin() + std::ptrdiff_t(steps.size() * 99 / 100);
    std::nth_element(steps.begin(), place, steps.end());
    return *place;
}

// @param row  what names it
BandingRow analysed(BandingRow row, const ErrorLine& line) {
    const std::vector<double> power = lineSpectrum(line);
    const size_t last = power.size() - 1;  // waves of two points
    double shading = 0, bands = 0, grain = 0, bandCount = 0;
    row.octaves.assign(size_t(std::bit_width(last)) - 1, 0.0);
    for (size_t k = 1; k <= last; ++k) {
        const double wave = double(line.points) / double(k);
        (wave > kLongestWave ? shading : wave >= kShortestWave ? bands : grain) += power[k];
        bandCount += wave <= kLongestWave && wave >= kShortestWave;
        row.octaves[std::min(row.octaves.size(), size_t(std::bit_width(k))) - 1] += power[k];
    }
    for (double& octave : row.octaves) octave = std::sqrt(octave);
    const double all = shading + bands + grain;
    row.rms = std::sqrt(all);
    row.shadingRms = std::sqrt(shading);
    row.bandsRms = std::sqrt(bands);
    row.grainRms = std::sqrt(grain);
    row.bandsToWhite = all > 0 ? bands / all / (bandCount / double(last)) : kNone;
    row.step = percentileStep(line);
    return row;
}

std::vector<BandingRow> lineRows(const BandingStudy& study, const Bakery& bakery, const std::string& surface,
                                 std::span<const SurfacePoint> points) {
    const std::vector<float> truth = bakery.truth(points, study.truth);
    const IrradianceNorm norm(study.shOrder);
    std::vector<BandingRow> rows;
    for (const Variant& variant : variantsOf(study)) {
        const BakeResult baked = bakery.bake(points, int(points.size()), variant);
        BandingRow row{};
        row.surface = surface;
        row.set = variant.set;
        row.directions = variant.directions > 0 ? variant.directions : kNone;
        row.rays = double(baked.rays) / double(points.size());
        row.light = "sun";
        rows.push_back(analysed(row, sunErrors(study, points, baked.coefficients, truth)));
        row.light = "natural";
        rows.push_back(analysed(row, naturalErrors(study, norm, points, baked.coefficients, truth)));
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const BandingRow& a, const BandingRow& b) { return a.light > b.light; });
    return rows;
}

std::vector<float> sunImage(const BandingStudy& study, std::span<const SurfacePoint> points,
                            std::span<const float> coefficients) {
    const size_t n = size_t(shCount(study.shOrder));
    std::vector<float> image;
    for (size_t p = 0; p < points.size(); ++p)
        image.push_back(
            float(sunIrradiance(study.shOrder, coefficients.subspan(p * n, n), points[p].normal)));
    return image;
}

ByteImage displayed(std::span<const float> irradiance, int size) {
    FloatImage image{size, size, 3, {}};
    for (const float value : irradiance) image.pixels.insert(image.pixels.end(), 3, std::max(0.0f, value));
    return toDisplay(image, 0);
}

BandingPicture makePicture(const std::string& name, std::span<const float> irradiance,
                           std::span<const float> truth, int size) {
    BandingPicture picture{name, {2 * size, size, 3, {}}, 0, 0};
    picture.image.pixels.resize(size_t(2 * size) * size_t(size) * 3);
    const ByteImage shown = displayed(irradiance, size), right = displayed(truth, size);
    double squares = 0, steps = 0;
    for (size_t p = 0; p < truth.size(); ++p) {
        const double error = double(irradiance[p]) - double(truth[p]);
        squares += error * error;
        steps += std::pow(double(shown.pixels[3 * p]) - double(right.pixels[3 * p]), 2);
        const double grey = std::clamp(127.5 + 255 * kErrorGain * error, 0.0, 255.0);
        const size_t x = p % size_t(size), row = p / size_t(size) * size_t(2 * size);
        for (size_t c = 0; c < 3; ++c) {
            picture.image.pixels[(row + x) * 3 + c] = shown.pixels[3 * p + c];
            picture.image.pixels[(row + size_t(size) + x) * 3 + c] = uint8_t(std::lround(grey));
        }
    }
    picture.rms = std::sqrt(squares / double(truth.size()));
    picture.steps = std::sqrt(steps / double(truth.size()));
    return picture;
}

std::vector<BandingPicture> makePictures(const BandingStudy& study, const Bakery& bakery) {
    const std::vector<SurfacePoint> points = floorGrid(study.picturePx);
    const std::vector<float> truth =
        sunImage(study, points, bakery.truth(points, study.truth / kPictureTruth));
    std::vector<BandingPicture> pictures = {makePicture("truth", truth, truth, study.picturePx)};
    for (const Variant& variant : variantsOf(study)) {
        const std::string name =
            variant.directions > 0 ? fmt::format("{}-{}", variant.set, variant.directions) : variant.set;
        const std::vector<float> irradiance =
            sunImage(study, points, bakery.bake(points, study.picturePx, variant).coefficients);
        pictures.push_back(makePicture(name, irradiance, truth, study.picturePx));
    }
    return pictures;
}

}  // namespace

Scene bandingScene() {
    Scene scene;
    addPatch(scene, 1, 1, [](double s, double t) { return Vec3d(4 * t - 2, 0, 4 * s - 2); });
    addBlock(scene, {-1.2, 0.01, -1}, {-0.4, 1.1, 0.9});
    addPatch(scene, 2 * kBallRings, kBallRings, [](double s, double t) {
        const double azimuth = 2 * kPi * s, polar = kPi * (1 - t);
        return Vec3d(kBallCentre + kBallRadius * Vec3d(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                                                       std::sin(polar) * std::cos(azimuth)));
    });
    return scene;
}

TurnedBakes::TurnedBakes(const Scene& scene, int turns, uint64_t seed) {
    PRT_CHECK_LE(1, turns);
    SignalRandom random(seed);
    for (int t = 0; t < turns; ++t) {
        turns_.push_back(t < kOrientations ? Mat3d(setOrientations()[size_t(t)].transpose())
                                           : random.rotation());
        std::vector<Vec3f> positions;
        for (const Vec3f& position : scene.positions) positions.push_back(times(turns_.back(), position));
        casters_.emplace_back(positions, scene.indices);
    }
}

BakeResult TurnedBakes::bake(std::span<const SurfacePoint> points, std::span<const int> dealt,
                             BakeOptions options) const {
    PRT_CHECK_EQ(dealt.size(), points.size());
    options.findInside = false;
    const size_t columns = size_t(shCount(options.shOrder));
    std::vector<std::vector<size_t>> members(turns_.size());
    for (size_t p = 0; p < points.size(); ++p) {
        PRT_CHECK(dealt[p] >= 0 && size_t(dealt[p]) < turns_.size());
        members[size_t(dealt[p])].push_back(p);
    }
    BakeResult result;
    result.coefficients.resize(points.size() * columns);
    result.ao.resize(points.size());
    result.error.resize(points.size());
    for (size_t t = 0; t < turns_.size(); ++t) {
        if (members[t].empty()) continue;
        std::vector<SurfacePoint> moved;
        for (const size_t p : members[t])
            moved.push_back({times(turns_[t], points[p].position),
                             times(turns_[t], points[p].normal).normalized(), points[p].triangle});
        const BakeResult baked = bakeVisibility(casters_[t], moved, options);
        for (size_t i = 0; i < moved.size(); ++i) {
            const size_t p = members[t][i];
            const auto out = std::span(result.coefficients).subspan(p * columns, columns);
            const auto in = std::span(baked.coefficients).subspan(i * columns, columns);
            if (t == 0)
                std::copy(in.begin(), in.end(), out.begin());
            else
                rotateSh(turns_[t].transpose(), options.shOrder, in, out);
            result.ao[p] = baked.ao[i];
            result.error[p] = baked.error[i];
        }
        result.rays += baked.rays;
    }
    return result;
}

std::vector<double> powerSpectrum(std::span<const double> signal) {
    std::vector<double> power;
    for (const std::complex<double>& value : windowed(signal)) power.push_back(std::norm(value));
    return power;
}

BandingResult studyBanding(const BandingStudy& study) {
    PRT_CHECK_LE(2 * kLongestWave, study.linePoints);
    PRT_CHECK_LE(4, study.rotated);
    PRT_CHECK(std::has_single_bit(unsigned(study.linePoints)));
    const Bakery bakery(study);
    BandingResult result;
    result.rows = lineRows(study, bakery, "floor", floorLine(study.linePoints));
    const std::vector<BandingRow> ball = lineRows(study, bakery, "ball", ballLine(study.linePoints));
    result.rows.insert(result.rows.end(), ball.begin(), ball.end());
    if (study.picturePx > 0) result.pictures = makePictures(study, bakery);
    return result;
}

}  // namespace prt::tools
