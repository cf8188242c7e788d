// Directions towards the light of an environment, for sampling it where it is bright.
#pragma once

#include <vector>

#include "precompute/math/environment.h"

namespace prt {

/// Light from one direction.
struct LightSample {
    Vec3f direction = Vec3f::UnitY();  ///< unit, world
    Vec3f radiance = Vec3f::Zero();
    float pdf = 0;  ///< of EnvironmentSampler::sample to take it, 1/sr
};

/// An environment turned about the up axis, its radiance constant over each texel.
class EnvironmentSampler {
  public:
    /// @param image        at least one texel; must outlive the object
    /// @param rotationRad  light at longitude λ moves to λ + rotationRad (rotateEnvironmentAboutUp)
    EnvironmentSampler(const LatLongView& image, double rotationRad);

    /// Whether nothing shines: then there is nothing to sample.
    bool dark() const { return !(total_ > 0); }
    /// Chooses a texel in proportion to the sum of its colours times its solid angle, and a direction that is
    /// uniform in it.
    /// @param u1, u2  in [0, 1)
    /// @source pbrt's infinite lights [PharrJakobHumphreys2016, Sec. 14.2.4]
    LightSample sample(double u1, double u2) const;
    /// Radiance from a direction, and what sample() has for it.
    LightSample evaluate(const Vec3f& direction) const;

  private:
    LightSample ofTexel(int x, int y) const;

    LatLongView image_;
    double rotationRad_;
    double total_ = 0;           // Σ (R + G + B) ΔΩ
    std::vector<double> rows_;   // [height] flux of the rows up to this one, over the total
    std::vector<float> texels_;  // [height×width] share of its row of the texels up to this one
};

}  // namespace prt
