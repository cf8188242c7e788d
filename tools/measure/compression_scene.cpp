// Bakes as precompute/visibility/precompute_job.cpp does [IwanickiSloan2012, Sec. 3], into memory.
#include "tools/measure/compression_scene.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "compress/export_textures.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/bundle.h"
#include "precompute/io/glb.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/fill.h"

namespace prt::tools {
namespace {

constexpr double kDefaultError = 0.01;  // of files that do not say how they were baked

std::string currentFile(const std::string& bundlePath, const std::string& name) {
    const Bundle bundle = Bundle::open(bundlePath);
    bundle.require(name, "prt precompute MESH -o " + bundlePath);
    return bundle.pathOf(name).string();
}

template <class Number>
Number attribute(const VisibilityMap& map, const std::string& name, Number otherwise) {
    const auto found = map.attributes.find(name);
    if (found == map.attributes.end()) return otherwise;
    const std::string& text = found->second;
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : otherwise;
}

VisibilityMap firstBands(const VisibilityMap& map, int shOrder) {
    VisibilityMap result = map;
    const size_t from = size_t(shCount(map.shOrder)), to = size_t(shCount(shOrder));
    result.shOrder = shOrder;
    result.coefficients.resize(map.grid.count * to);
    for (size_t i = 0; i < map.grid.count; ++i)
        std::copy_n(&map.coefficients[i * from], to, &result.coefficients[i * to]);
    return result;
}

std::array<float, 3> barycentric(const Scene& scene, const SurfacePoint& point) {
    std::array<Vec3d, 3> to;
    for (size_t k = 0; k < 3; ++k)
        to[k] = (scene.positions[scene.indices[3 * point.triangle + k]] - point.position).cast<double>();
    std::array<double, 3> area{to[1].cross(to[2]).norm(), to[2].cross(to[0]).norm(),
                               to[0].cross(to[1]).norm()};
    const double sum = area[0] + area[1] + area[2];
    if (!(sum > 0)) return {1, 0, 0};
    return {float(area[0] / sum), float(area[1] / sum), float(area[2] / sum)};
}

struct Tap {
    size_t point;
    float weight;
};

std::vector<Tap> vertexTaps(const Scene& scene, const SurfacePoint& point) {
    const std::array<float, 3> b = barycentric(scene, point);
    std::vector<Tap> taps;
    for (size_t k = 0; k < 3; ++k) taps.push_back({scene.indices[3 * point.triangle + k], b[k]});
    return taps;
}

std::vector<Tap> texelTaps(const Scene& scene, const PointGrid& grid, const SurfacePoint& point) {
    const std::array<float, 3> b = barycentric(scene, point);
    Vec2f uv = Vec2f::Zero();
    for (size_t k = 0; k < 3; ++k) uv += b[k] * scene.uv1[scene.indices[3 * point.triangle + k]];
    const float x = uv.x() * float(grid.width) - 0.5f, y = uv.y() * float(grid.height) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    std::vector<Tap> taps;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int column = std::clamp(x0 + i, 0, grid.width - 1);
            const int row = std::clamp(y0 + j, 0, grid.height - 1);
            const float tx = x - float(x0), ty = y - float(y0);
            taps.push_back(
                {size_t(row) * size_t(grid.width) + size_t(column), (i ? tx : 1 - tx) * (j ? ty : 1 - ty)});
        }
    return taps;
}

}  // namespace

CompressionScene::CompressionScene(const std::string& bundlePath, bool plain, int mostBands)
    : stored_(readVisibilityFile(currentFile(bundlePath, "visibility.exr"))),
      scene_(readGltf(currentFile(bundlePath, "mesh.glb"))),
      caster_(scene_.positions, scene_.indices),
      plain_(plain || stored_.projection.kind == ProjectionKind::Plain),
      mostBands_(mostBands),
      projection_(plain ? kPlainProjection : stored_.projection),
      doubleSided_(doubleSidedTriangles(scene_)) {
    PRT_CHECK_LE(1, mostBands);
    PRT_CHECK_LE(mostBands, kMaxBundleShOrder);
    if (stored_.grid.domain == PointDomain::Texel && scene_.uv1.size() != scene_.vertexCount())
        throw InputError(bundlePath, "its mesh has no atlas for its texels",
                         "renew it with prt precompute MESH -o " + bundlePath);
    if (stored_.grid.domain == PointDomain::Vertex && stored_.grid.count != scene_.vertexCount())
        throw InputError(bundlePath, "its visibility is of another number of vertices than its mesh",
                         "renew it with prt precompute MESH -o " + bundlePath);
}

WeightsFit CompressionScene::fit() const { return plain_ ? WeightsFit::Plain : WeightsFit::Irradiance; }

