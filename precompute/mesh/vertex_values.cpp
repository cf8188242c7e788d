// Sources: [Kavan2011] least squares over the surface in place of point samples at vertices.
#include "precompute/mesh/vertex_values.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/topology.h"

namespace prt {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Point = Eigen::Vector2d;  // of the atlas, texels

constexpr double kSmoothness = 1e-5, kSmoothnessUnseen = 1e-2;
constexpr double kTowardsZero = 1e-12;  // for pieces without any sample
constexpr int kMostCuts = 256;          // of an edge of a triangle

// Ids of vertices that share position and normal, in order of appearance.
std::vector<uint32_t> sharedIds(const Scene& scene, uint32_t& count) {
    const size_t vertices = scene.vertexCount();
    const auto key = [&](uint32_t v) {
        const Vec3f &p = scene.positions[v], &n = scene.normals[v];
        return std::tuple(p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
    };
    std::vector<uint32_t> order(vertices), ids(vertices);
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    count = 0;
    for (size_t i = 0; i < vertices; ++i) {
        if (i > 0 && key(order[i]) != key(order[i - 1])) ++count;
        ids[order[i]] = count;
    }
    if (vertices > 0) ++count;
    return ids;
}

// What one triangle adds: Σ b bᵀ and Σ b f over its samples, which stand for its area.
struct Element {
    std::array<double, 6> matrix{};  // 00 01 02 11 12 22
    std::vector<double> right;       // [3×perPoint]
    double area = 0, seen = 0;       // seen: share of the samples that count
};

class Sampler {
  public:
    Sampler(const Scene& scene, int width, int height, std::span<const uint8_t> counts,
            std::span<const float> values, size_t perPoint)
        : scene_(scene),
          width_(width),
          height_(height),
          counts_(counts),
          values_(values),
          perPoint_(perPoint) {}

    Element element(size_t triangle) const {
        const uint32_t* corners = &scene_.indices[3 * triangle];
        Element sum;
        sum.right.resize(3 * perPoint_);
        sum.area = 0.5 * triangleCross(scene_.positions[corners[0]], scene_.positions[corners[1]],
                                       scene_.positions[corners[2]])
                             .norm();
        if (!(sum.area > 0)) return sum;
        Point uv[3];
        double longest = 0;
        for (int k = 0; k < 3; ++k)
            uv[k] = scene_.uv1[corners[k]].cast<double>().cwiseProduct(Point(width_, height_));
        for (int k = 0; k < 3; ++k) longest = std::max(longest, (uv[(k + 1) % 3] - uv[k]).norm());
        const int cuts = std::clamp(int(std::ceil(longest)), 2, kMostCuts);
        size_t counted = 0;
        for (int i = 0; i < cuts; ++i)
            for (int j = 0; i + j < cuts; ++j)
                for (int half = 0; half < (i + j + 1 < cuts ? 2 : 1); ++half) {
                    // Middles of the pieces that point up and down.
                    const double a = (i + (half ? 2.0 : 1.0) / 3) / cuts,
                                 b = (j + (half ? 2.0 : 1.0) / 3) / cuts;
                    counted += addSample({1 - a - b, a, b}, uv, sum);
                }
        const double share = sum.area / (double(cuts) * cuts);
        for (double& value : sum.matrix) value *= share;
        for (double& value : sum.right) value *= share;
        sum.seen = double(counted) / (double(cuts) * cuts);
        return sum;
    }

  private:
    bool addSample(const std::array<double, 3>& b, const Point* uv, Element& sum) const {
        const Point place = b[0] * uv[0] + b[1] * uv[1] + b[2] * uv[2];
        const int nearX = std::clamp(int(std::floor(place.x())), 0, width_ - 1),
                  nearY = std::clamp(int(std::floor(place.y())), 0, height_ - 1);
        if (!counts_[size_t(nearY) * size_t(width_) + size_t(nearX)]) return false;
        const double x = place.x() - 0.5, y = place.y() - 0.5;
        const double fx = x - std::floor(x), fy = y - std::floor(y);
        const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
        const float* texels[4];
        for (int k = 0; k < 4; ++k) {
            const int tx = std::clamp(int(std::floor(x)) + k % 2, 0, width_ - 1),
                      ty = std::clamp(int(std::floor(y)) + k / 2, 0, height_ - 1);
            texels[k] = &values_[(size_t(ty) * size_t(width_) + size_t(tx)) * perPoint_];
        }
        for (size_t c = 0; c < perPoint_; ++c) {
            double value = 0;
            for (int k = 0; k < 4; ++k) value += weights[k] * double(texels[k][c]);
            for (size_t k = 0; k < 3; ++k) sum.right[k * perPoint_ + c] += b[k] * value;
        }
        const double products[6] = {b[0] * b[0], b[0] * b[1], b[0] * b[2],
                                    b[1] * b[1], b[1] * b[2], b[2] * b[2]};
        for (size_t k = 0; k < 6; ++k) sum.matrix[k] += products[k];
        return true;
    }

    const Scene& scene_;
    const int width_, height_;
    const std::span<const uint8_t> counts_;
    const std::span<const float> values_;
    const size_t perPoint_;
};

void addElement(const Element& element, const std::array<uint32_t, 3>& ids,
                std::vector<Eigen::Triplet<double>>& entries) {
    const double smooth =
        element.area * (kSmoothness + (kSmoothnessUnseen - kSmoothness) * (1 - element.seen));
    size_t at = 0;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = i; j < 3; ++j) {
            const double value = element.matrix[at++] + smooth * (i == j ? 2 : -1);
            const uint32_t row = std::max(ids[i], ids[j]), column = std::min(ids[i], ids[j]);
            // The lower half is kept; of an edge between two copies of one vertex both halves are on the
            // diagonal.
            entries.emplace_back(int(row), int(column), i != j && row == column ? 2 * value : value);
        }
}

}  // namespace

