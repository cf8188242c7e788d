// Regions of faces between the curves along which a mesh meets itself.
#include "precompute/visibility/surely_outside.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/visibility/find_inside.h"

namespace prt {
namespace {

constexpr int kDirections = 64;  // over the sphere; half of them lie above the horizon
// Edges reach beyond their ends by so many offsets of rays: what only touches counts as pierced.
constexpr float kReach = 16;
// Hits of an edge's neighbours that are passed before its faces are taken for crossed.
constexpr int kMostSteps = 32;
constexpr size_t kMostFacesOfEdge = 16;  // more are not joined: regions may be too small, never too large
// Of a region so many faces are looked at, and of large ones every kSampleStep-th.
constexpr size_t kFewestSamples = 64, kSampleStep = 16;

// Index of the first vertex at the same position.
std::vector<uint32_t> weldPositions(std::span<const Vec3f> positions) {
    struct Hash {
        size_t operator()(const std::array<uint32_t, 3>& key) const {
            uint64_t hash = 0xcbf29ce484222325ull;
            for (const uint32_t word : key) hash = (hash ^ word) * 0x100000001b3ull;
            return size_t(hash ^ hash >> 29);
        }
    };
    std::unordered_map<std::array<uint32_t, 3>, uint32_t, Hash> first;
    first.reserve(positions.size());
    std::vector<uint32_t> welded(positions.size());
    for (uint32_t v = 0; v < positions.size(); ++v) {
        std::array<uint32_t, 3> key;
        for (size_t k = 0; k < 3; ++k)  // + 0 turns −0 into 0
            key[k] = std::bit_cast<uint32_t>(positions[v][Eigen::Index(k)] + 0.0f);
        welded[v] = first.emplace(key, v).first->second;
    }
    return welded;
}

// One side of one face.
struct Edge {
    uint32_t low, high;  // welded corners
    uint32_t triangle;
    bool rising;  // the face goes from low to high
};

// Sorted, so that faces of one edge follow each other.
std::vector<Edge> collectEdges(std::span<const uint32_t> indices, const std::vector<uint32_t>& welded) {
    std::vector<Edge> edges;
    edges.reserve(indices.size());
    for (size_t i = 0; i < indices.size(); ++i) {
        const uint32_t a = welded[indices[i]], b = welded[indices[i % 3 == 2 ? i - 2 : i + 1]];
        if (a != b) edges.push_back({std::min(a, b), std::max(a, b), uint32_t(i / 3), a < b});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
        return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
    });
    return edges;
}

// Calls body(first, last) for the faces of each edge, over a range that need not begin or end with one.
template <class Body>
void forEachEdge(const std::vector<Edge>& edges, size_t begin, size_t end, const Body& body) {
    const auto sameEdge = [](const Edge& x, const Edge& y) { return x.low == y.low && x.high == y.high; };
    for (size_t first = begin; first < end;) {
        size_t last = first + 1;
        while (last < edges.size() && sameEdge(edges[first], edges[last])) ++last;
        if (first == 0 || !sameEdge(edges[first - 1], edges[first])) body(first, last);
        first = last;
    }
}

class CrossingSearch {
  public:
    CrossingSearch(const RayCaster& caster, const std::vector<uint32_t>& welded,
                   const std::vector<Edge>& edges)
        : caster_(caster), welded_(welded), edges_(edges), crossed_(caster.triangleCount(), 0) {}

    std::vector<uint8_t> run() {
        parallelFor(edges_.size(), 4096, [&](size_t begin, size_t end) {
            throwIfInterrupted();
            forEachEdge(edges_, begin, end, [&](size_t first, size_t last) { follow(first, last); });
        });
        return std::move(crossed_);
    }

  private:
    void mark(uint32_t triangle) {
        std::atomic_ref<uint8_t>(crossed_[triangle]).store(1, std::memory_order_relaxed);
    }
    bool touches(uint32_t triangle, const Edge& edge) const {
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t corner = welded_[caster_.indices()[3 * size_t(triangle) + k]];
            if (corner == edge.low || corner == edge.high) return true;
        }
        return false;
    }
    // From end to end, past the faces that share a corner.
    void follow(size_t first, size_t last) {
        const Edge& edge = edges_[first];
        const Vec3f a = caster_.positions()[edge.low], b = caster_.positions()[edge.high];
        const float length = (b - a).norm();
        if (!(length > 0)) return;
        const Vec3f direction = (b - a) / length;
        const float reach = kReach * std::max(caster_.offsetDistance(a), caster_.offsetDistance(b));
        float passed = -reach;
        bool found = false;
        for (int step = 0; passed < length + reach; ++step) {
            const RayHit hit = caster_.firstHit(a + passed * direction, direction, length + reach - passed);
            if (hit.triangle == RayHit{}.triangle) break;
            if (!touches(hit.triangle, edge)) {
                mark(hit.triangle);
                found = true;
            }
            found |= step >= kMostSteps;
            if (step >= kMostSteps) break;
            passed += hit.distance + reach / 4;
        }
        if (!found) return;
        for (size_t i = first; i < last; ++i) mark(edges_[i].triangle);
    }

