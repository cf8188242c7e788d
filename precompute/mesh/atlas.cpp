// The UV atlas from segmentation to coordinates; the steps are in the other atlas_*.cpp. The pipeline is that
// of B. Lévy, S. Petitjean, N. Ray, J. Maillot, "Least Squares Conformal Maps for Automatic Texture Atlas
// Generation", SIGGRAPH 2002, with planar projection within normal cones in place of their maps.
#include "precompute/mesh/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "precompute/base/error.h"
#include "precompute/mesh/atlas_parts.h"
#include "precompute/mesh/interrupt.h"

namespace prt {
namespace {

/// Share of the texels that a good packing fills: sets the scale of "small" before the density is known.
constexpr double kExpectedUtilisation = 0.65;
/// A packing below this share of the expected density has too many charts, and is tried again with fewer.
constexpr double kLeastDensity = 0.6;
constexpr int kMostRepacks = 10;
/// Above this share of the expected density nothing else is tried.
constexpr double kGoodDensity = 0.97;
/// Gain in density that makes up for more seams.
constexpr double kWorthSeams = 1.03;
constexpr size_t kLargestRetried = 300'000;

/// Charts smaller than `smallTexels`² are merged, within `leanDeg`.
struct Coarseness {
    double coneDeg, smallTexels, leanDeg;
};

struct Layout {
    Charts charts;
    ChartFaces faces;
    std::vector<ChartShape> shapes;
    Packing packing;
    int split = 0;
};

class AtlasBuilder {
  public:
    AtlasBuilder(const AtlasMesh& mesh, int texels, int gutter, double coneDeg)
        : mesh_(mesh),
          texels_(texels),
          gutter_(gutter),
          coneDeg_(coneDeg),
          density_(std::sqrt(kExpectedUtilisation / mesh.totalArea) * texels) {}

    /// The first layout dense enough, from fine to coarse segmentation; else the densest.
    Layout build() const;
    /// Whether a layout wastes little of the atlas on gutters.
    bool isDense(const Layout& layout) const {
        return layout.packing.texelsPerUnit >= kLeastDensity * density_;
    }

  private:
    Layout layOut(const Coarseness& coarseness) const;
    void pack(Layout& layout, double density) const;
    void project(Layout& layout) const {
        layout.faces = facesByChart(layout.charts);
        layout.shapes = projectCharts(mesh_, layout.charts, layout.faces);
    }

    const AtlasMesh& mesh_;
    const int texels_, gutter_;
    const double coneDeg_, density_;
};

/// Packs; then looks for overlaps at the density and orientation that came out, until there are none.
void AtlasBuilder::pack(Layout& layout, double density) const {
    project(layout);
    layout.split += splitOverlaps(mesh_, layout.charts, layout.faces, layout.shapes, density);
    for (int i = 0; i < kMostRepacks; ++i) {
        throwIfInterrupted();
        ejectLeaningFaces(mesh_, layout.charts, kLargestLeanDeg);  // pieces have mean normals of their own
        project(layout);
        layout.packing = packCharts(mesh_, layout.faces, layout.shapes, texels_, gutter_);
        if (layout.packing.texelsPerUnit == 0) return;
        if (layout.packing.upright)
            for (ChartShape& shape : layout.shapes) shape = turned(shape);
        const int split =
            splitOverlaps(mesh_, layout.charts, layout.faces, layout.shapes, layout.packing.texelsPerUnit);
        if (split == 0) return;
        layout.split += split;
    }
}

Layout AtlasBuilder::layOut(const Coarseness& coarseness) const {
    Layout layout;
    layout.charts = growCharts(mesh_, coarseness.coneDeg);
    const double texel = 1 / density_;
    // Within the cone, merging costs nothing; leaning further is for charts that are hardly more than gutter.
    const double small = coarseness.smallTexels * texel;
    mergeSmallCharts(mesh_, layout.charts, 25 * small * small, coarseness.coneDeg);
    mergeSmallCharts(mesh_, layout.charts, small * small, coarseness.leanDeg);
    for (int i = 0; i < 4 && splitWastefulCharts(mesh_, layout.charts, density_, texels_); ++i) {
    }
    pack(layout, density_);
    return layout;
}

Layout AtlasBuilder::build() const {
    Layout best = layOut({coneDeg_, 6, 75});
    for (const Coarseness& coarser :
         {Coarseness{std::max(coneDeg_, 70.0), 16, 78}, Coarseness{std::max(coneDeg_, 75.0), 40, 79.5}}) {
        if (isDense(best)) break;
        // Few charts that do not fit well (one long strip) are not helped by merging.
        if (best.charts.count < 100) break;
        Layout other = layOut(coarser);
        if (other.packing.texelsPerUnit > best.packing.texelsPerUnit) best = std::move(other);
    }
    if (mesh_.faces() <= kLargestRetried)
        for (double share : {0.8, 0.65}) {
            if (best.packing.texelsPerUnit >= kGoodDensity * density_) break;
            // A handful of large charts rarely fills a square: smaller ones may, at the price of seams.
            Layout other = layOut({share * coneDeg_, 6, 75});
            if (other.packing.texelsPerUnit > kWorthSeams * best.packing.texelsPerUnit)
                best = std::move(other);
        }
    return best;
}

[[noreturn]] void throwNoRoom(uint32_t charts, int texels, int gutter) {
    const double room = charts * std::pow(gutter + 1.0, 2) / 0.8;
    const int needed = int(std::ceil(std::sqrt(room) / 64)) * 64;
    throw InputError(
        fmt::format("--texels {}", texels),
        fmt::format("the surface falls into {} charts, more than {}² texels hold with gutters of {}", charts,
                    texels, gutter),
        needed <= 8192 ? fmt::format("use --texels {}", needed) : "use --per-vertex");
}

/// Vertices of the old scene copied into a new one, once per chart that uses them.
class VertexSplitter {
  public:
    explicit VertexSplitter(const Scene& from) : from_(from), head_(from.vertexCount(), kNone) {}

