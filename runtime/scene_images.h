// Geometry, materials and textures of a scene, and drawing what a camera sees of them. Internal.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "precompute/io/scene.h"
#include "runtime/camera_frame.h"
#include "runtime/gl_context.h"
#include "runtime/gl_objects.h"

namespace prt {

class SceneImages {
  public:
    /// @throws InputError  no normals, no tangents or uv0 where a texture needs them, a texture that cannot
    /// be decoded, or limits of OpenGL exceeded
    SceneImages(const GlContext& context, const Scene& scene);

    /// Draws every primitive into the bound framebuffer (outputs of surface.frag).
    /// @param samples  of its pixels
    void draw(const CameraFrame& camera, bool normalMap, int samples) const;
    /// Vertex indices, three per triangle.
    GLuint indices() const { return indices_.texture(); }

  private:
    struct Material {
        Vec3f baseColor;
        GLuint baseColorTexture, normalTexture;
        float normalScale;
        bool hasNormalMap, doubleSided;
    };
    struct Run {
        GLint first;
        GLsizei count;
        size_t material;
    };
    void uploadGeometry(const Scene& scene);
    void uploadMaterials(const Scene& scene);
    /// One texture per image and use: colours are sRGB, normals linear.
    GLuint texture(const Scene& scene, int index, bool srgb);

    const GlContext& context_;
    const GlFunctions& gl_;
    GlBufferTexture indices_, positions_, normals_, tangents_, uv0_, uv1_;
    bool hasTangents_, hasUv0_, hasUv1_;
    std::vector<Material> materials_;
    std::vector<Run> runs_;
    std::map<std::pair<int, bool>, GlObject> textures_;
    GlObject white_, sampler_, vertexArray_;
    GlProgram program_;
    mutable std::optional<GlProgram> multisampled_;  // made when first drawn with
};

}  // namespace prt