std::vector<float> fitVertexValues(const Scene& scene, int width, int height, std::span<const uint8_t> counts,
                                   std::span<const float> values, size_t perPoint) {
    PRT_CHECK_EQ(scene.uv1.size(), scene.vertexCount());
    PRT_CHECK_EQ(scene.normals.size(), scene.vertexCount());
    PRT_CHECK_EQ(counts.size(), size_t(width) * size_t(height));
    PRT_CHECK_EQ(values.size(), counts.size() * perPoint);
    PRT_CHECK_LT(0u, perPoint);
    uint32_t unknowns = 0;
    const std::vector<uint32_t> ids = sharedIds(scene, unknowns);
    const Sampler sampler(scene, width, height, counts, values, perPoint);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, Eigen::Index(perPoint));
    double area = 0;
    // Elements are made by all threads and summed by one, in order.
    constexpr size_t kBlock = 4096;
    for (size_t first = 0; first < scene.triangleCount(); first += kBlock) {
        throwIfInterrupted();
        std::vector<Element> elements(std::min(kBlock, scene.triangleCount() - first));
        parallelFor(elements.size(), 64, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) elements[i] = sampler.element(first + i);
        });
        for (size_t i = 0; i < elements.size(); ++i) {
            std::array<uint32_t, 3> corners{};
            for (size_t k = 0; k < 3; ++k) corners[k] = ids[scene.indices[3 * (first + i) + k]];
            addElement(elements[i], corners, entries);
            area += elements[i].area;
            for (size_t k = 0; k < 3; ++k)
                for (size_t c = 0; c < perPoint; ++c)
                    right(corners[k], Eigen::Index(c)) += elements[i].right[k * perPoint + c];
        }
    }
    const double ground = kTowardsZero * (area > 0 ? area / double(std::max(unknowns, 1u)) : 1);
    for (uint32_t v = 0; v < unknowns; ++v) entries.emplace_back(int(v), int(v), ground);
    Matrix matrix{int(unknowns), int(unknowns)};
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Matrix> solver(matrix);
    PRT_CHECK_EQ(int(solver.info()), int(Eigen::Success));

    std::vector<float> result(scene.vertexCount() * perPoint);
    for (size_t c = 0; c < perPoint; ++c) {
        throwIfInterrupted();
        const Eigen::VectorXd solution = solver.solve(right.col(Eigen::Index(c)));
        for (size_t v = 0; v < ids.size(); ++v) result[v * perPoint + c] = float(solution[ids[v]]);
    }
    return result;
}

}  // namespace prt