    uint32_t copy(uint32_t vertex, uint32_t chart, const Vec2f& uv1) {
        for (uint32_t i = head_[vertex]; i != kNone; i = next_[i])
            if (chart_[i] == chart) return i;
        const auto i = uint32_t(to_.positions.size());
        to_.positions.push_back(from_.positions[vertex]);
        if (!from_.normals.empty()) to_.normals.push_back(from_.normals[vertex]);
        if (!from_.tangents.empty()) to_.tangents.push_back(from_.tangents[vertex]);
        if (!from_.uv0.empty()) to_.uv0.push_back(from_.uv0[vertex]);
        to_.uv1.push_back(uv1);
        chart_.push_back(chart);
        next_.push_back(head_[vertex]);
        head_[vertex] = i;
        return i;
    }

    Scene& result() { return to_; }

  private:
    const Scene& from_;
    Scene to_;
    std::vector<uint32_t> head_, next_, chart_;
};

void applyLayout(Scene& scene, const Layout& layout, int texels) {
    VertexSplitter splitter(scene);
    Scene& result = splitter.result();
    result.indices.resize(scene.indices.size());
    for (ScenePrimitive primitive : scene.primitives) {
        const auto firstVertex = uint32_t(result.positions.size());
        for (uint32_t h = primitive.firstIndex; h < primitive.firstIndex + primitive.indexCount; ++h) {
            throwIfInterruptedAt(h);
            const uint32_t vertex = scene.indices[h], chart = layout.charts.ofFace[h / 3];
            const Eigen::Vector2d local =
                layout.shapes[chart].project(scene.positions[vertex]) * layout.packing.texelsPerUnit;
            const Vec2f uv(float((layout.packing.x[chart] + local.x()) / texels),
                           float((layout.packing.y[chart] + local.y()) / texels));
            result.indices[h] = splitter.copy(vertex, chart, uv);
        }
        primitive.firstVertex = firstVertex;
        primitive.vertexCount = uint32_t(result.positions.size()) - firstVertex;
        result.primitives.push_back(primitive);
    }
    result.materials = std::move(scene.materials);
    result.textures = std::move(scene.textures);
    Scene finished = std::move(result);
    scene = std::move(finished);
}

AtlasReport makeReport(const AtlasMesh& mesh, const Layout& layout) {
    AtlasReport report;
    report.charts = int(layout.charts.count);
    report.splitCharts = layout.split;
    report.texelsPerUnit = layout.packing.texelsPerUnit;
    // Projection keeps lengths along the plane and shrinks them down the slope by the cosine.
    for (uint32_t f = 0; f < mesh.faces(); ++f) {
        const ChartShape& shape = layout.shapes[layout.charts.ofFace[f]];
        if (mesh.normal[f].isZero(0.0f)) continue;
        const double cosine = shape.right.cross(shape.up).dot(mesh.normal[f].cast<double>());
        report.smallestStretch = std::min(report.smallestStretch, std::max(cosine, 0.0));
    }
    return report;
}

}  // namespace

AtlasReport buildAtlas(Scene& scene, const AtlasOptions& options) {
    if (options.texels < 16 || options.texels > 8192)
        throw UsageError("--texels", fmt::format("{} is not within 16 to 8192", options.texels));
    if (!(options.coneAngleDeg > 0 && options.coneAngleDeg < 90))
        throw UsageError("cone angle", fmt::format("{} is not within 0 to 90 degrees", options.coneAngleDeg));
    if (scene.indices.empty()) throw InputError("atlas", "the mesh has no faces");
    const int gutter = std::clamp(options.gutter, 2, options.texels / 4);
    const double cone = std::min(options.coneAngleDeg, kLargestLeanDeg);
    AtlasReport report;
    Layout layout;
    // Charts end at creases, unless that leaves so many that the gutters eat the atlas.
    for (const double creaseDeg : {options.creaseAngleDeg, 180.0}) {
        const AtlasMesh mesh = makeAtlasMesh(scene, creaseDeg);
        if (!(mesh.totalArea > 0)) throw InputError("atlas", "the mesh has no area");
        const AtlasBuilder builder(mesh, options.texels, gutter, cone);
        Layout next = builder.build();
        const bool dense = builder.isDense(next);
        if (layout.charts.count == 0 || next.packing.texelsPerUnit > layout.packing.texelsPerUnit) {
            report = makeReport(mesh, next);
            layout = std::move(next);
        }
        if (dense) break;
    }
    if (layout.packing.texelsPerUnit == 0) throwNoRoom(layout.charts.count, options.texels, gutter);
    applyLayout(scene, layout, options.texels);
    report.utilisation =
        double(measureCoverage(scene, options.texels).covered) / (double(options.texels) * options.texels);
    return report;
}

}  // namespace prt
