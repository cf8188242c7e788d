#include "test_scenes.h"

#include <cmath>
#include <numbers>
#include <random>

#include "compress/tables/normal_tables.h"
#include "precompute/math/environment.h"
#include "precompute/math/sh.h"

namespace prt::test {

Scene quad(const Vec3f& centre, const Vec3f& right, const Vec3f& up) {
    Scene scene;
    const Vec3f normal = right.cross(up).normalized(), tangent = right.normalized();
    for (int corner = 0; corner < 4; ++corner) {
        const float x = (corner & 1) ? 1.0f : -1.0f, y = (corner & 2) ? -1.0f : 1.0f;
        scene.positions.push_back(centre + x * right + y * up);
        scene.normals.push_back(normal);
        scene.tangents.emplace_back(tangent.x(), tangent.y(), tangent.z(), 1.0f);
        scene.uv0.emplace_back((x + 1) / 2, (1 - y) / 2);
        scene.uv1.push_back(scene.uv0.back());
    }
    scene.indices = {0, 2, 1, 1, 2, 3};
    scene.materials.push_back({});
    scene.materials.back().baseColor = Vec3f(1, 1, 1);
    scene.primitives.push_back({0, 4, 0, 6, 0});
    return scene;
}

void append(Scene& a, const Scene& b) {
    const auto vertices = uint32_t(a.vertexCount()), indices = uint32_t(a.indices.size());
    const auto materials = int(a.materials.size()), textures = int(a.textures.size());
    const auto join = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    join(a.positions, b.positions);
    join(a.normals, b.normals);
    join(a.tangents, b.tangents);
    join(a.uv0, b.uv0);
    join(a.uv1, b.uv1);
    join(a.textures, b.textures);
    for (const uint32_t index : b.indices) a.indices.push_back(index + vertices);
    for (SceneMaterial material : b.materials) {
        if (material.baseColorTexture >= 0) material.baseColorTexture += textures;
        if (material.normalTexture >= 0) material.normalTexture += textures;
        a.materials.push_back(material);
    }
    for (ScenePrimitive primitive : b.primitives) {
        primitive.firstVertex += vertices;
        primitive.firstIndex += indices;
        primitive.material += materials;
        a.primitives.push_back(primitive);
    }
}

Scene sphere(const Vec3f& centre, float radius, int rings) {
    Scene scene;
    const int columns = 2 * rings;
    for (int y = 0; y <= rings; ++y)
        for (int x = 0; x <= columns; ++x) {
            const double u = double(x) / columns, v = double(y) / rings;
            const double longitude = 2 * std::numbers::pi * u, polar = std::numbers::pi * v;
            const Vec3f n(float(std::sin(polar) * std::sin(longitude)), float(std::cos(polar)),
                          float(std::sin(polar) * std::cos(longitude)));
            scene.positions.push_back(centre + radius * n);
            scene.normals.push_back(n);
            scene.tangents.emplace_back(float(std::cos(longitude)), 0.0f, float(-std::sin(longitude)), 1.0f);
            scene.uv0.emplace_back(float(u), float(v));
            scene.uv1.push_back(scene.uv0.back());
        }
    for (int y = 0; y < rings; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = uint32_t(y * (columns + 1) + x), b = a + uint32_t(columns) + 1;
            if (y > 0) scene.indices.insert(scene.indices.end(), {a, b, a + 1});
            if (y + 1 < rings) scene.indices.insert(scene.indices.end(), {a + 1, b, b + 1});
        }
    scene.materials.push_back({});
    scene.materials.back().baseColor = Vec3f(1, 1, 1);
    scene.primitives.push_back({0, uint32_t(scene.vertexCount()), 0, uint32_t(scene.indices.size()), 0});
    return scene;
}

int addTexture(Scene& scene, int width, int height,
               const std::function<std::array<uint8_t, 3>(int x, int y)>& pixel) {
    ByteImage image{width, height, 3, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const uint8_t value : pixel(x, y)) image.pixels.push_back(value);
    scene.textures.push_back({"made by a test", "image/png", encodePng(image)});
    return int(scene.textures.size()) - 1;
}

PointGrid texelGrid(int width, int height) {
    return {PointDomain::Texel, width, height, size_t(width) * size_t(height)};
}

VisibilityMap uniformVisibility(const PointGrid& grid, int shOrder, const std::vector<float>& coefficients) {
    VisibilityMap map;
    map.grid = grid;
    map.shOrder = shOrder;
    for (size_t i = 0; i < grid.count; ++i)
        map.coefficients.insert(map.coefficients.end(), coefficients.begin(), coefficients.end());
    map.validity.assign(grid.count, Validity::Valid);
    map.ao.assign(grid.count, 1.0f);
    map.normals.assign(grid.count, Vec3f(0, 1, 0));
    return map;
}

VisibilityMap noisyVisibility(const PointGrid& grid, int shOrder, unsigned seed) {
    VisibilityMap map = uniformVisibility(grid, shOrder, std::vector<float>(size_t(shCount(shOrder))));
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 1);
    for (float& coefficient : map.coefficients) coefficient = value(random);
    return map;
}

