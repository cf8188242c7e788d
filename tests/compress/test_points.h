// Visibility that tests compress, made by quadrature.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "precompute/math/irradiance_projection.h"
#include "precompute/math/sh.h"

namespace prt {

// Rows of visibility: caps that block, cut at the horizon of the normal.
struct Points {
    std::vector<float> rows;
    std::vector<Vec3f> normals;
};
/// @param projection  about each row's normal
inline Points testPoints(int shOrder, size_t count, unsigned seed, size_t distinctNormals,
                         const Projection& projection = kPlainProjection) {
    const IrradianceProjection weighted(shOrder, projection.weight);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    const auto direction = [&] {
        return Vec3f(Vec3f(normal(random), normal(random), normal(random)).normalized());
    };
    std::vector<Vec3f> choices(distinctNormals);
    for (Vec3f& choice : choices) choice = direction();
    const std::vector<SphereNode> nodes = sphereQuadrature(2 * shOrder + 6);
    const size_t dimension = size_t(shCount(shOrder));
    std::vector<std::vector<double>> y(nodes.size(), std::vector<double>(dimension));
    for (size_t k = 0; k < nodes.size(); ++k) evalSh(shOrder, nodes[k].direction, y[k]);
    Points points;
    for (size_t i = 0; i < count; ++i) {
        const Vec3f n = choices[random() % distinctNormals], blocker = direction();
        const float size = std::abs(normal(random)) * 0.5f;
        std::vector<double> row(dimension, 0.0);
        double irradiance = 0;
        for (size_t k = 0; k < nodes.size(); ++k) {
            const Vec3f d = nodes[k].direction.cast<float>();
            if (d.dot(n) <= 0 || d.dot(blocker) > size) continue;
            const double cosine = std::min(1.0, double(d.dot(n)));
            const double weight =
                projection.kind == ProjectionKind::Plain ? 1.0 : irradianceWeight(cosine, projection.weight);
            irradiance += nodes[k].weightSr * cosine;
            for (size_t c = 0; c < dimension; ++c) row[c] += nodes[k].weightSr * weight * y[k][c];
        }
        points.normals.push_back(n);
        std::vector<float> values(row.begin(), row.end());
        if (projection.kind == ProjectionKind::Irradiance)
            weighted.solve(n, values, float(irradiance), values);
        points.rows.insert(points.rows.end(), values.begin(), values.end());
    }
    return points;
}

}  // namespace prt
