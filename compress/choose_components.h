// How many principal vectors a wanted accuracy takes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/compress_visibility.h"
#include "precompute/math/environment.h"

namespace prt {

/// Visibility compressed to a number of vectors that was found, and what relighting loses by it.
struct ChosenCompression {
    CompressedVisibility compressed;
    std::vector<double> relitErrors;  ///< [environments] as RelitProbe::relativeRmse against the rows
};

/// Relative RMSE of irradiance that compressed visibility gives, against the rows themselves.
/// @param environments  each of tableEnvironmentShOrder(shOrder) bands or more
/// @return [environments]
std::vector<double> relitErrors(const CompressedVisibility& compressed, std::span<const float> rows,
                                std::span<const uint8_t> use, std::span<const Vec3f> normals, int shOrder,
                                std::span<const EnvironmentSh> environments);

/// The least number of vectors with which the largest of relitErrors() is at most `targetError`; n² where no
/// fewer suffice. Searched by halving on a sample of the rows, then checked on all.
/// @param targetError  > 0
/// Others as of compressVisibility and relitErrors.
/// @throws InputError  as computePca
ChosenCompression compressToError(std::span<const float> rows, std::span<const uint8_t> use,
                                  std::span<const Vec3f> normals, int shOrder, const Projection& projection,
                                  WeightsFit fit, std::span<const EnvironmentSh> environments,
                                  double targetError);

}  // namespace prt
