// Latitude-longitude environments and their projection. In a frame whose pole is the image's (up) the basis
// is separable: Fourier sums along rows, Legendre functions down the columns; one exact rotation then brings
// the coefficients to the project's frame. [Driscoll1994] "Computing Fourier transforms and convolutions on
// the 2-sphere" has the idea; the sum is the plain one over texel centres.
#include "precompute/math/environment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Columns x and width − 1 − x lie at opposite longitudes: cosines see their sum, sines their difference.
/// @return [3·rows × half] sums and differences of a block of rows
void foldRows(const LatLongView& image, size_t begin, size_t end, Matrix& sums, Matrix& differences) {
    const size_t width = size_t(image.width), half = (width + 1) / 2;
    sums.resize(Eigen::Index(3 * (end - begin)), Eigen::Index(half));
    differences.resize(sums.rows(), sums.cols());
    for (size_t y = begin; y < end; ++y) {
        const float* row = image.rgb.data() + y * width * 3;
        for (size_t x = 0; x < half; ++x) {
            const size_t mirrored = width - 1 - x;
            for (size_t c = 0; c < 3; ++c) {
                const double a = row[3 * x + c], b = mirrored == x ? 0.0 : double(row[3 * mirrored + c]);
                const auto r = Eigen::Index(3 * (y - begin) + c), i = Eigen::Index(x);
                sums(r, i) = a + b;
                differences(r, i) = mirrored == x ? 0.0 : a - b;
            }
        }
    }
}

struct FourierRows {
    Matrix cosine, sine;  ///< [3·height × shOrder]: Σ_x L cos(mλ) and Σ_x L sin(mλ)
};

FourierRows fourierSums(const LatLongView& image, int shOrder) {
    const int half = (image.width + 1) / 2;
    Matrix cosines(half, shOrder), sines(half, shOrder);
    for (int x = 0; x < half; ++x) {
        const double longitude = kPi - 2 * kPi * (x + 0.5) / image.width;
        for (int m = 0; m < shOrder; ++m) {
            cosines(x, m) = std::cos(m * longitude);
            sines(x, m) = std::sin(m * longitude);
        }
    }
    FourierRows result{Matrix(3 * image.height, shOrder), Matrix(3 * image.height, shOrder)};
    parallelFor(size_t(image.height), 8, [&](size_t begin, size_t end) {
        Matrix sums, differences;
        foldRows(image, begin, end, sums, differences);
        const auto first = Eigen::Index(3 * begin);
        result.cosine.middleRows(first, sums.rows()).noalias() = sums * cosines;
        result.sine.middleRows(first, sums.rows()).noalias() = differences * sines;
    });
    return result;
}

}  // namespace

Vec3d latLongDirection(double x, double y, int width, int height) {
    PRT_CHECK(width > 0 && height > 0);
    const double longitude = kPi - 2 * kPi * x / width, latitude = kPi / 2 - kPi * y / height;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude),
            std::cos(longitude) * std::cos(latitude)};
}

std::array<double, 2> latLongPoint(const Vec3d& direction, int width, int height) {
    PRT_CHECK(width > 0 && height > 0);
    const double longitude = std::atan2(direction.x(), direction.z());
    const double latitude = std::atan2(direction.y(), std::hypot(direction.x(), direction.z()));
    return {(kPi - longitude) / (2 * kPi) * width, (kPi / 2 - latitude) / kPi * height};
}

double latLongTexelSolidAngle(int y, int width, int height) {
    PRT_CHECK(width > 0 && y >= 0 && y < height);
    // sin(top) − sin(bottom) as a product, which does not cancel.
    const double centre = kPi / 2 - kPi * (y + 0.5) / height;
    return 2 * kPi / width * 2 * std::cos(centre) * std::sin(kPi / (2 * height));
}

EnvironmentSh projectEnvironment(const LatLongView& image, int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, kMaxShOrder);
    PRT_CHECK(image.width > 0 && image.height > 0);
    PRT_CHECK_EQ(image.rgb.size(), size_t(image.width) * size_t(image.height) * 3);
    const FourierRows rows = fourierSums(image, shOrder);

    const size_t count = size_t(shCount(shOrder));
    std::array<std::vector<double>, 3> aboutUp;
    aboutUp.fill(std::vector<double>(count, 0.0));
    std::vector<double> legendre(size_t(legendreCount(shOrder)));
    for (int y = 0; y < image.height; ++y) {
        evalShLegendre(shOrder, std::sin(kPi / 2 - kPi * (y + 0.5) / image.height), legendre);
        const double solidAngle = latLongTexelSolidAngle(y, image.width, image.height);
        for (int c = 0; c < 3; ++c)
            for (int l = 0; l < shOrder; ++l)
                for (int m = 0; m <= l; ++m) {
                    const double factor = solidAngle * legendre[size_t(legendreIndex(l, m))];
                    aboutUp[size_t(c)][size_t(shIndex(l, m))] += factor * rows.cosine(3 * y + c, m);
                    if (m > 0) aboutUp[size_t(c)][size_t(shIndex(l, -m))] += factor * rows.sine(3 * y + c, m);
                }
    }

    // There (x', y', z') = (z, x, y), so that azimuth is longitude: the cyclic exchange of axes leads back.
    Mat3d worldFromImage;
    worldFromImage << 0, 1, 0, 0, 0, 1, 1, 0, 0;
    EnvironmentSh result;
    result.shOrder = shOrder;
    for (size_t c = 0; c < 3; ++c) {
        std::vector<double>& v = aboutUp[c];
        rotateSh(worldFromImage, shOrder, std::span<const double>(v), std::span<double>(v));
        result.rgb[c].assign(v.begin(), v.end());
    }
    return result;
}

EnvironmentSh rotateEnvironmentAboutUp(const EnvironmentSh& environment, double angleRad) {
    EnvironmentSh result = environment;
    const Mat3d rotation = rotationAboutUp(angleRad);
    for (std::vector<float>& v : result.rgb)
        rotateSh(rotation, environment.shOrder, std::span<const float>(v), std::span<float>(v));
    return result;
}

EnvironmentSh blendEnvironments(std::span<const EnvironmentSh> environments,
                                std::span<const double> weights) {
    PRT_CHECK_EQ(environments.size(), weights.size());
    PRT_CHECK_LT(size_t(0), environments.size());
    EnvironmentSh result;
    result.shOrder = environments[0].shOrder;
    const size_t count = size_t(shCount(result.shOrder));
    for (size_t c = 0; c < 3; ++c) {
        std::vector<double> sum(count, 0.0);
        for (size_t k = 0; k < environments.size(); ++k) {
            PRT_CHECK_EQ(environments[k].shOrder, result.shOrder);
            PRT_CHECK_EQ(environments[k].rgb[c].size(), count);
            for (size_t i = 0; i < count; ++i) sum[i] += weights[k] * double(environments[k].rgb[c][i]);
        }
        result.rgb[c].assign(sum.begin(), sum.end());
    }
    return result;
}

}  // namespace prt
