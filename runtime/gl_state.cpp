// Sources: OpenGL 4.5 core profile, tables of state (section 23).
#include "runtime/gl_state.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "precompute/base/log.h"
#include "runtime/gl_debug.h"
#include "runtime/gl_functions.h"
#include "runtime/gl_objects.h"

namespace prt {
namespace {

constexpr GLuint kUnits = 16, kBuffers = 8;

/// What is switched on where nobody has changed anything.
struct Switch {
    GLenum what;
    bool normally;
};
constexpr Switch kSwitches[] = {{GL_CLIP_DISTANCE0, false},
                                {GL_CLIP_DISTANCE1, false},
                                {GL_CLIP_DISTANCE2, false},
                                {GL_CLIP_DISTANCE3, false},
                                {GL_CLIP_DISTANCE4, false},
                                {GL_CLIP_DISTANCE5, false},
                                {GL_CLIP_DISTANCE6, false},
                                {GL_CLIP_DISTANCE7, false},
                                {GL_COLOR_LOGIC_OP, false},
                                {GL_CULL_FACE, false},
                                {GL_DEPTH_CLAMP, false},
                                {GL_DEPTH_TEST, false},
                                {GL_FRAMEBUFFER_SRGB, false},
                                {GL_MULTISAMPLE, true},
                                {GL_POLYGON_OFFSET_FILL, false},
                                {GL_PRIMITIVE_RESTART, false},
                                {GL_PRIMITIVE_RESTART_FIXED_INDEX, false},
                                {GL_RASTERIZER_DISCARD, false},
                                {GL_SAMPLE_ALPHA_TO_COVERAGE, false},
                                {GL_SAMPLE_ALPHA_TO_ONE, false},
                                {GL_SAMPLE_COVERAGE, false},
                                {GL_SAMPLE_MASK, false},
                                {GL_SAMPLE_SHADING, false},
                                {GL_SCISSOR_TEST, false},
                                {GL_STENCIL_TEST, false},
                                {GL_TEXTURE_CUBE_MAP_SEAMLESS, false}};

/// Layout of pixels in memory, and the layout of nobody's choice.
struct PixelStore {
    GLenum what;
    GLint normally;
};
constexpr PixelStore kPixelStores[] = {
    {GL_PACK_SWAP_BYTES, 0},   {GL_PACK_LSB_FIRST, 0},     {GL_PACK_ROW_LENGTH, 0},
    {GL_PACK_IMAGE_HEIGHT, 0}, {GL_PACK_SKIP_ROWS, 0},     {GL_PACK_SKIP_PIXELS, 0},
    {GL_PACK_SKIP_IMAGES, 0},  {GL_PACK_ALIGNMENT, 4},     {GL_UNPACK_SWAP_BYTES, 0},
    {GL_UNPACK_LSB_FIRST, 0},  {GL_UNPACK_ROW_LENGTH, 0},  {GL_UNPACK_IMAGE_HEIGHT, 0},
    {GL_UNPACK_SKIP_ROWS, 0},  {GL_UNPACK_SKIP_PIXELS, 0}, {GL_UNPACK_SKIP_IMAGES, 0},
    {GL_UNPACK_ALIGNMENT, 4}};

constexpr std::pair<GLenum, GLenum> kTextures[] = {
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
    {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY},
    {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER}};

void turn(const GlFunctions& gl, GLenum what, bool on) { on ? gl.Enable(what) : gl.Disable(what); }

/// One texture unit.
struct Unit {
    std::array<GLint, std::size(kTextures)> textures{};
    GLint sampler = 0;
};

/// One colour buffer.
struct Buffer {
    bool blend = false;
    GLboolean mask[4] = {};
};

}  // namespace

struct GlStateGuard::State {
    State(const GlContext& context, bool& isGuarded) : gl(context.gl()), guarded(isGuarded) {
        takeErrors();
        save();
        setNormal();
        guarded = true;
    }

    void takeErrors() const {
        std::string errors;
        for (int i = 0; i < 16; ++i) {
            const GLenum error = gl.GetError();
            if (error == GL_NO_ERROR) break;
            errors += std::string(errors.empty() ? "" : ", ") + glErrorName(error);
        }
        if (!errors.empty()) logWarning("OpenGL: the caller left unread: " + errors);
    }

    void save() {
        drawFramebuffer = GLuint(glInteger(gl, GL_DRAW_FRAMEBUFFER_BINDING));
        readFramebuffer = GLuint(glInteger(gl, GL_READ_FRAMEBUFFER_BINDING));
        viewports.resize(size_t(glInteger(gl, GL_MAX_VIEWPORTS)));
        for (size_t i = 0; i < viewports.size(); ++i)
            gl.GetFloati_v(GL_VIEWPORT, GLuint(i), viewports[i].data());
        gl.GetDoublei_v(GL_DEPTH_RANGE, 0, depthRange);
        clipOrigin = GLenum(glInteger(gl, GL_CLIP_ORIGIN));
        clipDepth = GLenum(glInteger(gl, GL_CLIP_DEPTH_MODE));
        for (size_t i = 0; i < std::size(kSwitches); ++i) switches[i] = gl.IsEnabled(kSwitches[i].what);
        for (GLuint i = 0; i < kBuffers; ++i) {
            buffers[i].blend = gl.IsEnabledi(GL_BLEND, i);
            gl.GetBooleani_v(GL_COLOR_WRITEMASK, i, buffers[i].mask);
        }
        depthFunc = GLenum(glInteger(gl, GL_DEPTH_FUNC));
        gl.GetBooleanv(GL_DEPTH_WRITEMASK, &depthMask);
        frontFace = GLenum(glInteger(gl, GL_FRONT_FACE));
        cullFace = GLenum(glInteger(gl, GL_CULL_FACE_MODE));
        GLint modes[2] = {GL_FILL, GL_FILL};  // compatibility profiles give two, for front and back
        gl.GetIntegerv(GL_POLYGON_MODE, modes);
        polygonMode = GLenum(modes[0]);
        provokingVertex = GLenum(glInteger(gl, GL_PROVOKING_VERTEX));
        program = GLuint(glInteger(gl, GL_CURRENT_PROGRAM));
        vertexArray = GLuint(glInteger(gl, GL_VERTEX_ARRAY_BINDING));
        saveUnits();
        packBuffer = GLuint(glInteger(gl, GL_PIXEL_PACK_BUFFER_BINDING));
        unpackBuffer = GLuint(glInteger(gl, GL_PIXEL_UNPACK_BUFFER_BINDING));
        for (size_t i = 0; i < std::size(kPixelStores); ++i)
            pixelStores[i] = glInteger(gl, kPixelStores[i].what);
    }

