// Chart growing by a priority queue over face adjacency, after P. Sander, Z. Wood, S. Gortler, J. Snyder,
// H. Hoppe, "Multi-Chart Geometry Images", SGP 2003 (growth by normal deviation and distance, Lloyd
// relaxation), with normal cones instead of a fixed number of charts.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <span>

#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Neighbours flatter than this belong to one flat region, which is charted before its surroundings.
constexpr double kFlatDeg = 2;
/// Weight of distance (in chart radii) against 1 − cos of the normals' angle: keeps charts compact.
constexpr double kDistanceWeight = 0.05;
constexpr int kRelaxations = 2;
/// Beyond this many faces relaxation takes longer than it is worth.
constexpr size_t kLargestRelaxed = 1'500'000;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

struct Candidate {
    float cost;
    uint32_t face, chart;
    bool operator<(const Candidate& o) const {  // the queue's top is the largest
        if (cost != o.cost) return cost > o.cost;
        return face != o.face ? face > o.face : chart > o.chart;
    }
};
using Queue = std::priority_queue<Candidate>;

class Grower {
  public:
    Grower(const AtlasMesh& mesh, double coneAngleDeg)
        : mesh_(mesh), cosCone_(std::cos(radians(coneAngleDeg))) {
        charts_.ofFace.assign(mesh.faces(), kNone);
        seeds_ = seedOrder();
    }

    Charts run() {
        growFromSeeds();
        splitIntoConnected(mesh_, charts_);
        if (mesh_.faces() <= kLargestRelaxed)
            for (int i = 0; i < kRelaxations; ++i) {
                relax();
                growFromSeeds();
                splitIntoConnected(mesh_, charts_);
            }
        return std::move(charts_);
    }

  private:
    std::vector<uint32_t> seedOrder() const;
    void growFromSeeds();
    void growOne(uint32_t seed, uint32_t chart);
    void relax();
    bool inCone(uint32_t face, const Vec3d& mean) const {
        return withinCone(mesh_.normal[face], mean, cosCone_);
    }
    template <class Visit>
    void eachNeighbour(uint32_t face, const Visit& visit) const {
        for (uint32_t h = 3 * face; h < 3 * face + 3; ++h)
            if (mesh_.twin[h] != kNone) visit(mesh_.twin[h] / 3);
    }

    const AtlasMesh& mesh_;
    const double cosCone_;
    std::vector<uint32_t> seeds_;
    Charts charts_;
    size_t steps_ = 0;  ///< of all queues
};

/// Faces by the area of the flat region they lie in, largest first.
std::vector<uint32_t> Grower::seedOrder() const {
    const auto flat = float(std::cos(radians(kFlatDeg)));
    DisjointSets regions(mesh_.faces());
    for (uint32_t h = 0; h < mesh_.twin.size(); ++h) {
        const uint32_t twin = mesh_.twin[h];
        if (twin != kNone && h < twin && mesh_.normal[h / 3].dot(mesh_.normal[twin / 3]) >= flat)
            regions.unite(h / 3, twin / 3);
    }
    std::vector<double> regionArea(mesh_.faces(), 0);
    std::vector<uint32_t> order(mesh_.faces()), region(mesh_.faces());
    for (uint32_t f = 0; f < mesh_.faces(); ++f) {
        order[f] = f;
        region[f] = regions.find(f);
        regionArea[region[f]] += mesh_.area[f];
    }
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const uint32_t ra = region[a], rb = region[b];
        if (ra != rb) return regionArea[ra] != regionArea[rb] ? regionArea[ra] > regionArea[rb] : ra < rb;
        return a < b;
    });
    return order;
}

void Grower::growFromSeeds() {
    for (uint32_t seed : seeds_)
        if (charts_.ofFace[seed] == kNone) growOne(seed, charts_.count++);
}

void Grower::growOne(uint32_t seed, uint32_t chart) {
    Queue queue;
    Vec3d sum(0, 0, 0);
    double area = 0;
    queue.push({0, seed, chart});
    while (!queue.empty()) {
        throwIfInterruptedAt(steps_++);
        const Candidate next = queue.top();
        queue.pop();
        if (charts_.ofFace[next.face] != kNone || (next.face != seed && !inCone(next.face, sum))) continue;
        charts_.ofFace[next.face] = chart;
        sum += mesh_.normal[next.face].cast<double>() * double(mesh_.area[next.face]);
        area += mesh_.area[next.face];
        const double radius = std::sqrt(area), length = std::max(sum.norm(), 1e-300);
        eachNeighbour(next.face, [&](uint32_t face) {
            if (charts_.ofFace[face] != kNone) return;
            const double lean = 1 - mesh_.normal[face].cast<double>().dot(sum) / length;
            const double distance = (mesh_.centroid[face] - mesh_.centroid[seed]).cast<double>().norm();
            queue.push({float(lean + kDistanceWeight * distance / std::max(radius, 1e-300)), face, chart});
        });
    }
}

