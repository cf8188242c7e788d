// Sources: tables are linear in the light [IwanickiSloan2012, Sec. 3.3]. All layers in one pass: a
// framebuffer for each costs llvmpipe more than the sums.
#include "runtime/table_blender.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "precompute/base/check.h"

namespace prt {
namespace {

constexpr size_t kMostSources = 16;  // texture units that every OpenGL has

}  // namespace

TableBlender::TableBlender(const GlContext& context)
    : context_(context), vertexArray_(makeVertexArray(context.gl())) {}

void TableBlender::blend(std::span<const TableImage* const> sources, std::span<const float> weights,
                         TableImage& result) {
    PRT_CHECK(!sources.empty());
    PRT_CHECK_EQ(sources.size(), weights.size());
    if (sources.size() <= kMostSources) {
        pass(sources, weights, result);
        return;
    }
    std::vector<TableImage> sums((sources.size() + kMostSources - 1) / kMostSources);
    std::vector<const TableImage*> addends;
    for (size_t i = 0; i < sums.size(); ++i) {
        const size_t first = i * kMostSources, count = std::min(kMostSources, sources.size() - first);
        pass(sources.subspan(first, count), weights.subspan(first, count), sums[i]);
        addends.push_back(&sums[i]);
    }
    blend(addends, std::vector<float>(sums.size(), 1.0f), result);
}

void TableBlender::pass(std::span<const TableImage* const> sources, std::span<const float> weights,
                        TableImage& result) {
    const TableImage& first = *sources[0];
    for (const TableImage* source : sources) PRT_CHECK(source != &result && source->shape == first.shape);
    shapeTable(context_, first.shape, result);
    // Few programs: numbers of sources are powers of two, and what is missing weighs nothing.
    const size_t slots = std::bit_ceil(sources.size());
    if (!programs_.contains(slots))
        programs_.try_emplace(slots, context_.gl(), "blend.vert", "blend.frag",
                              fmt::format("#define SOURCES {}\n", slots), "blend.geom");
    const GlProgram& program = programs_.at(slots);
    std::array<float, kMostSources> padded{};
    std::ranges::copy(weights, padded.begin());
    const GlFunctions& gl = context_.gl();
    if (!result.frame) result.frame = makeFramebufferOver(gl, {result.texture.name()}, 0);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, result.frame.name());
    gl.Viewport(0, 0, result.shape.width, result.shape.height);
    gl.Disable(GL_DEPTH_TEST);
    program.use();
    program.set("weights", std::span<const float>(padded).first(slots));
    for (size_t i = 0; i < slots; ++i)
        gl.BindTextureUnit(GLuint(i), sources[std::min(i, sources.size() - 1)]->texture.name());
    gl.BindVertexArray(vertexArray_.name());
    gl.DrawArraysInstanced(GL_TRIANGLES, 0, 3, result.shape.images);
    context_.check("blending tables");
}

}  // namespace prt