    void saveUnits() {
        activeTexture = GLenum(glInteger(gl, GL_ACTIVE_TEXTURE));
        for (GLuint u = 0; u < kUnits; ++u) {
            gl.ActiveTexture(GL_TEXTURE0 + u);
            for (size_t t = 0; t < std::size(kTextures); ++t)
                units[u].textures[t] = glInteger(gl, kTextures[t].second);
            units[u].sampler = glInteger(gl, GL_SAMPLER_BINDING);
            gl.BindSampler(u, 0);
        }
    }

    /// What a new context has, as far as drawing does not set it anyway.
    void setNormal() const {
        gl.DepthRangeIndexed(0, 0, 1);
        for (const Switch& each : kSwitches) turn(gl, each.what, each.normally);
        for (GLuint i = 0; i < kBuffers; ++i) {
            gl.Disablei(GL_BLEND, i);
            gl.ColorMaski(i, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        }
        gl.FrontFace(GL_CCW);
        gl.CullFace(GL_BACK);
        gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
        gl.ProvokingVertex(GL_LAST_VERTEX_CONVENTION);
        gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        for (const PixelStore& each : kPixelStores) gl.PixelStorei(each.what, each.normally);
    }

    void restore() const {
        guarded = false;
        gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, drawFramebuffer);
        gl.BindFramebuffer(GL_READ_FRAMEBUFFER, readFramebuffer);
        for (size_t i = 0; i < viewports.size(); ++i) gl.ViewportIndexedfv(GLuint(i), viewports[i].data());
        gl.DepthRangeIndexed(0, depthRange[0], depthRange[1]);
        gl.ClipControl(clipOrigin, clipDepth);
        for (size_t i = 0; i < std::size(kSwitches); ++i) turn(gl, kSwitches[i].what, switches[i]);
        for (GLuint i = 0; i < kBuffers; ++i) {
            buffers[i].blend ? gl.Enablei(GL_BLEND, i) : gl.Disablei(GL_BLEND, i);
            const GLboolean* mask = buffers[i].mask;
            gl.ColorMaski(i, mask[0], mask[1], mask[2], mask[3]);
        }
        gl.DepthFunc(depthFunc);
        gl.DepthMask(depthMask);
        gl.FrontFace(frontFace);
        gl.CullFace(cullFace);
        gl.PolygonMode(GL_FRONT_AND_BACK, polygonMode);
        gl.ProvokingVertex(provokingVertex);
        gl.UseProgram(program);
        gl.BindVertexArray(vertexArray);
        restoreUnits();
        gl.BindBuffer(GL_PIXEL_PACK_BUFFER, packBuffer);
        gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, unpackBuffer);
        for (size_t i = 0; i < std::size(kPixelStores); ++i)
            gl.PixelStorei(kPixelStores[i].what, pixelStores[i]);
    }

    void restoreUnits() const {
        for (GLuint u = 0; u < kUnits; ++u) {
            gl.ActiveTexture(GL_TEXTURE0 + u);
            for (size_t t = 0; t < std::size(kTextures); ++t)
                gl.BindTexture(kTextures[t].first, GLuint(units[u].textures[t]));
            gl.BindSampler(u, GLuint(units[u].sampler));
        }
        gl.ActiveTexture(activeTexture);
    }

    const GlFunctions& gl;
    bool& guarded;
    GLuint drawFramebuffer = 0, readFramebuffer = 0, program = 0, vertexArray = 0;
    GLuint packBuffer = 0, unpackBuffer = 0;
    std::vector<std::array<GLfloat, 4>> viewports;
    GLdouble depthRange[2] = {};
    GLenum clipOrigin = 0, clipDepth = 0, depthFunc = 0, frontFace = 0, cullFace = 0, polygonMode = 0;
    GLenum provokingVertex = 0, activeTexture = 0;
    GLboolean depthMask = GL_TRUE;
    std::array<bool, std::size(kSwitches)> switches{};
    std::array<Buffer, kBuffers> buffers{};
    std::array<Unit, kUnits> units{};
    std::array<GLint, std::size(kPixelStores)> pixelStores{};
};

GlStateGuard::GlStateGuard(const GlContext& context) {
    context.makeCurrent();
    if (context.kind() == GlContextKind::Current && !context.guarded_)
        state_ = std::make_unique<State>(context, context.guarded_);
}

GlStateGuard::~GlStateGuard() {
    if (state_) state_->restore();
}

}  // namespace prt
