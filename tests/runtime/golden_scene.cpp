#include "golden_scene.h"

#include <cmath>
#include <numbers>

#include "compress/compress_visibility.h"
#include "compress/reduce_visibility.h"
#include "precompute/math/directions.h"
#include "precompute/math/sh.h"
#include "precompute/math/sh_product.h"

namespace prt::test {
namespace {

constexpr int kOrder = 6, kSide = 24, kParts = 3;  // texels along the side of a part
constexpr double kTurn = 4.2;
const std::vector<double> kWeights{0.35, 0.65};
const Vec3f kSphere(0.3f, 0.7f, -0.4f);
constexpr float kRadius = 0.7f, kHalf = 2;  // half of the floor's side

/// Each part has a column of the atlas; its corners are centres of texels, so that nothing bleeds.
Scene inAtlas(Scene part, int column) {
    for (Vec2f& uv : part.uv1)
        uv = {(float(column) + (0.5f + uv.x() * (kSide - 1)) / kSide) / kParts,
              (0.5f + uv.y() * (kSide - 1)) / kSide};
    return part;
}

Scene makeScene() {
    Scene scene = inAtlas(quad({0, 0, 0}, {kHalf, 0, 0}, {0, 0, -kHalf}), 0);
    SceneMaterial& floor = scene.materials.back();
    floor.baseColorTexture = addTexture(scene, 16, 16, [](int x, int y) {
        const bool dark = (x / 2 + y / 2) % 2 != 0;
        return std::array<uint8_t, 3>{uint8_t(dark ? 120 : 220), uint8_t(dark ? 130 : 210),
                                      uint8_t(dark ? 140 : 180)};
    });
    floor.normalTexture = addTexture(scene, 32, 32, [](int x, int y) {
        return std::array<uint8_t, 3>{uint8_t(128 + 50 * std::sin(0.8 * x)),
                                      uint8_t(128 + 50 * std::cos(0.8 * y)), 220};
    });
    append(scene, inAtlas(quad({0, 1, -kHalf}, {kHalf, 0, 0}, {0, 1, 0}), 1));
    scene.materials.back().baseColor = {0.75f, 0.35f, 0.25f};
    append(scene, inAtlas(sphere(kSphere, kRadius, 16), 2));
    scene.materials.back().baseColor = {0.8f, 0.8f, 0.8f};
    return scene;
}

struct Point {
    Vec3f position, normal;
};

Point pointOfTexel(int x, int y) {
    const float u = float(x % kSide) / (kSide - 1), v = float(y) / (kSide - 1);
    if (x < kSide) return {{kHalf * (2 * u - 1), 0, -kHalf * (1 - 2 * v)}, Vec3f::UnitY()};
    if (x < 2 * kSide) return {{kHalf * (2 * u - 1), 1 + (1 - 2 * v), -kHalf}, Vec3f::UnitZ()};
    const float longitude = 2 * std::numbers::pi_v<float> * u, polar = std::numbers::pi_v<float> * v;
    const Vec3f normal(std::sin(polar) * std::sin(longitude), std::cos(polar),
                       std::sin(polar) * std::cos(longitude));
    return {kSphere + kRadius * normal, normal};
}

bool isOccluded(const Point& from, const Vec3f& d) {
    if (d.dot(from.normal) <= 0) return true;
    const Vec3f start = from.position + 1e-3f * from.normal, toSphere = kSphere - start;
    const float along = toSphere.dot(d);
    if (along > 0 && toSphere.squaredNorm() - along * along < kRadius * kRadius && toSphere.norm() > kRadius)
        return true;
    const auto within = [](float x) { return std::abs(x) < kHalf; };
    const float down = -start.y() / d.y(), back = (-kHalf - start.z()) / d.z();
    const Vec3f onFloor = start + down * d, onWall = start + back * d;
    return (down > 0 && within(onFloor.x()) && within(onFloor.z())) ||
           (back > 0 && within(onWall.x()) && std::abs(onWall.y() - 1) < 1);
}

/// Fills coefficients and ambient occlusion of a point.
class Tracer {
  public:
    Tracer() : directions_(sphericalFibonacci(384)) {
        for (const Vec3f& d : directions_) {
            basis_.emplace_back(size_t(shCount(kOrder)));
            evalSh(kOrder, d, std::span<float>(basis_.back()));
        }
    }
    void trace(const Point& point, std::vector<float>& coefficients, std::vector<float>& ao) const {
        std::vector<float> sum(size_t(shCount(kOrder)));
        float open = 0;
        const float area = 4 * std::numbers::pi_v<float> / float(directions_.size());
        for (size_t k = 0; k < directions_.size(); ++k) {
            if (isOccluded(point, directions_[k])) continue;
            open += area * directions_[k].dot(point.normal) / std::numbers::pi_v<float>;
            for (size_t i = 0; i < sum.size(); ++i) sum[i] += area * basis_[k][i];
        }
        coefficients.insert(coefficients.end(), sum.begin(), sum.end());
        ao.push_back(std::min(open, 1.0f));
    }

