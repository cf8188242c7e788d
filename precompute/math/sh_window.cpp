// Windows on spherical harmonics [Sloan2008, "Windowing"], and the smallest that leaves nothing negative
// [Sloan2017].
#include "precompute/math/sh_window.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"

namespace prt {
namespace {

/// Windows are searched by strength s = 1/width. At this one all bands but the mean are gone: 0 for Hanning
/// and Lanczos, e^-79 for the Gaussian.
double fullStrength(ShWindow window) { return window == ShWindow::Gaussian ? 4 : 1; }
constexpr int kStrengthSteps = 64;
constexpr int kBisections = 40;
/// Heights looked at per band. The bound has fewer than 2n extrema, and kinks.
constexpr int kHeightsPerBand = 12;
constexpr int kGoldenSteps = 40;

/// Rotation that brings a direction to +Z.
Mat3d zFrom(const Vec3d& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return Mat3d::Identity();
    const Vec3d z = direction / length;
    Vec3d least = Vec3d::Zero();  // the axis farthest from z
    Eigen::Index axis;
    z.cwiseAbs().minCoeff(&axis);
    least[axis] = 1;
    const Vec3d x = least.cross(z).normalized();
    Mat3d rotation;
    rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
    return rotation;
}

/// The bound over z as a function of the factors per band.
class Bound {
  public:
    explicit Bound(std::span<const float> coefficients)
        : order_(shOrderFromCount(coefficients.size())), c_(coefficients.begin(), coefficients.end()) {
        PRT_CHECK(order_ > 0);
        if (order_ > 1) {
            const Vec3d linear(-c_[3], -c_[1], c_[2]);
            rotateSh(zFrom(linear), order_, std::span<const double>(c_), std::span<double>(c_));
        }
        const int heights = kHeightsPerBand * order_ + 1;
        for (int k = 0; k < heights; ++k) heights_.push_back(-std::cos(std::numbers::pi * k / (heights - 1)));
        legendre_.resize(heights_.size() * size_t(legendreCount(order_)));
        for (size_t k = 0; k < heights_.size(); ++k) evalShLegendre(order_, heights_[k], row(k));
    }

    int order() const { return order_; }
    double mean() const { return c_[0]; }

    /// Smallest value over all heights.
    double minimum(std::span<const double> factors) {
        std::vector<double> values(heights_.size());
        for (size_t k = 0; k < heights_.size(); ++k) values[k] = value(row(k), factors);
        const double lowest = *std::min_element(values.begin(), values.end());
        const double spread = *std::max_element(values.begin(), values.end()) - lowest;
        double result = lowest;
        for (size_t k = 0; k < values.size(); ++k) {
            const size_t below = k > 0 ? k - 1 : k, above = std::min(k + 1, values.size() - 1);
            // between two heights the bound cannot dip by more than a small share of its range
            if (values[k] <= values[below] && values[k] <= values[above] &&
                values[k] <= lowest + 0.05 * spread)
                result = std::min(result, refined(heights_[below], heights_[above], factors));
        }
        return result;
    }

  private:
    std::span<double> row(size_t k) {
        const size_t count = size_t(legendreCount(order_));
        return std::span(legendre_).subspan(k * count, count);
    }

    double value(std::span<const double> legendre, std::span<const double> factors) const {
        double sum = 0;
        for (int m = 0; m < order_; ++m) {
            double cosine = 0, sine = 0;
            for (int l = m; l < order_; ++l) {
                const double n = factors[size_t(l)] * legendre[size_t(legendreIndex(l, m))];
                cosine += n * c_[size_t(shIndex(l, m))];
                sine += n * c_[size_t(shIndex(l, -m))];
            }
            sum += m == 0 ? cosine : -std::hypot(cosine, sine);
        }
        return sum;
    }

    /// Golden-section search between two heights.
    double refined(double low, double high, std::span<const double> factors) const {
        constexpr double kGolden = 0.6180339887498949;
        std::vector<double> legendre(size_t(legendreCount(order_)));
        const auto at = [&](double z) {
            evalShLegendre(order_, z, legendre);
            return value(legendre, factors);
        };
        double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
        double valueA = at(a), valueB = at(b), best = std::min(valueA, valueB);
        for (int step = 0; step < kGoldenSteps; ++step) {
            if (valueA < valueB) {
                high = b;
                b = a;
                valueB = valueA;
                a = high - kGolden * (high - low);
                best = std::min(best, valueA = at(a));
            } else {
                low = a;
                a = b;
                valueA = valueB;
                b = low + kGolden * (high - low);
                best = std::min(best, valueB = at(b));
            }
        }
        return best;
    }