BakeOptions CompressionScene::options(int shOrder) const {
    BakeOptions options;
    options.shOrder = shOrder;
    const int rays = attribute(stored_, "rays", 0);
    if (rays > 0)
        options.rays = rays;
    else
        options.error = attribute(stored_, "errorBound", kDefaultError);
    options.projection = projection_;
    return options;
}

VisibilityMap CompressionScene::bake(int shOrder) const {
    BakeOptions settings = options(shOrder);
    settings.doubleSided = doubleSided_;
    VisibilityMap map;
    if (stored_.grid.domain == PointDomain::Vertex) {
        const VertexPoints vertices = makeVertexPoints(scene_);
        map = fillVertices(scene_, vertices, bakeVertexVisibility(caster_, vertices, settings), shOrder);
    } else {
        const TexelSurface surface = rasterizeTexels(scene_, stored_.grid.width, stored_.grid.height);
        map = fillTexels(surface, bakeTexelVisibility(caster_, surface, settings), shOrder);
    }
    map.projection = projection_;
    map.attributes = stored_.attributes;
    return map;
}

const VisibilityMap& CompressionScene::visibility(int shOrder) {
    PRT_CHECK_LE(1, shOrder);
    PRT_CHECK_LE(shOrder, mostBands_);
    if (const auto found = maps_.find(shOrder); found != maps_.end()) return found->second;
    const bool isSame = stored_.projection == projection_;
    if (isSame && stored_.shOrder == shOrder) return stored_;
    if (projection_.kind != ProjectionKind::Plain) return maps_.emplace(shOrder, bake(shOrder)).first->second;
    if (isSame && stored_.shOrder > shOrder)
        return maps_.emplace(shOrder, firstBands(stored_, shOrder)).first->second;
    if (shOrder == mostBands_) return maps_.emplace(shOrder, bake(shOrder)).first->second;
    return maps_.emplace(shOrder, firstBands(visibility(mostBands_), shOrder)).first->second;
}

std::vector<float> CompressionScene::bakePoints(std::span<const SurfacePoint> points, int shOrder) const {
    BakeOptions settings = options(shOrder);
    settings.findInside = false;
    return bakeVisibility(caster_, points, settings).coefficients;
}

std::vector<uint8_t> validPoints(const VisibilityMap& visibility) {
    std::vector<uint8_t> valid(visibility.validity.size());
    std::transform(visibility.validity.begin(), visibility.validity.end(), valid.begin(),
                   [](Validity validity) { return uint8_t(validity == Validity::Valid); });
    return valid;
}

PcaMap compressMap(const VisibilityMap& visibility, int components, WeightsFit fit) {
    CompressedVisibility compressed =
        compressVisibility(visibility.coefficients, validPoints(visibility), visibility.normals,
                           visibility.shOrder, visibility.projection, components, fit);
    PcaMap map = pcaMapOf(visibility, compressed.pca);
    map.weights = std::move(compressed.weights);
    return map;
}

std::vector<float> shippedWeights(const PcaMap& pca, std::span<const uint8_t> valid,
                                  const std::string& encoding) {
    return encodePoints(pca.weights, size_t(pca.components), pca.grid, encoding, valid).decoded;
}

std::vector<float> interpolate(const Scene& scene, const PointGrid& grid,
                               std::span<const SurfacePoint> points, std::span<const float> values,
                               size_t perPoint) {
    PRT_CHECK_EQ(values.size(), grid.count * perPoint);
    std::vector<float> result(points.size() * perPoint, 0.0f);
    for (size_t p = 0; p < points.size(); ++p) {
        const std::vector<Tap> taps = grid.domain == PointDomain::Vertex ? vertexTaps(scene, points[p])
                                                                         : texelTaps(scene, grid, points[p]);
        for (const Tap& tap : taps)
            for (size_t i = 0; i < perPoint; ++i)
                result[p * perPoint + i] += tap.weight * values[tap.point * perPoint + i];
    }
    return result;
}

std::vector<float> reconstruct(const PcaMap& pca, std::span<const float> weights) {
    const size_t columns = pca.mean.size(), components = size_t(pca.components);
    PRT_CHECK_EQ(weights.size() % components, size_t(0));
    std::vector<float> rows;
    for (size_t p = 0; p < weights.size() / components; ++p)
        for (size_t i = 0; i < columns; ++i) {
            double sum = double(pca.mean[i]);
            for (size_t m = 0; m < components; ++m)
                sum += double(weights[p * components + m]) * double(pca.basis[m * columns + i]);
            rows.push_back(float(sum));
        }
    return rows;
}

}  // namespace prt::tools
