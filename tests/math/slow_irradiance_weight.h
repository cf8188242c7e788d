// What math/irradiance_weight.h computes, by its definition: slow and obvious.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "precompute/math/irradiance_weight.h"
#include "precompute/math/sh.h"

namespace prt::slow {

/// w by the definition: rings of shading normals over the cap, midpoints in height and azimuth.
inline double irradianceWeight(const Vec3d& normal, const Vec3d& direction,
                               const IrradianceWeight& weight = {}, int rings = 40, int azimuths = 80) {
    const Vec3d n = normal.normalized();
    const Vec3d t = n.unitOrthogonal(), b = n.cross(t);
    const double low = std::cos(weight.coneDegrees * M_PI / 180);
    double sum = 0, largest = 0;
    for (int i = 0; i < rings; ++i) {
        const double z = low + (1 - low) * (i + 0.5) / rings, r = std::sqrt(1 - z * z);
        largest += z * z;
        for (int j = 0; j < azimuths; ++j) {
            const double phi = 2 * M_PI * (j + 0.5) / azimuths;
            const Vec3d shading = z * n + r * std::cos(phi) * t + r * std::sin(phi) * b;
            sum += std::pow(std::max(0.0, shading.dot(direction)), 2);
        }
    }
    return sum / (rings * azimuths) + weight.floor * largest / rings;
}

/// ∫ w Y_i Y_j by quadrature.
inline Eigen::MatrixXd irradianceMetric(const Vec3d& normal, int shOrder,
                                        const IrradianceWeight& weight = {}) {
    const int dimension = shCount(shOrder);
    Eigen::MatrixXd metric = Eigen::MatrixXd::Zero(dimension, dimension);
    std::vector<double> y(static_cast<size_t>(dimension));
    for (const SphereNode& node : sphereQuadrature(47)) {
        evalSh(shOrder, node.direction, y);
        const Eigen::Map<const Eigen::VectorXd> values(y.data(), dimension);
        metric +=
            node.weightSr * irradianceWeight(normal, node.direction, weight) * values * values.transpose();
    }
    return metric;
}

}  // namespace prt::slow
