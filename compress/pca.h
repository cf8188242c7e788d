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
    std::vector<float> variance;   ///< [M] eigenvalues of the covariance (1/N) Σ (x − mean)(x − mean)ᵀ
    double totalVariance = 0;      ///< trace of the covariance
    double explainedVariance = 0;  ///< share of totalVariance in the M components; 1 when there is none
};

/// @param rows   [N×d], d = dimension
/// @param use    [N] non-zero for the rows to count; empty = all. Rows not in use may hold anything
/// @param components  1..d (rows beyond the rank get arbitrary orthonormal vectors with zero variance)
/// @throws InputError  no rows in use, or a row in use is not finite
/// Covariance in blocks of float products accumulated in double; leading vectors by Spectra, or all by Eigen
/// when M is near d. The same for any number of threads.
/// @source [IwanickiSloan2012, Sec. 4]
PcaResult computePca(std::span<const float> rows, std::span<const uint8_t> use, int dimension,
                     int components);

/// w = basis · (row − mean) for all N rows.  @return [N×M]
std::vector<float> projectPca(const PcaResult& pca, std::span<const float> rows, int dimension);

/// How far mean + Σ w_m basis_m is from the rows in use.
struct PcaError {
    double relativeRmse = 0;  ///< √(Σ|row − reconstruction|² / Σ|row|²)
    double rmse = 0;          ///< √(Σ|row − reconstruction|² / (N·d)), per coefficient
};
/// @param rows  [N×d]   @param weights  [N×M]   @param use  [N], or empty = all
PcaError pcaError(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                  std::span<const uint8_t> use, int dimension);

/// √(Σ|row − reconstruction|² / Σ|row|²) over the rows in use.
double pcaRelativeRmse(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                       std::span<const uint8_t> use, int dimension);

}  // namespace prt
