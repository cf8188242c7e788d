// Expansions weighted for irradiance: the least squares they claim to be, and the constraint they keep.
#include "precompute/math/irradiance_projection.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "precompute/math/clamped_cosine.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_rotation.h"
#include "tests/math/slow_irradiance_weight.h"

namespace prt {
namespace {

constexpr double kPi = M_PI;

// b, E and errors of a function that is given at quadrature nodes, about one normal.
class Samples {
  public:
    Samples(const Vec3f& normal, const IrradianceWeight& weight,
            const std::function<double(const Vec3d&)>& function) {
        const Vec3d n = normal.cast<double>().normalized();
        for (const SphereNode& node : sphereQuadrature(40)) {
            const double cosine = node.direction.dot(n);
            nodes_.push_back(
                {node, irradianceWeight(cosine, weight), std::max(0.0, cosine), function(node.direction)});
        }
    }
    // ∫ w f Y
    Eigen::VectorXd weighted(int shOrder) const {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(shCount(shOrder)), y(sum.size());
        for (const Node& node : nodes_) {
            evalSh(shOrder, node.place.direction, std::span<double>(y.data(), size_t(y.size())));
            sum += node.place.weightSr * node.value * node.weight * y;
        }
        return sum;
    }
    double irradiance() const {
        double sum = 0;
        for (const Node& node : nodes_) sum += node.place.weightSr * node.value * node.cosine;
        return sum;
    }
    // ∫ w (c·Y − f)²
    double error(int shOrder, const Eigen::VectorXd& c) const {
        double sum = 0;
        Eigen::VectorXd y(c.size());
        for (const Node& node : nodes_) {
            evalSh(shOrder, node.place.direction, std::span<double>(y.data(), size_t(y.size())));
            sum += node.place.weightSr * node.weight * std::pow(y.dot(c) - node.value, 2);
        }
        return sum;
    }

