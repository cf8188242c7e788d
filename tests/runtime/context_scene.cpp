#include "context_scene.h"

#include <unistd.h>

#include <cmath>
#include <fstream>

namespace prt::test {
namespace {

Vec3f colouredLight(const Vec3d& d) {
    return {float(1 + d.x()), float(0.5 + 0.5 * d.y() * d.y()), float(1 - d.z() + d.x() * d.y())};
}

Scene makeScene() {
    Scene scene = sphere({0, 0, 0}, 1, 20);
    append(scene, quad({0, -1, 0}, {2, 0, 0}, {0, 0, -2}));
    SceneMaterial& floor = scene.materials.back();
    floor.baseColorTexture = addTexture(scene, 16, 16, [](int x, int y) {
        return std::array<uint8_t, 3>{uint8_t(16 * x), uint8_t(16 * y), uint8_t((x ^ y) & 4 ? 255 : 40)};
    });
    floor.normalTexture = addTexture(scene, 16, 16, [](int x, int y) {
        return std::array<uint8_t, 3>{uint8_t(128 + 40 * std::sin(x)), uint8_t(128 + 40 * std::cos(y)), 230};
    });
    floor.doubleSided = true;
    return scene;
}

}  // namespace

Showcase::Showcase(PointDomain domain) : scene_(makeScene()) {
    constexpr int kShOrder = 4;
    const PointGrid grid =
        domain == PointDomain::Texel ? texelGrid(16, 16) : vertexGrid(scene_.vertexCount());
    visibility_ = noisyVisibility(grid, kShOrder, 7);
    pca_ = completePca(visibility_, 0.2f);
    lightCosine_ = lightCosineTable(colouredLight, kShOrder, 8);
    tripleProduct_ = tripleProductTable(lightCosine_, pca_);
    background_ = {16, 8, 3, std::vector<float>(16 * 8 * 3)};
    for (size_t i = 0; i < background_.pixels.size(); ++i) background_.pixels[i] = float(i % 17) / 17;
}

std::unique_ptr<Renderer> Showcase::makeRenderer(GlContext& context) const {
    auto renderer = std::make_unique<Renderer>(context, scene_, &visibility_, &pca_);
    renderer->setTable(lightCosine_);
    renderer->setTable(tripleProduct_);
    renderer->setBackground(background_, 0.3);
    return renderer;
}

Camera Showcase::camera() {
    Camera camera;
    camera.eye = {1, 1.5f, 4};
    return camera;
}

RenderedFrame Showcase::draw(Renderer& renderer, Technique technique) const {
    return renderer.render(camera(), technique, options());
}

size_t residentBytes() {
    std::ifstream file("/proc/self/statm");
    size_t total = 0, resident = 0;
    file >> total >> resident;
    return resident * size_t(::sysconf(_SC_PAGESIZE));
}

double relativeRmse(const FloatImage& a, const FloatImage& b) {
    EXPECT_EQ(a.pixels.size(), b.pixels.size());
    double error = 0, size = 0;
    for (size_t i = 0; i < std::min(a.pixels.size(), b.pixels.size()); ++i) {
        error += std::pow(double(a.pixels[i]) - double(b.pixels[i]), 2);
        size += std::pow(double(a.pixels[i]), 2);
    }
    EXPECT_GT(size, 0);
    return std::sqrt(error / size);
}

}  // namespace prt::test
