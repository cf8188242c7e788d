// What share of light the surface of a scene reflects, at any point of it: for light that bounces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/io/scene.h"

namespace prt {

/// Diffuse reflectance of points of a scene: base colour times base-colour texture, decoded from sRGB,
/// bilinear in linear light, the texture repeated (the default of glTF), without mip levels; clamped to 0..1,
/// so that no surface gives back more than it gets.
class SurfaceAlbedo {
  public:
    /// Decodes every base-colour texture once.
    /// @param scene  as validateScene wants it; must outlive the object
    /// @throws InputError  a texture is damaged
    explicit SurfaceAlbedo(const Scene& scene);

    /// Linear reflectance per colour, 0..1.
    /// @param triangle  < scene.triangleCount()
    /// @param u, v      barycentric coordinates of corners 1 and 2 (RayHit)
    /// @source glTF 2.0, Sec. 3.9.2 (base colour) and 3.8.4 (wrapping); IEC 61966-2-1 (sRGB)
    Vec3f at(uint32_t triangle, float u, float v) const;
    /// Whether the back of a triangle reflects as its front does; other backs are black.
    bool doubleSided(uint32_t triangle) const {
        return scene_.materials[size_t(materialOf_[triangle])].doubleSided;
    }

  private:
    Vec3f texel(const ByteImage& image, int x, int y) const;
    Vec3f textureAt(const ByteImage& image, const Vec2f& uv) const;

    const Scene& scene_;
    std::vector<int> materialOf_;      // [triangles]
    std::vector<ByteImage> textures_;  // [scene.textures], those of base colours decoded
    std::array<float, 256> linear_{};  // of an sRGB byte
};

}  // namespace prt
