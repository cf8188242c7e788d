// Latitude-longitude environments and their projection. In a frame whose pole is the image's (up) the basis
// is separable: Fourier sums along rows, Legendre functions down the columns; one exact rotation then brings
// the coefficients to the project's frame. [Driscoll1994] "Computing Fourier transforms and convolutions on
// the 2-sphere" has the idea; the sum is the plain one over texel centres.
#include "precompute/math/environment.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "precompute/base/check.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_legendre.h"
#include "precompute/math/sh_rotation.h"

namespace prt {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kLanes = 8;  // partial sums, as wide as the widest registers

/// A row about its symmetries. Columns x and w − 1 − x lie at longitudes λ and −λ: cosines see their sum,
/// sines their difference. Where w is even, λ and π − λ are columns, too, whose cos(mλ) and sin(mλ) differ by
/// the sign alone, so that even and odd m have their own sums over a quarter.
struct FoldedRow {
    FoldedRow(int imageWidth) : width(size_t(imageWidth)), half((width + 1) / 2) {
        columns = width % 2 == 0 ? (half + 1) / 2 : half;
        // One more than needed: rows a power of two apart would share sets of the cache.
        stride = (columns + kLanes - 1) / kLanes * kLanes + kLanes;
        colourStride = width + 2 * kLanes;
        colours.resize(3 * colourStride);
        halves.resize(2 * half);
        sums.resize(12 * stride);
    }
    /// Sums that cos(mλ) (sine: sin(mλ)) meets, m even or odd, of a colour.
    double* of(bool sine, bool odd, size_t colour) {
        return sums.data() + ((sine ? 6 : 0) + (odd ? 3 : 0) + colour) * stride;
    }
    size_t width, half, columns, stride, colourStride;
    std::vector<float> colours;  ///< [3×colourStride]
    std::vector<double> halves;  ///< [2×half] sums and differences of a colour
    std::vector<double> sums;    ///< [12×stride], zero beyond `columns`
};

PRT_TARGET_CLONES void splitColours(const float* rgb, size_t width, float* colours, size_t stride) {
    for (size_t x = 0; x < width; ++x) {
        colours[x] = rgb[3 * x];
        colours[stride + x] = rgb[3 * x + 1];
        colours[2 * stride + x] = rgb[3 * x + 2];
    }
}

/// Sums and differences of values that lie mirrored in the middle; one in the middle counts once.
template <typename In>
inline void foldInto(const In* in, size_t count, double* sums, double* differences) {
    const size_t pairs = count / 2;
    for (size_t x = 0; x < pairs; ++x) {
        const double a = double(in[x]), b = double(in[count - 1 - x]);
        sums[x] = a + b;
        differences[x] = a - b;
    }
    if (count % 2 == 1) sums[pairs] = differences[pairs] = double(in[pairs]);
}
PRT_TARGET_CLONES void foldFloats(const float* in, size_t count, double* sums, double* differences) {
    foldInto(in, count, sums, differences);
}
PRT_TARGET_CLONES void foldDoubles(const double* in, size_t count, double* sums, double* differences) {
    foldInto(in, count, sums, differences);
}

void foldRow(const float* rgb, FoldedRow& row) {
    splitColours(rgb, row.width, row.colours.data(), row.colourStride);
    double* sums = row.halves.data();
    double* differences = sums + row.half;
    for (size_t c = 0; c < 3; ++c) {
        foldFloats(row.colours.data() + c * row.colourStride, row.width, sums, differences);
        // The middle of an odd row is at longitude 0, where every sine is 0.
        if (row.width % 2 == 0) {
            foldDoubles(sums, row.half, row.of(false, false, c), row.of(false, true, c));
            foldDoubles(differences, row.half, row.of(true, true, c), row.of(true, false, c));
        } else {
            for (const bool odd : {false, true}) {
                std::copy_n(sums, row.half, row.of(false, odd, c));
                std::copy_n(differences, row.half, row.of(true, odd, c));
            }
        }
    }
}

/// kLanes doubles, in as many registers as the machine needs.
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

/// Three dot products with one table.
/// @param values  [3×stride]     @param stride  a multiple of kLanes
PRT_TARGET_CLONES void dotThree(const double* table, const double* values, size_t stride, double out[3]) {
    Lanes r{}, g{}, b{};
    for (size_t x = 0; x < stride; x += kLanes) {
        Lanes factor, red, green, blue;
        std::memcpy(&factor, table + x, sizeof factor);
        std::memcpy(&red, values + x, sizeof red);
        std::memcpy(&green, values + stride + x, sizeof green);
        std::memcpy(&blue, values + 2 * stride + x, sizeof blue);
        r += factor * red;
        g += factor * green;
        b += factor * blue;
    }
    out[0] = out[1] = out[2] = 0;
    for (size_t k = 0; k < kLanes; ++k) {
        out[0] += r[k];
        out[1] += g[k];
        out[2] += b[k];
    }
}

/// Σ_x L cos(mλ) and Σ_x L sin(mλ) of every row.
class FourierRows {
  public:
    FourierRows(const LatLongView& image, int shOrder) : order_(size_t(shOrder)) {
        const FoldedRow shape(image.width);
        std::vector<double> tables(2 * order_ * shape.stride, 0.0);
        for (size_t m = 0; m < order_; ++m)
            for (size_t x = 0; x < shape.columns; ++x) {
                const double longitude = kPi - 2 * kPi * (double(x) + 0.5) / image.width;
                tables[m * shape.stride + x] = std::cos(double(m) * longitude);
                tables[(order_ + m) * shape.stride + x] = std::sin(double(m) * longitude);
            }
        values_.resize(size_t(image.height) * 6 * order_);
        parallelFor(size_t(image.height), 16, [&](size_t begin, size_t end) {
            FoldedRow row(image.width);
            for (size_t y = begin; y < end; ++y) {
                foldRow(image.rgb.data() + y * row.width * 3, row);
                for (size_t i = 0; i < 2 * order_; ++i)
                    dotThree(tables.data() + i * row.stride, row.of(i >= order_, (i % order_) % 2 == 1, 0),
                             row.stride, values_.data() + (y * 2 * order_ + i) * 3);
            }
        });
    }
    /// [3] colours
    const double* cosine(int y, int m) const { return at(y, size_t(m)); }
    const double* sine(int y, int m) const { return at(y, order_ + size_t(m)); }

  private:
    const double* at(int y, size_t i) const { return values_.data() + (size_t(y) * 2 * order_ + i) * 3; }

    size_t order_;
    std::vector<double> values_;  // [height × 2·shOrder × 3]
};

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
    const FourierRows rows(image, shOrder);

    const size_t count = size_t(shCount(shOrder));
    std::array<std::vector<double>, 3> aboutUp;
    aboutUp.fill(std::vector<double>(count, 0.0));
    std::vector<double> legendre(size_t(legendreCount(shOrder)));
    for (int y = 0; y < image.height; ++y) {
        evalShLegendre(shOrder, std::sin(kPi / 2 - kPi * (y + 0.5) / image.height), legendre);
        const double solidAngle = latLongTexelSolidAngle(y, image.width, image.height);
        for (int l = 0; l < shOrder; ++l)
            for (int m = 0; m <= l; ++m) {
                const double factor = solidAngle * legendre[size_t(legendreIndex(l, m))];
                for (size_t c = 0; c < 3; ++c) {
                    aboutUp[c][size_t(shIndex(l, m))] += factor * rows.cosine(y, m)[c];
                    if (m > 0) aboutUp[c][size_t(shIndex(l, -m))] += factor * rows.sine(y, m)[c];
                }
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
