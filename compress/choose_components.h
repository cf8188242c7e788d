// How many principal vectors a wanted accuracy takes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compress/compress_visibility.h"
#include "precompute/math/environment.h"

namespace prt {

/// Relative RMSE of irradiance that compressed visibility gives, against the rows themselves.
/// @param environments  each of tableEnvironmentShOrder(shOrder) bands or more
/// @return [environments]
std::vector<double> relitErrors(const CompressedVisibility& compressed, std::span<const float> rows,
                                std::span<const uint8_t> use, std::span<const Vec3f> normals, int shOrder,
                                std::span<const EnvironmentSh> environments);

/// Principal vectors whose number was found, and what relighting loses by them.
struct ChosenBasis {
    PcaResult pca;
    std::vector<double> relitErrors;  ///< [environments] as RelitProbe::relativeRmse
};

/// The least number of vectors with which the largest relative RMSE of irradiance under the environments is
/// at most `targetError`, at 2048 of the sampled points; n² where no fewer suffice. Searched by halving: with
/// one vector fewer the error was seen to be larger.
/// @param settings      its number of components is not looked at
/// @param environments  each of tableEnvironmentShOrder(shOrder) bands or more
/// @param targetError   > 0
/// @throws InputError   as VisibilityStatistics::basis; Interrupted
ChosenBasis chooseBasis(const VisibilityStatistics& statistics, int shOrder, const Projection& projection,
                        CompressionSettings settings, std::span<const EnvironmentSh> environments,
                        double targetError);

}  // namespace prt
