// Sources: OpenGL 4.5 core profile (direct state access).
#include "runtime/gl_objects.h"

#include <fmt/format.h>

#include <atomic>
#include <vector>

#include "precompute/base/error.h"
#include "runtime/shader_sources.h"

namespace prt {
namespace {

std::atomic<size_t> liveCount{0};

GlObject compileShader(const GlFunctions& gl, GLenum stage, const std::string& name,
                       const std::string& defines) {
    GlObject shader(gl, gl.CreateShader(stage), [](const GlFunctions& f, GLuint n) { f.DeleteShader(n); });
    const std::string text = shaderText(name, defines);
    const char* const lines = text.c_str();
    gl.ShaderSource(shader.name(), 1, &lines, nullptr);
    gl.CompileShader(shader.name());
    GLint compiled = 0;
    gl.GetShaderiv(shader.name(), GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        char log[4096] = "";
        gl.GetShaderInfoLog(shader.name(), sizeof log, nullptr, log);
        throw Error("OpenGL", "shader " + name + " does not compile: " + log);
    }
    return shader;
}

// A program that is in use lives on, and its shaders with it.
void deleteProgram(const GlFunctions& gl, GLuint name) {
    if (GLuint(glInteger(gl, GL_CURRENT_PROGRAM)) == name) gl.UseProgram(0);
    gl.DeleteProgram(name);
}

}  // namespace

size_t liveGlObjects() { return liveCount; }

GlObject::GlObject(const GlFunctions& gl, GLuint name, Delete destroy)
    : gl_(&gl), name_(name), delete_(destroy) {
    if (name_) ++liveCount;
}

GlObject::~GlObject() {
    if (!name_) return;
    delete_(*gl_, name_);
    --liveCount;
}

GlObject makeTexture(const GlFunctions& gl, GLenum target) {
    GLuint name = 0;
    gl.CreateTextures(target, 1, &name);
    // Shaders fetch texels by number; what is filtered gets a sampler. Integer textures need this, too.
    if (target != GL_TEXTURE_BUFFER && target != GL_TEXTURE_2D_MULTISAMPLE) {
        gl.TextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl.TextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    return {gl, name, [](const GlFunctions& f, GLuint n) { f.DeleteTextures(1, &n); }};
}

GlObject makeFramebuffer(const GlFunctions& gl) {
    GLuint name = 0;
    gl.CreateFramebuffers(1, &name);
    return {gl, name, [](const GlFunctions& f, GLuint n) { f.DeleteFramebuffers(1, &n); }};
}

GlObject makeVertexArray(const GlFunctions& gl) {
    GLuint name = 0;
    gl.CreateVertexArrays(1, &name);
    return {gl, name, [](const GlFunctions& f, GLuint n) { f.DeleteVertexArrays(1, &n); }};
}

GlObject makeSampler(const GlFunctions& gl) {
    GLuint name = 0;
    gl.CreateSamplers(1, &name);
    return {gl, name, [](const GlFunctions& f, GLuint n) { f.DeleteSamplers(1, &n); }};
}

GlObject makeImage(const GlFunctions& gl, GLenum internalFormat, int width, int height) {
    GlObject image = makeTexture(gl, GL_TEXTURE_2D);
    gl.TextureStorage2D(image.name(), 1, internalFormat, width, height);
    return image;
}

GlObject makeSampledImage(const GlFunctions& gl, GLenum internalFormat, int width, int height, int samples) {
    if (samples == 1) return makeImage(gl, internalFormat, width, height);
    GlObject image = makeTexture(gl, GL_TEXTURE_2D_MULTISAMPLE);
    gl.TextureStorage2DMultisample(image.name(), samples, internalFormat, width, height, GL_TRUE);
    return image;
}

GlBufferTexture::GlBufferTexture(const GlFunctions& gl, GLenum internalFormat,
                                 std::span<const std::byte> bytes, size_t elements, const char* what) {
    const GLint limit = glInteger(gl, GL_MAX_TEXTURE_BUFFER_SIZE);
    if (elements > size_t(limit))
        throw InputError(
            "scene", fmt::format("{} {} are more than the {} that OpenGL takes here", elements, what, limit),
            "simplify the mesh");
    GLuint name = 0;
    gl.CreateBuffers(1, &name);
    buffer_ = GlObject(gl, name, [](const GlFunctions& f, GLuint n) { f.DeleteBuffers(1, &n); });
    // An attribute that the scene lacks still needs storage for its texture to be complete.
    static constexpr std::byte kNothing[16] = {};
    if (bytes.empty()) bytes = kNothing;
    gl.NamedBufferStorage(name, GLsizeiptr(bytes.size()), bytes.data(), 0);
    texture_ = makeTexture(gl, GL_TEXTURE_BUFFER);
    gl.TextureBuffer(texture_.name(), internalFormat, name);
}

GlProgram::GlProgram(const GlFunctions& gl, const std::string& vertex, const std::string& fragment,
                     const std::string& defines, const std::string& geometry)
    : gl_(&gl), program_(gl, gl.CreateProgram(), deleteProgram) {
    std::vector<GlObject> shaders;
    for (const auto& [stage, name] :
         {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_GEOMETRY_SHADER, geometry),
          std::pair(GL_FRAGMENT_SHADER, fragment)}) {
        if (name.empty()) continue;
        shaders.push_back(compileShader(gl, GLenum(stage), name, defines));
        gl.AttachShader(program_.name(), shaders.back().name());
    }
    gl.LinkProgram(program_.name());
    GLint linked = 0;
    gl.GetProgramiv(program_.name(), GL_LINK_STATUS, &linked);
    if (!linked) {
        char log[4096] = "";
        gl.GetProgramInfoLog(program_.name(), sizeof log, nullptr, log);
        throw Error("OpenGL", fmt::format("shaders {} and {} do not link: {}", vertex, fragment, log));
    }
}

GlObject makeFramebufferOver(const GlFunctions& gl, std::initializer_list<GLuint> colours, GLuint depth) {
    GlObject framebuffer = makeFramebuffer(gl);
    std::vector<GLenum> buffers;
    for (const GLuint colour : colours) {
        buffers.push_back(GLenum(GL_COLOR_ATTACHMENT0 + buffers.size()));
        gl.NamedFramebufferTexture(framebuffer.name(), buffers.back(), colour, 0);
    }
    if (depth != 0) gl.NamedFramebufferTexture(framebuffer.name(), GL_DEPTH_ATTACHMENT, depth, 0);
    gl.NamedFramebufferDrawBuffers(framebuffer.name(), GLsizei(buffers.size()), buffers.data());
    const GLenum status = gl.CheckNamedFramebufferStatus(framebuffer.name(), GL_DRAW_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw Error("OpenGL", fmt::format("the framebuffer is not complete (status {:#x})", status));
    return framebuffer;
}

GLint glInteger(const GlFunctions& gl, GLenum what) {
    GLint value = 0;
    gl.GetIntegerv(what, &value);
    return value;
}

}  // namespace prt