  private:
    std::vector<Vec3f> directions_;
    std::vector<std::vector<float>> basis_;
};

std::vector<float> plainWeights(const PcaMap& pca, std::span<const float> rows) {
    std::vector<float> weights;
    const size_t n = pca.mean.size();
    for (size_t row = 0; row < rows.size() / n; ++row)
        for (size_t k = 0; k < size_t(pca.components); ++k) {
            double sum = 0;
            for (size_t i = 0; i < n; ++i)
                sum += double(rows[row * n + i] - pca.mean[i]) * double(pca.basis[k * n + i]);
            weights.push_back(float(sum));
        }
    return weights;
}

}  // namespace

GoldenScene::GoldenScene() : scene_(makeScene()) {
    const Tracer tracer;
    visibility_.grid = texelGrid(kParts * kSide, kSide);
    visibility_.shOrder = kOrder;
    visibility_.validity.assign(visibility_.grid.count, Validity::Valid);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kParts * kSide; ++x) {
            const Point point = pointOfTexel(x, y);
            tracer.trace(point, visibility_.coefficients, visibility_.ao);
            visibility_.normals.push_back(point.normal);
        }
    const CompressedVisibility compressed =
        compressVisibility(visibility_.coefficients, {}, visibility_.normals, kOrder, kPlainProjection, 24,
                           WeightsFit::Plain, Covariance::Plain);
    pca_ = pcaMapOf(visibility_, compressed.pca);
    pca_.weights = plainWeights(pca_, visibility_.coefficients);
    std::vector<float> atVertices, unused;
    for (size_t v = 0; v < scene_.vertexCount(); ++v)
        tracer.trace({scene_.positions[v], scene_.normals[v]}, atVertices, unused);
    vertexPca_ = pca_;
    vertexPca_.grid = vertexGrid(scene_.vertexCount());
    vertexPca_.weights = plainWeights(pca_, atVertices);

    TableOptions options;
    options.size = 16;
    const std::vector<Environment> skies{patchSky(0), patchSky(2)};
    light_ = std::make_unique<LiveLight>(skies, kOrder, options);
    background_ = skies[1].image;
    const EnvironmentSh sh = light_->blend(kWeights, kTurn);
    lightmap_.grid = visibility_.grid;
    for (size_t i = 0; i < visibility_.grid.count; ++i)
        for (const std::vector<float>& colour : sh.rgb) {
            const size_t n = size_t(shCount(kOrder));
            const std::vector<float> product =
                shProduct(std::span(visibility_.coefficients).subspan(i * n, n), colour, 3);
            lightmap_.coefficients.insert(lightmap_.coefficients.end(), product.begin(), product.end());
        }
}

Camera GoldenScene::camera() {
    Camera camera;
    camera.eye = {2.2f, 2.4f, 4.2f};
    camera.target = {0, 0.55f, -0.6f};
    return camera;
}

std::unique_ptr<Renderer> GoldenScene::makeRenderer(GlContext& context) const {
    auto renderer = std::make_unique<Renderer>(context, scene_, &visibility_, &pca_);
    for (const Technique technique : listedTechniques()) {
        switch (technique.kind) {
            case TechniqueKind::Unc:
                if (technique.number > 0)
                    renderer->add(technique, reduceOrder(visibility_, technique.number));
                break;
            case TechniqueKind::Pca:
                if (technique.number > 0) {
                    PcaMap fewer = pca_;
                    const auto m = size_t(technique.number);
                    fewer.components = technique.number;
                    fewer.basis.resize(m * pca_.mean.size());
                    fewer.weights = plainWeights(fewer, visibility_.coefficients);
                    renderer->add(technique, fewer);
                }
                break;
            case TechniqueKind::VertexPca:
                renderer->add(technique, vertexPca_);
                break;
            case TechniqueKind::PcaUniform:
                renderer->add(technique, pca_);
                break;
            case TechniqueKind::ShLightmap:
                renderer->add(technique, lightmap_);
                continue;  // has its light
            case TechniqueKind::Sh2:
                renderer->add(technique, reduceOrder(visibility_, 2));
                break;
            case TechniqueKind::PreconvolvedAo:
                renderer->add(technique, visibility_);
                break;
        }
        renderer->setLight(technique, *light_, kWeights, kTurn);
    }
    renderer->setBackground(background_, kTurn);
    return renderer;
}

}  // namespace prt::test
