// Images over the surface normal that tables are kept in, as graphics hardware filters them.
//
//   layout           image                 what it is (math/sphere_map.h)
//   cube             size × 6·size         cube-seamless: six faces stacked, filtered across edges
//   dual-paraboloid  2·size × size         +Z left, −Z right, the equator on the outer ring of texel centres
//                                          of both: filtered within one square, no seam
//   octahedral       (size + 2)×(size + 2) octahedral with a border of one texel, which repeats what lies
//                                          over the edge: plain filtering, no seam
//
// Texels are numbered row by row. Texel centres are at half-integers; a direction falls on
//   dual-paraboloid  x = face·size + ½ + ½(s + 1)(size − 1)   y = ½ + ½(t + 1)(size − 1)
//   octahedral       x = 1 + ½(s + 1)·size                    y = 1 + ½(t + 1)·size
// with face, s and t as in math/sphere_map.h.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "precompute/math/sphere_map.h"

namespace prt {

/// Axes whose mirror images of a normal are looked for among a layout's texels.
enum class MirrorAxis { X, Y, Z };

/// One layout at one size. Immutable; every function may be called from any thread.
class TableLayout {
  public:
    /// Largest size, texels along the side of a face.
    static constexpr int kMaxSize = 1024;
    /// "cube", "dual-paraboloid", "octahedral".
    static const std::vector<std::string>& names();
    /// Smallest size of a layout: 2 for dual-paraboloid, else 1.
    /// @param name  one of names()
    static int minSize(const std::string& name);
    /// Width and height of a layout's image, texels.
    /// @param name  one of names(), else InputError
    static std::array<int, 2> imageSize(const std::string& name, int size);

    /// @param name  one of names()   @param size  texels along the side of a face, minSize(name)..kMaxSize
    /// @throws InputError  unknown name, size out of range
    /// @source [IwanickiSloan2012, Sec. 3.2 and Appendix A], [ShirleyChiu1997], [PraunHoppe2003]
    TableLayout(const std::string& name, int size);

    const std::string& name() const { return name_; }
    int size() const { return size_; }
    /// Of the image, texels.
    int width() const { return width_; }
    int height() const { return height_; }
    /// width · height: repeated texels (equator, border) counted.
    int texelCount() const { return width_ * height_; }

    /// Unit normal that a texel is filled for; repeated texels have the normal they repeat.
    /// @param texel  in [0, texelCount)
    Vec3d normal(int texel) const;
    /// Bilinear lookup as the hardware does it, seamless for the cube.
    /// @param direction  any length > 0
    /// @return texels in [0, texelCount), weights ≥ 0 that sum to 1
    SphereTaps taps(const Vec3d& direction) const;
    /// The texel whose normal is this one's with one coordinate negated.
    /// @param texel  in [0, texelCount)
    /// @return −1 for all texels of the octahedral layout and z, where mirroring transposes the image
    int mirrored(int texel, MirrorAxis axis) const;

  private:
    enum class Kind { Cube, DualParaboloid, Octahedral };

    static Kind kindOf(const std::string& name);
    int imageFromMap(int mapTexel) const;
    int mapFromImage(int texel) const;

    std::string name_;
    Kind kind_;
    int size_, width_, height_;
    std::shared_ptr<const SphereMap> map_;
};

}  // namespace prt