  private:
    struct Node {
        SphereNode place;
        double weight, cosine, value;
    };
    std::vector<Node> nodes_;
};

// Visible above the horizon of n but for a cap.
Samples cappedHemisphere(const Vec3f& n, const IrradianceWeight& weight) {
    const Vec3d blocker = Vec3d(0.5, 0.7, -0.3).normalized();
    return Samples(n, weight, [=](const Vec3d& d) {
        return d.dot(n.cast<double>()) > 0 && d.dot(blocker) < 0.6 ? 1.0 : 0.0;
    });
}

Eigen::VectorXd cosineOf(const Vec3f& normal, int shOrder) {
    std::vector<float> cosine(size_t(shCount(shOrder)));
    evalClampedCosineSh(shOrder, normal, cosine);
    return Eigen::Map<const Eigen::VectorXf>(cosine.data(), shCount(shOrder)).cast<double>();
}

Eigen::VectorXd solve(const IrradianceProjection& projection, const Vec3f& normal, const Eigen::VectorXd& b,
                      double irradiance) {
    const Eigen::VectorXf in = b.cast<float>();
    Eigen::VectorXf out(b.size());
    projection.solve(normal, {in.data(), size_t(in.size())}, float(irradiance),
                     {out.data(), size_t(out.size())});
    return out.cast<double>();
}

const std::vector<Vec3f> kNormals = {Vec3f(0, 0, 1), Vec3f(0, 0, -1), Vec3f(0, 1, 0),
                                     Vec3f(0.6f, -0.48f, 0.64f)};
// Both the path in float and the one in double.
const std::vector<IrradianceWeight> kWeights = {{}, {35, 0.002}, {40, 2e-5}};

TEST(IrradianceProjection, EqualsDenseNormalEquations) {
    // Lagrange: [A h; hᵀ 0] [c; λ] = [b; E].
    for (const IrradianceWeight& weight : kWeights)
        for (const Vec3f& normal : kNormals) {
            const Vec3d n = normal.cast<double>().normalized();
            const Samples samples = cappedHemisphere(normal, weight);
            for (const int shOrder : {1, 2, 4, 6}) {
                const int d = shCount(shOrder);
                const Eigen::VectorXd b = samples.weighted(shOrder), h = cosineOf(normal, shOrder);
                const double e = samples.irradiance();
                // The series of w is as good as w itself in products of two functions.
                Eigen::MatrixXd system = Eigen::MatrixXd::Zero(d + 1, d + 1);
                const std::vector<double> zonal = irradianceWeightZonal(2 * shOrder - 1, weight);
                std::vector<double> y(static_cast<size_t>(shCount(2 * shOrder - 1)));
                for (const SphereNode& node : sphereQuadrature(4 * shOrder)) {
                    const double z = node.direction.dot(n);
                    evalSh(2 * shOrder - 1, Vec3d(std::sqrt(std::max(0.0, 1 - z * z)), 0, z), y);
                    double w = 0;
                    for (int l = 0; l < 2 * shOrder - 1; ++l)
                        w += zonal[size_t(l)] * y[size_t(shIndex(l, 0))];
                    evalSh(shOrder, node.direction, std::span(y).first(size_t(d)));
                    const Eigen::Map<const Eigen::VectorXd> values(y.data(), d);
                    system.topLeftCorner(d, d) += node.weightSr * w * values * values.transpose();
                }
                system.col(d).head(d) = h;
                system.row(d).head(d) = h.transpose();
                Eigen::VectorXd right(d + 1);
                right << b, e;
                const Eigen::VectorXd expected = system.ldlt().solve(right).head(d);
                const Eigen::VectorXd c = solve(IrradianceProjection(shOrder, weight), normal, b, e);
                // b comes in float: what that leaves of c is amplified by up to 1/floor.
                EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 2e-7 / weight.floor + 1e-5)
                    << shOrder << " " << normal.transpose();
                EXPECT_LT((system.topLeftCorner(d, d) * (c - expected)).cwiseAbs().maxCoeff(), 3e-6);
            }
        }
}

TEST(IrradianceProjection, KeepsTheConstraintAndMinimisesTheWeightedError) {
    std::mt19937 random(3);
    std::normal_distribution<double> gauss;
    for (const IrradianceWeight& weight : kWeights)
        for (const Vec3f& normal : kNormals) {
            const Samples samples = cappedHemisphere(normal, weight);
            for (const int shOrder : {2, 3, 5}) {
                const double e = samples.irradiance();
                const Eigen::VectorXd h = cosineOf(normal, shOrder);
                const Eigen::VectorXd c =
                    solve(IrradianceProjection(shOrder, weight), normal, samples.weighted(shOrder), e);
                EXPECT_NEAR(c.dot(h), e, 2e-6 * (1 + c.norm()));
                const double least = samples.error(shOrder, c);
                for (int k = 0; k < 5; ++k) {
                    Eigen::VectorXd step(c.size());
                    for (double& value : step) value = gauss(random);
                    step -= step.dot(h) / h.squaredNorm() * h;  // keeps the constraint
                    step *= 0.1 / step.norm();
                    EXPECT_GT(samples.error(shOrder, c + step), least);
                    EXPECT_GT(samples.error(shOrder, c - step), least);
                }
            }
        }
}

TEST(IrradianceProjection, OpenPointsReceiveAllOfConstantLight) {
    for (const Vec3f& normal : kNormals) {
        const Samples samples(normal, {},
                              [&](const Vec3d& d) { return d.dot(normal.cast<double>()) > 0 ? 1.0 : 0.0; });
        for (int shOrder = 1; shOrder <= kMaxBundleShOrder; ++shOrder) {
            const Eigen::VectorXd c =
                solve(IrradianceProjection(shOrder), normal, samples.weighted(shOrder), kPi);
            EXPECT_NEAR(c.dot(cosineOf(normal, shOrder)), kPi, 1e-5 * kPi) << shOrder;
        }
    }
}

TEST(IrradianceProjection, ReturnsExpansionsOfItsOwnOrder) {
    // A band-limited function is its own best expansion.
    std::mt19937 random(5);
    std::normal_distribution<double> gauss;
    for (const int shOrder : {1, 3, 6, kMaxBundleShOrder}) {
        const IrradianceProjection projection(shOrder);
        for (const Vec3f& normal : kNormals) {
            Eigen::VectorXf c(shCount(shOrder)), b(c.size());
            for (float& value : c) value = float(gauss(random));
            const std::span<float> weighted(b.data(), size_t(b.size()));
            projection.weigh(normal, {c.data(), size_t(c.size())}, weighted);
            const double irradiance = c.cast<double>().dot(cosineOf(normal, shOrder));
            projection.solve(normal, weighted, float(irradiance), weighted);  // in place
            EXPECT_LT((b - c).norm(), 1e-3f * c.norm()) << shOrder;
        }
    }
}

TEST(IrradianceProjection, LocalAndWorldFramesAgree) {
    const int shOrder = 5, d = shCount(shOrder);
    const IrradianceProjection projection(shOrder);
    const Eigen::VectorXd b = cappedHemisphere(Vec3f(0, 0, 1), {}).weighted(shOrder);
    Eigen::VectorXd local(d);
    projection.solveLocal({b.data(), size_t(d)}, 2.5, {local.data(), size_t(d)});
    EXPECT_LT((local - solve(projection, Vec3f(0, 0, 1), b, 2.5)).cwiseAbs().maxCoeff(), 1e-3);
    // Turning the input turns the output.
    const Mat3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().toRotationMatrix();
    Eigen::VectorXd turned(d), expected(d);
    rotateSh(turn, shOrder, std::span<const double>(b.data(), size_t(d)),
             std::span<double>(turned.data(), size_t(d)));
    rotateSh(turn, shOrder, std::span<const double>(local.data(), size_t(d)),
             std::span<double>(expected.data(), size_t(d)));
    const Vec3f normal = (turn * Vec3d(0, 0, 1)).cast<float>();
    EXPECT_LT((solve(projection, normal, turned, 2.5) - expected).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(IrradianceProjection, CutAtTheHorizonIsTheProjectionOfTheUpperHalf) {
    std::mt19937 random(7);
    std::normal_distribution<double> gauss;
    for (const int shOrder : {1, 2, 5, kMaxBundleShOrder})
        for (const Vec3f& normal : kNormals) {
            const Vec3d n = normal.cast<double>().normalized();
            Eigen::VectorXf c(shCount(shOrder)), cut(c.size());
            for (float& value : c) value = float(gauss(random));
            IrradianceProjection(shOrder).cutAtHorizon(normal, {c.data(), size_t(c.size())},
                                                       {cut.data(), size_t(cut.size())});
            // Exact quadrature over the half: about n in height, the trapezoid rule in azimuth.
            Eigen::VectorXd expected = Eigen::VectorXd::Zero(c.size()), y(c.size());
            const Vec3d t = n.unitOrthogonal(), b = n.cross(t);
            const std::vector<SphereNode> nodes = sphereQuadrature(4 * shOrder);
            for (const SphereNode& node : nodes) {  // z of [−1, 1] to [0, 1]
                const double z = (node.direction.z() + 1) / 2;
                const double phi = std::atan2(node.direction.y(), node.direction.x());
                const double r = std::sqrt(1 - z * z);
                const Vec3d direction = z * n + r * (std::cos(phi) * t + std::sin(phi) * b);
                evalSh(shOrder, direction, std::span<double>(y.data(), size_t(y.size())));
                expected += node.weightSr / 2 * y.dot(c.cast<double>()) * y;
            }
            EXPECT_LT((cut.cast<double>() - expected).cwiseAbs().maxCoeff(), 2e-5) << shOrder;
        }
}

TEST(IrradianceProjectionDeath, SizesThatDoNotFitAndNormalsThatAreNone) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const IrradianceProjection projection(3);
    std::vector<float> nine(9), eight(8);
    EXPECT_DEATH(projection.solve(Vec3f(0, 0, 1), eight, 1, nine), "count");
    EXPECT_DEATH(projection.solve(Vec3f(0, 0, 2), nine, 1, nine), "isUnit");
    EXPECT_DEATH(IrradianceProjection(kMaxBundleShOrder + 1), "shOrder");
}

TEST(IrradianceProjection, ManyAreEachOfThem) {
    std::mt19937 random(6);
    std::normal_distribution<float> gauss;
    for (const int order : {1, 4, 6, 10})
        for (const double floor : {1e-4, 1e-3, 1e-6})  // the last in double
            for (const size_t count : {1u, 16u, 23u}) {
                const IrradianceProjection projection(order, {40, floor});
                const size_t columns = size_t(shCount(order)), stride = 32;
                std::vector<Vec3f> normals;
                std::vector<float> many(columns * stride, 5.0f), irradiance;
                std::vector<std::vector<float>> single(count, std::vector<float>(columns));
                for (size_t k = 0; k < count; ++k) {
                    normals.push_back(Vec3f(gauss(random), gauss(random), gauss(random)).normalized());
                    irradiance.push_back(std::abs(gauss(random)));
                    for (size_t c = 0; c < columns; ++c) many[c * stride + k] = single[k][c] = gauss(random);
                }
                projection.solveSoa(normals, stride, many, irradiance, many);
                for (size_t k = 0; k < count; ++k) {
                    std::vector<float> expected(columns);
                    projection.solve(normals[k], single[k], irradiance[k], expected);
                    float largest = 0;
                    for (const float value : expected) largest = std::max(largest, std::abs(value));
                    for (size_t c = 0; c < columns; ++c)
                        EXPECT_NEAR(many[c * stride + k], expected[c], 2e-5f * largest) << order;
                }
            }
}

}  // namespace
}  // namespace prt