/// All charts grow again at once, from their middles, each within the cone of the normal it had.
void Grower::relax() {
    const std::vector<Vec3d> mean = meanNormals(mesh_, charts_);
    std::vector<Vec3d> centre(charts_.count, Vec3d(0, 0, 0));
    std::vector<double> area(charts_.count, 0), best(charts_.count, 1e300);
    for (size_t f = 0; f < mesh_.faces(); ++f) {
        centre[charts_.ofFace[f]] += mesh_.centroid[f].cast<double>() * double(mesh_.area[f]);
        area[charts_.ofFace[f]] += mesh_.area[f];
    }
    std::vector<uint32_t> seed(charts_.count, kNone);
    const auto cost = [&](uint32_t face, uint32_t chart) {
        const double lean =
            1 - mesh_.normal[face].cast<double>().dot(mean[chart]) / std::max(mean[chart].norm(), 1e-300);
        const Vec3d middle = centre[chart] / std::max(area[chart], 1e-300);
        const double distance = (mesh_.centroid[face].cast<double>() - middle).norm();
        return lean + kDistanceWeight * distance / std::max(std::sqrt(area[chart]), 1e-300);
    };
    for (uint32_t f = 0; f < mesh_.faces(); ++f) {
        const uint32_t c = charts_.ofFace[f];
        const double value = cost(f, c);
        if (value < best[c]) best[c] = value, seed[c] = f;
    }
    Queue queue;
    for (uint32_t c = 0; c < charts_.count; ++c)
        if (seed[c] != kNone) queue.push({0, seed[c], c});
    std::fill(charts_.ofFace.begin(), charts_.ofFace.end(), kNone);
    while (!queue.empty()) {
        throwIfInterruptedAt(steps_++);
        const Candidate next = queue.top();
        queue.pop();
        if (charts_.ofFace[next.face] != kNone ||
            (next.face != seed[next.chart] && !inCone(next.face, mean[next.chart])))
            continue;
        charts_.ofFace[next.face] = next.chart;
        eachNeighbour(next.face, [&](uint32_t face) {
            if (charts_.ofFace[face] == kNone) queue.push({float(cost(face, next.chart)), face, next.chart});
        });
    }
}

/// Faces by welded position, with borders along creases.
HalfEdgeMesh smoothHalfEdges(const Scene& scene, std::span<const Vec3f> normals, double creaseDeg) {
    uint32_t vertices = 0;
    const std::vector<uint32_t> id = weldPositions(scene.positions, vertices);
    std::vector<uint32_t> corners(scene.indices.size());
    for (size_t h = 0; h < corners.size(); ++h) corners[h] = id[scene.indices[h]];
    std::vector<uint32_t> twin = pairHalfEdges(corners, vertices, normals).twin;
    cutCreases(twin, normals, float(std::cos(radians(creaseDeg))));
    return HalfEdgeMesh(twin);
}

}  // namespace

AtlasMesh makeAtlasMesh(const Scene& scene, double creaseDeg) {
    std::vector<Vec3f> normals = faceNormals(scene.positions, scene.indices);
    HalfEdgeMesh edges = smoothHalfEdges(scene, normals, creaseDeg);
    std::vector<uint32_t> twin = edges.opposites();
    AtlasMesh mesh{scene, std::move(normals), {}, {}, std::move(edges), std::move(twin), 0};
    mesh.area.resize(mesh.faces());
    mesh.centroid.resize(mesh.faces());
    for (uint32_t f = 0; f < mesh.faces(); ++f) {
        throwIfInterruptedAt(f);
        const Vec3f &a = mesh.corner(3 * f), &b = mesh.corner(3 * f + 1), &c = mesh.corner(3 * f + 2);
        mesh.area[f] = float(0.5 * triangleCross(a, b, c).norm());
        mesh.centroid[f] = ((a.cast<double>() + b.cast<double>() + c.cast<double>()) / 3).cast<float>();
        mesh.totalArea += mesh.area[f];
    }
    return mesh;
}

ChartFaces facesByChart(const Charts& charts) {
    ChartFaces result;
    result.first.assign(size_t(charts.count) + 1, 0);
    for (uint32_t c : charts.ofFace) ++result.first[c + 1];
    for (size_t c = 0; c < charts.count; ++c) result.first[c + 1] += result.first[c];
    result.faces.resize(charts.ofFace.size());
    std::vector<uint32_t> cursor(result.first.begin(), result.first.end() - 1);
    for (uint32_t f = 0; f < charts.ofFace.size(); ++f) result.faces[cursor[charts.ofFace[f]]++] = f;
    return result;
}

std::vector<Vec3d> meanNormals(const AtlasMesh& mesh, const Charts& charts) {
    std::vector<Vec3d> mean(charts.count, Vec3d(0, 0, 0));
    for (size_t f = 0; f < mesh.faces(); ++f)
        mean[charts.ofFace[f]] += mesh.normal[f].cast<double>() * double(mesh.area[f]);
    return mean;
}

void splitIntoConnected(const AtlasMesh& mesh, Charts& charts) {
    charts.ofFace = mesh.edges.components(charts.ofFace, charts.count);
}

void ejectLeaningFaces(const AtlasMesh& mesh, Charts& charts, double angleDeg) {
    const double limit = std::cos(radians(angleDeg));
    for (bool changed = true; changed;) {
        throwIfInterrupted();
        changed = false;
        const std::vector<Vec3d> mean = meanNormals(mesh, charts);
        const uint32_t before = charts.count;
        std::vector<uint32_t> facesLeft(before, 0);
        for (uint32_t c : charts.ofFace) ++facesLeft[c];
        for (uint32_t f = 0; f < mesh.faces(); ++f) {
            throwIfInterruptedAt(f);
            const uint32_t c = charts.ofFace[f];
            if (facesLeft[c] == 1 || withinCone(mesh.normal[f], mean[c], limit)) continue;
            --facesLeft[c];
            charts.ofFace[f] = before + c;
            changed = true;
        }
        charts.count = 2 * before;
        splitIntoConnected(mesh, charts);
    }
}

Charts growCharts(const AtlasMesh& mesh, double coneAngleDeg) {
    Charts charts = Grower(mesh, coneAngleDeg).run();
    ejectLeaningFaces(mesh, charts, coneAngleDeg);
    return charts;
}

}  // namespace prt
