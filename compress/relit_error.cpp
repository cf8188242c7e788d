// Irradiance of visibility under environments [IwanickiSloan2012, Eq. 4], evaluated at normals without
// tables.
#include "compress/relit_error.h"

#include <cmath>
#include <numbers>

#include "compress/tables/normal_tables.h"
#include "precompute/base/check.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"

namespace prt {
namespace {

constexpr size_t kNormals = 5;
constexpr float kTiltRad = 20 * float(std::numbers::pi) / 180;

// The normal, and four about it.
void addShadingNormals(const Vec3f& normal, std::vector<Vec3f>& normals) {
    const Frame frame = frameAround(normal);
    normals.push_back(normal);
    const float c = std::cos(kTiltRad), s = std::sin(kTiltRad);
    for (const float sign : {-1.0f, 1.0f}) {
        normals.push_back(c * normal + sign * s * frame.tangent);
        normals.push_back(c * normal + sign * s * frame.bitangent);
    }
}

}  // namespace

RelitProbe::RelitProbe(int shOrder, std::span<const Vec3f> normals, std::span<const uint8_t> use,
                       std::span<const EnvironmentSh> environments, size_t mostPoints)
    : shOrder_(shOrder) {
    PRT_CHECK(!environments.empty());
    PRT_CHECK_LE(size_t(1), mostPoints);
    PRT_CHECK(use.empty() || use.size() == normals.size());
    std::vector<uint32_t> candidates;
    for (uint32_t i = 0; i < normals.size(); ++i) {
        const float square = normals[i].squaredNorm();
        if ((use.empty() || use[i]) && square > 0.5f && square < 2) candidates.push_back(i);
    }
    const size_t count = std::min(mostPoints, candidates.size());
    std::vector<Vec3f> shading;
    for (size_t k = 0; k < count; ++k) {
        points_.push_back(candidates[k * candidates.size() / count]);
        addShadingNormals(normals[points_.back()].normalized(), shading);
    }
    for (const EnvironmentSh& environment : environments)
        light_.push_back(evalLightCosine(environment, shOrder, shading));
}

std::vector<double> RelitProbe::relativeRmse(std::span<const float> rows,
                                             std::span<const float> others) const {
    const size_t columns = size_t(shCount(shOrder_)), lookups = points_.size() * kNormals;
    PRT_CHECK_EQ(rows.size(), points_.size() * columns);
    PRT_CHECK_EQ(others.size(), rows.size());
    std::vector<double> errors;
    for (const std::vector<float>& light : light_) {
        double error = 0, square = 0;
        for (size_t colour = 0; colour < 3; ++colour)
            for (size_t j = 0; j < lookups; ++j) {
                const float *row = &rows[j / kNormals * columns], *other = &others[j / kNormals * columns];
                double irradiance = 0, difference = 0;
                for (size_t c = 0; c < columns; ++c) {
                    const double r = double(light[(colour * columns + c) * lookups + j]);
                    irradiance += r * double(row[c]);
                    difference += r * (double(other[c]) - double(row[c]));
                }
                error += difference * difference;
                square += irradiance * irradiance;
            }
        errors.push_back(square > 0 ? std::sqrt(error / square) : 0);
    }
    return errors;
}

}  // namespace prt
