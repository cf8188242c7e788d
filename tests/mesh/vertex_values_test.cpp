// Vertices fitted to an atlas, against functions that they can and cannot hold.
#include "precompute/mesh/vertex_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh_kinds.h"

namespace prt {
namespace {

constexpr int kTexels = 64;

// An n×n grid of quads whose atlas is the plane itself.
Scene flatGrid(int n) {
    Scene scene = makeGrid(n);
    for (const Vec3f& p : scene.positions) {
        scene.uv1.emplace_back(p.x(), p.z());
        scene.normals.push_back(Vec3f::UnitY());
    }
    return scene;
}

template <class Function>
std::vector<float> texels(const Function& function) {
    std::vector<float> values;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x)
            values.push_back(function((x + 0.5f) / kTexels, (y + 0.5f) / kTexels));
    return values;
}

const std::vector<uint8_t> kAll(size_t(kTexels* kTexels), 1);

// Texels are linear between each other, and so are the triangles of such a function; only the outermost half
// texel, where lookups are clamped, is flat. The smoothness takes 36λ of what is left.
TEST(VertexValues, HoldWhatIsLinear) {
    const Scene scene = flatGrid(5);
    const auto linear = [](float u, float v) { return 3 * u - 2 * v + 0.5f; };
    const std::vector<float> values = texels(linear), both = [&] {
        std::vector<float> two;
        for (const float value : values) two.insert(two.end(), {value, -2 * value});
        return two;
    }();
    const std::vector<float> fit = fitVertexValues(scene, kTexels, kTexels, kAll, both, 2);
    ASSERT_EQ(fit.size(), 2 * scene.vertexCount());
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        const Vec2f uv = scene.uv1[v];
        const bool inner = uv.minCoeff() > 0.01f && uv.maxCoeff() < 0.99f;
        EXPECT_NEAR(fit[2 * v], linear(uv.x(), uv.y()), inner ? 3e-3 : 3e-2);
        EXPECT_NEAR(fit[2 * v + 1], -2 * fit[2 * v], 1e-5);
    }
}

// RMS of interpolated vertices less the function, at the middles of small squares.
template <class Function>
double rms(int n, const std::vector<float>& vertices, const Scene& scene, const Function& function) {
    double sum = 0;
    size_t count = 0;
    for (size_t t = 0; t < scene.triangleCount(); ++t)
        for (int i = 1; i < 20; ++i)
            for (int j = 1; i + j < 20; ++j) {
                const float b[3] = {float(20 - i - j) / 20, float(i) / 20, float(j) / 20};
                Vec2f uv = Vec2f::Zero();
                float value = 0;
                for (size_t k = 0; k < 3; ++k) {
                    const uint32_t corner = scene.indices[3 * t + k];
                    uv += b[k] * scene.uv1[corner];
                    value += b[k] * vertices[corner];
                }
                sum += std::pow(double(value - function(uv.x(), uv.y())), 2);
                ++count;
            }
    EXPECT_EQ(count, size_t(2 * n * n * 171));
    return std::sqrt(sum / double(count));
}

// A parabola between two vertices: least squares leaves 1/√6 of what taking the values at vertices does in
// one dimension. In two, with the corners' triangles, 0.5 was measured; averages of the texels around are
// worse than values.
TEST(VertexValues, AreBetterThanValuesAtVerticesAndThanAverages) {
    constexpr int n = 6;
    const Scene scene = flatGrid(n);
    const auto bowl = [](float u, float v) { return (u - 0.4f) * (u - 0.4f) + 2 * v * v; };
    const std::vector<float> values = texels(bowl);
    std::vector<float> sampled, averaged;
    for (const Vec2f& uv : scene.uv1) {
        sampled.push_back(bowl(uv.x(), uv.y()));
        double sum = 0, count = 0;
        for (int y = 0; y < kTexels; ++y)
            for (int x = 0; x < kTexels; ++x)
                if (std::max(std::abs((float(x) + 0.5f) / kTexels - uv.x()),
                             std::abs((float(y) + 0.5f) / kTexels - uv.y())) < 0.5f / n) {
                    sum += double(values[size_t(y * kTexels + x)]);
                    ++count;
                }
        averaged.push_back(float(sum / count));
    }
    const double fit = rms(n, fitVertexValues(scene, kTexels, kTexels, kAll, values, 1), scene, bowl);
    EXPECT_LT(fit, 0.7 * rms(n, sampled, scene, bowl));
    EXPECT_LT(fit, 0.5 * rms(n, averaged, scene, bowl));
}

