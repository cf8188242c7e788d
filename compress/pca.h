// Principal component analysis of visibility vectors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace prt {

struct PcaResult {
    int components = 0;
    std::vector<float> mean;  ///< [d]
    std::vector<float>
        basis;  ///< [M×d] orthonormal rows, falling variance; largest entry of each is positive
    std::vector<float> variance;   ///< [M]
    double totalVariance = 0;      ///< trace of the covariance
    double explainedVariance = 0;  ///< share of totalVariance in the M components; 1 when there is none
};

/// @param rows   [N×d], d = dimension
/// @param use    [N] non-zero for the rows to count; empty = all
/// @param components  1..d (rows beyond the rank get arbitrary orthonormal vectors with zero variance)
/// @throws InputError  no rows in use, or a row in use is not finite
/// Covariance in blocks of float products accumulated in double; leading vectors by Spectra, or all by Eigen
/// when M is near d.
PcaResult computePca(std::span<const float> rows, std::span<const uint8_t> use, int dimension,
                     int components);

/// w = basis · (row − mean) for all N rows.  @return [N×M]
std::vector<float> projectPca(const PcaResult& pca, std::span<const float> rows, int dimension);

/// √(Σ|row − reconstruction|² / Σ|row|²) over the rows in use.
double pcaRelativeRmse(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                       std::span<const uint8_t> use, int dimension);

}  // namespace prt