    const RayCaster& caster_;
    const std::vector<uint32_t>& welded_;
    const std::vector<Edge>& edges_;
    std::vector<uint8_t> crossed_;
};

// Sets of faces, joined one by one.
class Regions {
  public:
    explicit Regions(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    uint32_t find(uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(uint32_t a, uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<uint32_t> parent_;
};

// Calls body(a, b) for faces that meet at an edge with the same winding.
template <class Body>
void forEachPair(const std::vector<Edge>& edges, const Body& body) {
    forEachEdge(edges, 0, edges.size(), [&](size_t first, size_t last) {
        if (last - first > kMostFacesOfEdge) return;
        for (size_t i = first; i < last; ++i)
            for (size_t j = i + 1; j < last; ++j)
                if (edges[i].rising != edges[j].rising) body(edges[i].triangle, edges[j].triangle);
    });
}

// Points of a face: its centroid, and one near each corner.
void addSamples(const RayCaster& caster, uint32_t triangle, std::vector<SurfacePoint>& samples) {
    std::array<Vec3d, 3> p;
    for (size_t k = 0; k < 3; ++k)
        p[k] = caster.positions()[caster.indices()[3 * size_t(triangle) + k]].cast<double>();
    const Vec3d cross = (p[1] - p[0]).cross(p[2] - p[0]), centroid = (p[0] + p[1] + p[2]) / 3;
    if (!(cross.norm() > 0)) return;
    const Vec3f normal = cross.normalized().cast<float>();
    samples.push_back({centroid.cast<float>(), normal, triangle});
    for (const Vec3d& corner : p)
        samples.push_back({(0.2 * centroid + 0.8 * corner).cast<float>(), normal, triangle});
}

// Faces of which a sample was inside.
class Sampling {
  public:
    Sampling(const RayCaster& caster, std::span<const uint8_t> doubleSided)
        : caster_(caster), doubleSided_(doubleSided), inside_(caster.triangleCount(), 0) {}
    void look(const std::vector<uint32_t>& faces) {
        std::vector<SurfacePoint> samples;
        for (const uint32_t face : faces) addSamples(caster_, face, samples);
        const std::vector<uint8_t> inside =
            findInsidePoints(caster_, samples, spreadDirections(kDirections), doubleSided_);
        for (size_t i = 0; i < samples.size(); ++i) inside_[samples[i].triangle] |= inside[i];
    }
    const std::vector<uint8_t>& inside() const { return inside_; }

  private:
    const RayCaster& caster_;
    std::span<const uint8_t> doubleSided_;
    std::vector<uint8_t> inside_;
};

}  // namespace

std::vector<uint8_t> findSurelyOutside(const RayCaster& caster, std::span<const uint8_t> doubleSided,
                                       size_t mostFaces) {
    const auto count = uint32_t(caster.triangleCount());
    const std::vector<uint32_t> welded = weldPositions(caster.positions());
    const std::vector<Edge> edges = collectEdges(caster.indices(), welded);
    const std::vector<uint8_t> crossed = CrossingSearch(caster, welded, edges).run();
    Regions regions(count);
    forEachPair(edges, [&](uint32_t a, uint32_t b) {
        if (!crossed[a] && !crossed[b]) regions.join(a, b);
    });

    std::vector<size_t> size(count, 0), met(count, 0);
    for (uint32_t t = 0; t < count; ++t) ++size[regions.find(t)];
    std::vector<uint32_t> some;
    for (uint32_t t = 0; t < count; ++t) {
        const uint32_t region = regions.find(t);
        const size_t step = std::clamp<size_t>(size[region] / kFewestSamples, 1, kSampleStep);
        if (!crossed[t] && met[region]++ % step == 0) some.push_back(t);
    }
    Sampling sampling(caster, doubleSided);
    sampling.look(some);
    std::vector<uint8_t> doubtful(count, 0);
    for (uint32_t t = 0; t < count; ++t)
        if (sampling.inside()[t]) doubtful[regions.find(t)] = 1;

    // Where samples of a region disagree (scanned surfaces with holes and folds), face by face.
    std::vector<uint32_t> unsure;
    std::vector<uint8_t> outside(count, 0);
    for (uint32_t t = 0; t < count; ++t) {
        if (crossed[t]) continue;
        if (doubtful[regions.find(t)])
            unsure.push_back(t);
        else
            outside[t] = 1;
    }
    if (unsure.size() > mostFaces) return outside;
    sampling.look(unsure);
    for (const uint32_t t : unsure) outside[t] = !sampling.inside()[t];
    forEachPair(edges, [&](uint32_t a, uint32_t b) {
        if (sampling.inside()[a]) outside[b] = 0;
        if (sampling.inside()[b]) outside[a] = 0;
    });
    return outside;
}

}  // namespace prt