std::vector<float> hemisphereSh(int shOrder, const Vec3f& normal) {
    // Zonal about the normal: v_lm = c_l Y_lm(n), c_l = 2π ∫₀¹ P_l(z) dz, by quadrature.
    std::vector<float> result(size_t(shCount(shOrder)));
    evalSh(shOrder, normal, result);
    for (int band = 0; band < shOrder; ++band) {
        double integral = 0;
        constexpr int kSteps = 20000;
        for (int i = 0; i < kSteps; ++i)
            integral += std::legendre(unsigned(band), (i + 0.5) / kSteps) / kSteps;
        for (int m = -band; m <= band; ++m)
            result[size_t(shIndex(band, m))] *= float(2 * std::numbers::pi * integral);
    }
    return result;
}

Environment patchSky(int number) {
    constexpr int kWidth = 64, kHeight = 32;
    Environment sky;
    sky.name = "patch" + std::to_string(number);
    sky.contentHash = sky.name;
    sky.image = {kWidth, kHeight, 3, std::vector<float>(size_t(kWidth * kHeight * 3), 0.2f)};
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 10; ++x) {
            float* texel = sky.image.at((23 * number + 20 + x) % kWidth, 3 + (5 * number) % 11 + y);
            for (int c = 0; c < 3; ++c) texel[c] = float(2 + (3 * number + 4 * c) % 9);
        }
    return sky;
}

NormalTable lightCosineTable(const std::function<Vec3f(const Vec3d&)>& light, int shOrder, int size) {
    EnvironmentSh environment;
    environment.shOrder = tableEnvironmentShOrder(shOrder);
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> sh = projectSh(
            environment.shOrder, [&](const Vec3d& d) { return double(light(d)[c]); }, 63);
        environment.rgb[size_t(c)].assign(sh.begin(), sh.end());
    }
    NormalTable table;
    table.kind = TableKind::LightCosine;
    table.size = size;
    table.shOrder = shOrder;
    table.layers = shCount(shOrder);
    table.values = buildLightCosineTable(environment, shOrder, size);
    return table;
}

NormalTable tripleProductTable(const NormalTable& lightCosine, const PcaMap& pca) {
    NormalTable table = lightCosine;
    table.kind = TableKind::TripleProduct;
    table.layers = pca.components + 1;
    table.values = buildTripleProductTable(lightCosine.values, lightCosine.shOrder, lightCosine.size,
                                           pca.mean, pca.basis);
    return table;
}

NormalTable noisyTable(TableKind kind, int shOrder, int layers, int size, unsigned seed,
                       const std::string& layout) {
    NormalTable table;
    table.layout = layout;
    table.kind = kind;
    table.size = size;
    table.shOrder = shOrder;
    table.layers = layers;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 1);
    table.values.resize(size_t(3) * size_t(layers) * table.texels());
    for (float& v : table.values) v = value(random);
    // Texels of the border repeat the one that a lookup at their normal finds.
    const TableLayout texels(layout, size);
    for (int t = 0; layout == "octahedral" && t < texels.texelCount(); ++t) {
        const SphereTaps taps = texels.taps(texels.normal(t));
        const int same =
            std::max_element(taps.begin(), taps.end(), [](const SphereTap& a, const SphereTap& b) {
                return a.weight < b.weight;
            })->texel;
        for (size_t layer = 0; layer < size_t(3 * layers); ++layer)
            table.values[layer * table.texels() + size_t(t)] =
                table.values[layer * table.texels() + size_t(same)];
    }
    return table;
}

PcaMap completePca(const VisibilityMap& visibility, float mean) {
    PcaMap pca;
    pca.grid = visibility.grid;
    pca.shOrder = visibility.shOrder;
    pca.components = shCount(visibility.shOrder);
    const auto count = size_t(pca.components);
    pca.mean.assign(count, mean);
    pca.basis.assign(count * count, 0.0f);
    for (size_t i = 0; i < count; ++i) pca.basis[i * count + i] = 1;
    pca.variance.assign(count, 1.0f);
    for (const float coefficient : visibility.coefficients) pca.weights.push_back(coefficient - mean);
    return pca;
}

}  // namespace prt::test
