// Sources: [IwanickiSloan2012, Sec. 3.4] (four coefficients to a texel). Borders in place of seamless cube
// arrays are 10-25 % faster under llvmpipe; its bilinear filter works in float (tests hold it to 1e-5) and
// takes two thirds of the time of four texelFetch.
#include "runtime/coefficient_images.h"

#include <fmt/format.h>

#include <algorithm>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/parallel.h"
#include "precompute/math/sphere_map.h"

namespace prt {
namespace {

GlObject makeArray(const GlContext& context, int width, int height, int layers, const char* where) {
    const GlFunctions& gl = context.gl();
    const GLint edge = glInteger(gl, GL_MAX_TEXTURE_SIZE), depth = glInteger(gl, GL_MAX_ARRAY_TEXTURE_LAYERS);
    if (width > edge || height > edge || layers > depth)
        throw InputError(
            where,
            fmt::format("{}x{} texels in {} layers are more than the {}x{} in {} that OpenGL takes here",
                        width, height, layers, edge, edge, depth),
            "use fewer texels or a lower order");
    GlObject texture = makeTexture(gl, GL_TEXTURE_2D_ARRAY);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl.TextureParameteri(texture.name(), filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl.TextureParameteri(texture.name(), wrap, GL_CLAMP_TO_EDGE);
    gl.TextureStorage3D(texture.name(), 1, GL_RGBA32F, width, height, layers);
    try {
        context.check(where);
    } catch (const Error&) {
        const double mebibytes = 16.0 * width * height * layers / (1 << 20);
        throw InputError(where,
                         fmt::format("OpenGL has no room for {}x{} texels in {} layers ({:.0f} MiB)", width,
                                     height, layers, mebibytes),
                         "use fewer texels or a lower order");
    }
    return texture;
}

// Up to three texels whose mean a bordered texel is.
struct BorderSource {
    int texel[3];
};

int texelIndex(const CubeTap& tap, int size) { return (tap.face * size + tap.y) * size + tap.x; }

// Texel of the bordered face: its own, the neighbour's across an edge, or, beyond a corner where no texel is,
// the mean of the three that meet there (OpenGL 4.5, 8.14.1).
BorderSource borderSource(int face, int x, int y, int size) {
    const bool outX = x < 0 || x >= size, outY = y < 0 || y >= size;
    const int insideX = std::clamp(x, 0, size - 1), insideY = std::clamp(y, 0, size - 1);
    const int own = texelIndex({face, insideX, insideY, 1}, size);
    if (!outX && !outY) return {{own, own, own}};
    if (!outY || !outX) {
        const int across = texelIndex(cubeTexelAcrossEdge(face, x, y, size), size);
        return {{across, across, across}};
    }
    return {{own, texelIndex(cubeTexelAcrossEdge(face, x, insideY, size), size),
             texelIndex(cubeTexelAcrossEdge(face, insideX, y, size), size)}};
}

std::vector<BorderSource> borderSources(int size) {
    std::vector<BorderSource> sources;
    sources.reserve(size_t(6) * size_t(size + 2) * size_t(size + 2));
    for (int face = 0; face < 6; ++face)
        for (int y = -1; y <= size; ++y)
            for (int x = -1; x <= size; ++x) sources.push_back(borderSource(face, x, y, size));
    return sources;
}

// Where the texels of one group come from.
struct GroupImages {
    int width, height, count;  ///< count images of width × height
    std::vector<BorderSource> sources;
};

GroupImages groupImages(const NormalTable& table) {
    if (table.layout == "cube") return {table.size + 2, table.size + 2, 6, borderSources(table.size)};
    const auto [width, height] = table.imageSize();
    GroupImages images{width, height, 1, {}};
    for (int i = 0; i < width * height; ++i) images.sources.push_back({{i, i, i}});
    return images;
}

// One RGBA group from up to four planes [texels] (null: zeros).
void fillGroup(const std::vector<BorderSource>& sources, const float* const planes[4], std::span<float> out) {
    for (int channel = 0; channel < 4; ++channel) {
        const float* plane = planes[channel];
        if (!plane) continue;
        for (size_t i = 0; i < sources.size(); ++i) {
            const auto& [a, b, c] = sources[i].texel;
            out[i * 4 + size_t(channel)] = a == b ? plane[a] : (plane[a] + plane[b] + plane[c]) / 3;
        }
    }
}

}  // namespace

CoefficientImage uploadCoefficients(const GlContext& context, const PointGrid& grid, int perPoint,
                                    std::span<const float> values, const char* where) {
    PRT_CHECK_EQ(values.size(), grid.count * size_t(perPoint));
    const GlFunctions& gl = context.gl();
    CoefficientImage image;
    image.grid = grid;
    image.layers = (perPoint + 3) / 4;
    image.texture = makeArray(context, grid.width, grid.height, image.layers, where);
    std::vector<float> layer(size_t(grid.width) * size_t(grid.height) * 4);
    for (int i = 0; i < image.layers; ++i) {
        const size_t first = size_t(i) * 4, used = std::min<size_t>(4, size_t(perPoint) - first);
        if (used < 4) std::fill(layer.begin(), layer.end(), 0.0f);
        parallelFor(grid.count, 65536, [&](size_t begin, size_t end) {
            for (size_t point = begin; point < end; ++point)
                std::copy_n(&values[point * size_t(perPoint) + first], used, &layer[point * 4]);
        });
        gl.TextureSubImage3D(image.texture.name(), 0, 0, 0, i, grid.width, grid.height, 1, GL_RGBA, GL_FLOAT,
                             layer.data());
    }
    context.check(where);
    return image;
}

void shapeTable(const GlContext& context, const TableShape& shape, TableImage& image) {
    if (image.texture && image.shape == shape) return;
    image = {};
    image.texture = makeArray(context, shape.width, shape.height, shape.images, "table");
    image.shape = shape;
}

void uploadTable(const GlContext& context, const NormalTable& table, TableImage& image) {
    PRT_CHECK_EQ(table.values.size(), size_t(3) * size_t(table.layers) * table.texels());
    const GlFunctions& gl = context.gl();
    const bool mean = table.kind == TableKind::TripleProduct;
    const int used = mean ? table.layers - 1 : table.layers, layers = (used + 3) / 4;
    const int groups = 3 * layers + (mean ? 1 : 0);
    const auto [width, height, count, sources] = groupImages(table);
    shapeTable(context, {table.layout, table.size, layers, mean, width, height, groups * count}, image);
    std::vector<float> texels(size_t(groups) * sources.size() * 4, 0.0f);
    parallelFor(size_t(groups), 1, [&, &from = sources](size_t group, size_t) {
        const float* planes[4] = {};
        for (int k = 0; k < 4; ++k) {
            if (int(group) == 3 * layers) {
                planes[k] = k < 3 ? table.layer(k, used) : nullptr;
                continue;
            }
            const int colour = int(group) / layers, index = int(group) % layers * 4 + k;
            planes[k] = index < used ? table.layer(colour, index) : nullptr;
        }
        fillGroup(from, planes, std::span(texels).subspan(group * from.size() * 4, from.size() * 4));
    });
    gl.TextureSubImage3D(image.texture.name(), 0, 0, 0, 0, width, height, groups * count, GL_RGBA, GL_FLOAT,
                         texels.data());
    context.check("uploading a table");
}

}  // namespace prt
