// Points of a lightmap: those of the bake (texel_raster.h, bake.h), and lookups between them.
#include "precompute/visibility/lightmap_points.h"

#include <algorithm>
#include <cmath>

#include "precompute/base/check.h"
#include "precompute/math/sh.h"
#include "precompute/visibility/fill.h"

namespace prt {

LightmapPoints::LightmapPoints(const Scene& scene, const PointGrid& grid, std::span<const Validity> validity)
    : scene_(scene), grid_(grid) {
    PRT_CHECK_EQ(validity.size(), grid.count);
    first_.push_back(0);
    if (grid.domain == PointDomain::Vertex) {
        source_ = makeVertexPoints(scene);
        addVertices();
        PRT_CHECK_EQ(items(), grid.count);
        for (size_t v = 0; v < grid.count; ++v) inside_[v] = isInside(validity[v]);
        return;
    }
    source_ = rasterizeTexels(scene, grid.width, grid.height);
    addTexels();
    const auto& surface = std::get<TexelSurface>(source_);
    for (size_t t = 0; t < grid.count; ++t)
        if (const uint32_t point = surface.pointOfTexel[t]; point != kNoPoint)
            inside_[point] = isInside(validity[t]);
}

void LightmapPoints::addTexels() {
    const auto& surface = std::get<TexelSurface>(source_);
    for (size_t i = 0; i < surface.points.size(); ++i) {
        if (surface.whole[i])
            parts_.push_back({surface.points[i], 1});
        else
            for (uint32_t p = surface.firstPart[i]; p < surface.firstPart[i + 1]; ++p)
                parts_.push_back({surface.subPoints[surface.parts[p].subPoint], surface.parts[p].share});
        first_.push_back(parts_.size());
        normals_.push_back(surface.points[i].normal);
    }
    inside_.assign(surface.points.size(), 0);
}

void LightmapPoints::addVertices() {
    const auto& vertices = std::get<VertexPoints>(source_);
    for (size_t v = 0; v < vertices.sameAs.size(); ++v) {
        for (uint32_t p = vertices.firstPoint[v]; p < vertices.firstPoint[v + 1]; ++p)
            parts_.push_back({vertices.points[p], vertices.share[p]});
        first_.push_back(parts_.size());
    }
    normals_ = vertices.normals;
    inside_.assign(vertices.sameAs.size(), 0);
}

std::vector<float> LightmapPoints::spread(std::span<const float> values, size_t columns) const {
    PRT_CHECK_EQ(values.size(), items() * columns);
    // The fills of the bake know rows of n² numbers: what is left of them stays zero.
    int shOrder = 1;
    while (size_t(shCount(shOrder)) < columns) ++shOrder;
    const auto row = size_t(shCount(shOrder));
    BakeResult baked;
    baked.coefficients.assign(items() * row, 0.0f);
    for (size_t i = 0; i < items(); ++i)
        std::copy_n(&values[i * columns], columns, &baked.coefficients[i * row]);
    baked.ao.assign(items(), 0.0f);
    baked.error.assign(items(), 0.0f);
    baked.inside = inside_;
    const VisibilityMap map = grid_.domain == PointDomain::Vertex
                                  ? fillVertices(scene_, std::get<VertexPoints>(source_), baked, shOrder)
                                  : fillTexels(std::get<TexelSurface>(source_), baked, shOrder);
    std::vector<float> result(grid_.count * columns);
    for (size_t k = 0; k < grid_.count; ++k)
        std::copy_n(&map.coefficients[k * row], columns, &result[k * columns]);
    return result;
}

Vec3f LightmapPoints::at(std::span<const float> values, uint32_t triangle, float u, float v) const {
    const auto valueOf = [&](size_t point) {
        return Vec3f(values[3 * point], values[3 * point + 1], values[3 * point + 2]);
    };
    const uint32_t* corner = &scene_.indices[3 * size_t(triangle)];
    const float w = 1 - u - v;
    if (grid_.domain == PointDomain::Vertex)
        return w * valueOf(corner[0]) + u * valueOf(corner[1]) + v * valueOf(corner[2]);
    const Vec2f uv = w * scene_.uv1[corner[0]] + u * scene_.uv1[corner[1]] + v * scene_.uv1[corner[2]];
    const auto place = [](float coordinate, int size) {
        return std::clamp(coordinate * float(size) - 0.5f, 0.0f, float(size - 1));
    };
    const float x = place(uv.x(), grid_.width), y = place(uv.y(), grid_.height);
    const int x0 = int(x), y0 = int(y);
    const int x1 = std::min(x0 + 1, grid_.width - 1), y1 = std::min(y0 + 1, grid_.height - 1);
    const float fx = x - float(x0), fy = y - float(y0);
    const auto texel = [&](int column, int line) {
        return valueOf(size_t(line) * size_t(grid_.width) + size_t(column));
    };
    return (1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x1, y0)) +
           fy * ((1 - fx) * texel(x0, y1) + fx * texel(x1, y1));
}

}  // namespace prt
