// Sources: glTF 2.0, sections 3.8-3.9 (texture coordinates, materials, normal maps).
#include "runtime/scene_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <string_view>

#include "precompute/base/error.h"
#include "precompute/io/image.h"

namespace prt {
namespace {

template <typename T>
GlBufferTexture bufferOf(const GlFunctions& gl, GLenum format, const std::vector<T>& values,
                         const char* what) {
    return {gl, format, std::as_bytes(std::span(values)), values.size(), what};
}

bool hasExtension(const GlFunctions& gl, std::string_view wanted) {
    const GLint count = glInteger(gl, GL_NUM_EXTENSIONS);
    for (GLint i = 0; i < count; ++i)
        if (wanted == reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, GLuint(i)))) return true;
    return false;
}

// Trilinear, repeating, and anisotropic where it can be had: walls and floors are seen at grazing angles.
GlObject makeMaterialSampler(const GlFunctions& gl) {
    constexpr GLenum kMaxAnisotropy = 0x84FE;  // GL_TEXTURE_MAX_ANISOTROPY, core only since 4.6
    constexpr GLenum kMaxMaxAnisotropy = 0x84FF;
    GlObject sampler = makeSampler(gl);
    gl.SamplerParameteri(sampler.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.SamplerParameteri(sampler.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.SamplerParameteri(sampler.name(), GL_TEXTURE_WRAP_S, GL_REPEAT);
    gl.SamplerParameteri(sampler.name(), GL_TEXTURE_WRAP_T, GL_REPEAT);
    if (hasExtension(gl, "GL_EXT_texture_filter_anisotropic") ||
        hasExtension(gl, "GL_ARB_texture_filter_anisotropic")) {
        GLfloat most = 1;
        gl.GetFloatv(kMaxMaxAnisotropy, &most);
        gl.SamplerParameterf(sampler.name(), kMaxAnisotropy, std::min(most, 8.0f));
    }
    return sampler;
}

GlObject uploadTexture(const GlContext& context, const SceneTexture& source, bool srgb) {
    const GlFunctions& gl = context.gl();
    const std::string where = "texture " + source.name;
    const ByteImage image = decodeImage(source.encoded, where);
    const GLint edge = glInteger(gl, GL_MAX_TEXTURE_SIZE);
    if (image.width > edge || image.height > edge)
        throw InputError(
            where,
            fmt::format("{}x{} is more than the {} that OpenGL takes here", image.width, image.height, edge),
            "scale it down");
    const int levels = int(std::bit_width(unsigned(std::max(image.width, image.height))));
    GlObject texture = makeTexture(gl, GL_TEXTURE_2D);
    gl.TextureStorage2D(texture.name(), levels, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, image.width, image.height);
    gl.TextureSubImage2D(texture.name(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                         image.pixels.data());
    gl.GenerateTextureMipmap(texture.name());
    context.check(where);
    return texture;
}

}  // namespace

SceneImages::SceneImages(const GlContext& context, const Scene& scene)
    : context_(context),
      gl_(context.gl()),
      hasTangents_(!scene.tangents.empty()),
      hasUv0_(!scene.uv0.empty()),
      hasUv1_(!scene.uv1.empty()),
      sampler_(makeMaterialSampler(gl_)),
      vertexArray_(makeVertexArray(gl_)),
      program_(gl_, "surface.vert", "surface.frag", "") {
    if (scene.indices.empty()) throw InputError("scene", "there is no triangle");
    if (scene.normals.empty())
        throw InputError("scene", "the mesh has no normals", "pass it through prt precompute");
    uploadGeometry(scene);
    uploadMaterials(scene);
    context_.check("uploading the scene");
}

void SceneImages::uploadGeometry(const Scene& scene) {
    indices_ = bufferOf(gl_, GL_R32UI, scene.indices, "indices");
    positions_ = bufferOf(gl_, GL_RGB32F, scene.positions, "positions");
    normals_ = bufferOf(gl_, GL_RGB32F, scene.normals, "normals");
    tangents_ = bufferOf(gl_, GL_RGBA32F, scene.tangents, "tangents");
    uv0_ = bufferOf(gl_, GL_RG32F, scene.uv0, "texture coordinates");
    uv1_ = bufferOf(gl_, GL_RG32F, scene.uv1, "atlas coordinates");
    for (const ScenePrimitive& primitive : scene.primitives) {
        if (primitive.indexCount == 0) continue;
        const size_t material = primitive.material >= 0 ? size_t(primitive.material) : scene.materials.size();
        runs_.push_back({GLint(primitive.firstIndex), GLsizei(primitive.indexCount),
                         std::min(material, scene.materials.size())});
    }
}

void SceneImages::uploadMaterials(const Scene& scene) {
    white_ = makeImage(gl_, GL_RGBA8, 1, 1);
    const uint8_t white[4] = {255, 255, 255, 255};
    gl_.TextureSubImage2D(white_.name(), 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, white);
    std::vector<SceneMaterial> sources = scene.materials;
    sources.emplace_back();  // for primitives without a material
    for (const SceneMaterial& source : sources) {
        const bool textured = source.baseColorTexture >= 0, bumped = source.normalTexture >= 0;
        if ((textured || bumped) && !hasUv0_)
            throw InputError("material " + source.name,
                             "has textures, but the mesh has no texture coordinates",
                             "pass it through prt precompute");
        if (bumped && !hasTangents_)
            throw InputError("material " + source.name, "has a normal map, but the mesh has no tangents",
                             "pass it through prt precompute");
        materials_.push_back({source.baseColor,
                              textured ? texture(scene, source.baseColorTexture, true) : white_.name(),
                              bumped ? texture(scene, source.normalTexture, false) : white_.name(),
                              source.normalScale, bumped, source.doubleSided});
    }
}

GLuint SceneImages::texture(const Scene& scene, int index, bool srgb) {
    const auto [entry, isNew] = textures_.try_emplace({index, srgb});
    if (isNew) entry->second = uploadTexture(context_, scene.textures.at(size_t(index)), srgb);
    return entry->second.name();
}

void SceneImages::draw(const CameraFrame& camera, bool normalMap, int samples) const {
    if (samples > 1 && !multisampled_)
        multisampled_.emplace(gl_, "surface.vert", "surface.frag", "#define MULTISAMPLED\n");
    const GlProgram& program = samples > 1 ? *multisampled_ : program_;
    program.use();
    program.set("eye", camera.eye);
    program.set("clipFromEyeOffset", camera.clipFromEyeOffset);
    program.set("hasTangents", hasTangents_);
    program.set("hasUv0", hasUv0_);
    program.set("hasUv1", hasUv1_);
    const GlBufferTexture* buffers[] = {&indices_, &positions_, &normals_, &tangents_, &uv0_, &uv1_};
    GLuint unit = 0;
    for (const GlBufferTexture* buffer : buffers) gl_.BindTextureUnit(unit++, buffer->texture());
    gl_.BindSampler(6, sampler_.name());
    gl_.BindSampler(7, sampler_.name());
    gl_.BindVertexArray(vertexArray_.name());
    for (const Run& run : runs_) {
        const Material& material = materials_[run.material];
        program.set("baseColor", material.baseColor);
        program.set("normalScale", material.normalScale);
        program.set("useNormalMap", material.hasNormalMap && normalMap);
        gl_.BindTextureUnit(6, material.baseColorTexture);
        gl_.BindTextureUnit(7, material.normalTexture);
        // The back of a wall must not hide the room behind it.
        if (material.doubleSided)
            gl_.Disable(GL_CULL_FACE);
        else
            gl_.Enable(GL_CULL_FACE);
        gl_.DrawArrays(GL_TRIANGLES, run.first, run.count);
    }
    gl_.Disable(GL_CULL_FACE);
    gl_.BindSampler(6, 0);
    gl_.BindSampler(7, 0);
}

}  // namespace prt