TEST(VertexValues, WhatNoTexelReachesGoesOnFromItsNeighbours) {
    // A sheet whose right half does not count, and one far away of which nothing does.
    Scene scene = flatGrid(8);
    const size_t sheet = scene.vertexCount();
    Scene other = scene;
    for (Vec3f& p : other.positions) p.y() += 5;
    const std::vector<uint32_t> indices = other.indices;
    scene.positions.insert(scene.positions.end(), other.positions.begin(), other.positions.end());
    scene.normals.insert(scene.normals.end(), other.normals.begin(), other.normals.end());
    for (const Vec2f& uv : other.uv1) scene.uv1.emplace_back(0.9f + 0.01f * uv.x(), 0.9f + 0.01f * uv.y());
    for (const uint32_t index : indices) scene.indices.push_back(index + uint32_t(sheet));

    std::vector<uint8_t> counts;
    for (int i = 0; i < kTexels * kTexels; ++i) counts.push_back(i % kTexels < kTexels / 2);
    // What does not count must not be read.
    const std::vector<float> values = texels([](float u, float) { return u < 0.52f ? 7.0f : -1000.0f; });
    const std::vector<float> fit = fitVertexValues(scene, kTexels, kTexels, counts, values, 1);
    for (size_t v = 0; v < scene.vertexCount(); ++v) {
        ASSERT_TRUE(std::isfinite(fit[v])) << v;
        EXPECT_NEAR(fit[v], v < sheet ? 7 : 0, 1e-3) << v;
    }
}

TEST(VertexValues, AreOneAcrossSeamsAndTwoAcrossEdges) {
    Scene scene = flatGrid(1);
    // Both triangles have their own corners, and their own halves of the atlas.
    Scene soup;
    for (size_t i = 0; i < 6; ++i) {
        const uint32_t v = scene.indices[i];
        soup.positions.push_back(scene.positions[v]);
        soup.normals.push_back(Vec3f::UnitY());
        soup.uv1.emplace_back(0.5f * scene.uv1[v].x() + (i < 3 ? 0.0f : 0.5f), scene.uv1[v].y());
        soup.indices.push_back(uint32_t(i));
    }
    soup.primitives = scene.primitives;
    const std::vector<float> values = texels([](float u, float) { return u < 0.5f ? 0.0f : 1.0f; });
    const auto shared = [&](const std::vector<float>& fit) {
        for (size_t a = 0; a < 3; ++a)
            for (size_t b = 3; b < 6; ++b)
                if (soup.positions[a] == soup.positions[b]) return std::pair(fit[a], fit[b]);
        return std::pair(0.0f, 0.0f);
    };
    const auto seam = shared(fitVertexValues(soup, kTexels, kTexels, kAll, values, 1));
    EXPECT_EQ(seam.first, seam.second);
    EXPECT_GT(seam.first, 0.2f);
    for (size_t i = 3; i < 6; ++i) soup.normals[i] = Vec3f::UnitX();
    const auto edge = shared(fitVertexValues(soup, kTexels, kTexels, kAll, values, 1));
    EXPECT_LT(edge.first, 0.1f);
    EXPECT_GT(edge.second, 0.9f);
}

// Whatever the mesh: finite, and within what the texels hold but for a little overshoot.
TEST(VertexValues, AreFiniteOnAnyMesh) {
    for (const MeshKind& kind : meshKinds()) {
        Scene scene = kind.make();
        scene.normals.assign(scene.vertexCount(), Vec3f::UnitY());
        for (size_t v = 0; v < scene.vertexCount(); ++v)
            scene.uv1.emplace_back(std::fmod(0.37f * float(v), 1.0f), std::fmod(0.61f * float(v), 1.0f));
        const std::vector<float> values = texels([](float u, float v) { return std::sin(40 * u + 30 * v); });
        for (const float value : fitVertexValues(scene, kTexels, kTexels, kAll, values, 1)) {
            ASSERT_TRUE(std::isfinite(value)) << kind.name;
            ASSERT_LT(std::abs(value), 3) << kind.name;
        }
    }
}

}  // namespace
}  // namespace prt
