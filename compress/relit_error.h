// What an error of visibility looks like under real light.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "precompute/math/environment.h"
#include "precompute/math/vec.h"

namespace prt {

/// Points and shading normals at which irradiance is compared: the geometric normal and four normals tilted
/// from it by 20 degrees, as normal maps do.
class RelitProbe {
  public:
    /// @param normals       [N] geometric, unit; zero: the point is not taken
    /// @param use           [N] non-zero for points that count, or empty = all
    /// @param environments  at least one, each of tableEnvironmentShOrder(shOrder) bands or more
    /// @param mostPoints    spread evenly over those in use
    RelitProbe(int shOrder, std::span<const Vec3f> normals, std::span<const uint8_t> use,
               std::span<const EnvironmentSh> environments, size_t mostPoints = 2048);

    /// Indices of the points that are looked at.
    const std::vector<uint32_t>& points() const { return points_; }
    /// Relative RMSE of irradiance under each environment, colours and normals together:
    /// √(Σ (E_other − E)² / Σ E²).
    /// @param rows, others  [points().size() × n²] coefficients of visibility at points()
    /// @return [environments]
    std::vector<double> relativeRmse(std::span<const float> rows, std::span<const float> others) const;

  private:
    int shOrder_;
    std::vector<uint32_t> points_;
    std::vector<std::vector<float>> light_;  // of each environment [3][n²][point × normal]
};

}  // namespace prt