    int order_;
    std::vector<double> c_, heights_, legendre_;
};

double widthOf(double strength) {
    return strength > 0 ? 1 / strength : std::numeric_limits<double>::infinity();
}

/// The smallest strength that leaves nothing negative, as a width: the first step that suffices, then
/// bisection. Minima rise with the strength but for small waves.
/// @param negative  of a strength
template <class Negative>
double widestWidth(ShWindow window, const Negative& negative) {
    if (!negative(0.0)) return widthOf(0);
    const double full = fullStrength(window);
    double weak = 0, strong = full;
    for (int step = 1; step < kStrengthSteps; ++step) {
        const double strength = full * step / kStrengthSteps;
        if (!negative(strength)) {
            strong = strength;
            break;
        }
        weak = strength;
    }
    for (int step = 0; step < kBisections; ++step) {
        const double middle = 0.5 * (weak + strong);
        (negative(middle) ? weak : strong) = middle;
    }
    return widthOf(strong);
}

/// What every band adds in every one of a dense set of directions.
class BandValues {
  public:
    explicit BandValues(const EnvironmentSh& environment) : order_(environment.shOrder) {
        const std::vector<Vec3f> directions = sphericalFibonacci(kDirectionsPerCoefficient * shCount(order_));
        std::vector<float> basis(size_t(shCount(order_)));
        for (const Vec3f& direction : directions) {
            evalSh(order_, direction, basis);
            for (const std::vector<float>& colour : environment.rgb)
                for (int l = 0; l < order_; ++l) {
                    double sum = 0;
                    for (int i = shIndex(l, -l); i <= shIndex(l, l); ++i)
                        sum += double(colour[size_t(i)]) * double(basis[size_t(i)]);
                    values_.push_back(sum);
                }
        }
    }
    /// Whether any colour is below 0 anywhere.
    bool negative(std::span<const double> factors) const {
        for (size_t row = 0; row < values_.size(); row += size_t(order_)) {
            double sum = 0;
            for (size_t l = 0; l < size_t(order_); ++l) sum += factors[l] * values_[row + l];
            if (sum < 0) return true;
        }
        return false;
    }

  private:
    static constexpr int kDirectionsPerCoefficient = 16;
    int order_;
    std::vector<double> values_;  // [directions][colours][bands]
};

std::array<double, kMaxShOrder> windowFactors(ShWindow window, double strength, int order) {
    std::array<double, kMaxShOrder> factors{};
    for (int l = 0; l < order; ++l) factors[size_t(l)] = shWindowFactor(window, widthOf(strength), l);
    return factors;
}

}  // namespace

double shWindowFactor(ShWindow window, double width, int band) {
    PRT_CHECK(width > 0 && band >= 0);
    if (band == 0) return 1;
    const double x = std::numbers::pi * band / width;
    if (window == ShWindow::Gaussian) return std::exp(-0.5 * x * x);
    if (band >= width) return 0;
    if (window == ShWindow::Hanning) return 0.5 * (1 + std::cos(x));
    return x > 0 ? std::sin(x) / x : 1;
}

void applyShWindow(ShWindow window, double width, std::span<float> coefficients) {
    const int order = shOrderFromCount(coefficients.size());
    PRT_CHECK(order > 0);
    for (int l = 1; l < order; ++l) {
        const float factor = float(shWindowFactor(window, width, l));
        for (int m = -l; m <= l; ++m) coefficients[size_t(shIndex(l, m))] *= factor;
    }
}

void applyShWindow(ShWindow window, double width, EnvironmentSh& environment) {
    for (std::vector<float>& colour : environment.rgb) applyShWindow(window, width, colour);
}

double shLowerBound(std::span<const float> coefficients) {
    std::array<double, kMaxShOrder> ones;
    ones.fill(1);
    return Bound(coefficients).minimum(ones);
}

ConservativeWindow findConservativeWindow(std::span<const float> coefficients, ShWindow window) {
    Bound bound(coefficients);
    if (bound.mean() < 0) return {1, false};
    const double width = widestWidth(window, [&](double strength) {
        return bound.minimum(windowFactors(window, strength, bound.order())) < 0;
    });
    return {width, true};
}

double findNonNegativeWindow(const EnvironmentSh& environment, ShWindow window) {
    const BandValues values(environment);
    return widestWidth(window, [&](double strength) {
        return values.negative(windowFactors(window, strength, environment.shOrder));
    });
}

ConservativeWindow findConservativeWindow(const EnvironmentSh& environment, ShWindow window) {
    ConservativeWindow strongest{std::numeric_limits<double>::infinity(), true};
    for (const std::vector<float>& colour : environment.rgb) {
        const ConservativeWindow one = findConservativeWindow(colour, window);
        strongest.width = std::min(strongest.width, one.width);
        strongest.nonNegative = strongest.nonNegative && one.nonNegative;
    }
    return strongest;
}

}  // namespace prt
