// Principal component analysis of visibility vectors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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

/// Mean and covariance of rows that arrive in parts: what principal vectors are made of. Memory does not
/// depend on the number of rows. The same parts give the same bits, for any number of threads.
///
/// Blocks of 1024 rows are squared in float about their own mean; blocks are joined in double:
///   S_ab = S_a + S_b + δ δᵀ n_a n_b / (n_a + n_b),  δ = mean_b − mean_a
/// so that neither large means nor rows in sorted order cost digits.
/// @source [ChanGolubLeVeque1983, Eq. 2.1] for the sum of parts
class RowMoments {
  public:
    /// @param dimension  d, at least 1
    explicit RowMoments(int dimension);
    ~RowMoments();
    RowMoments(RowMoments&&) noexcept;

    /// @param rows        [N×d]
    /// @param use         [N] non-zero for the rows to count; empty = all. Rows not in use may hold anything
    /// @param rowWeights  [N] finite, none negative, in any unit, what a row counts; empty = all 1
    /// @throws InputError  a row in use is not finite, or too large to be squared; Interrupted
    void add(std::span<const float> rows, std::span<const uint8_t> use = {},
             std::span<const float> rowWeights = {});

    int dimension() const;
    size_t rowsSeen() const;                 ///< of all parts
    size_t rowsUsed() const;                 ///< those that counted
    double weight() const;                   ///< sum of their weights
    std::vector<double> mean() const;        ///< [d]; needs weight() > 0
    std::vector<double> covariance() const;  ///< [d×d] (1/weight) Σ a (x − mean)(x − mean)ᵀ

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Principal vectors of the rows that the moments saw. Their covariance is formed, whatever the order of the
/// SH: at most 100 x 100 (80 kB) for the ten bands of a bundle. Lanczos on products with the rows in its
/// place (leadingVectors takes either) goes through all rows about 60 times for 16 vectors, and takes 8 to 13
/// times as long at 36, 100 and 400 columns (bench_pca).
/// @param components  1..d (vectors beyond the rank are arbitrary orthonormal ones with zero variance)
/// @throws InputError  no rows in use, or all of weight zero
PcaResult principalComponents(const RowMoments& moments, int components);

/// Turns the vectors of `pca` within their span to the principal axes of rows with this covariance, by
/// falling variance.
/// @param pca         basis orthonormal
/// @param covariance  [d×d]
/// @return pca with another basis and variance; its mean stays
PcaResult alignToCovariance(const PcaResult& pca, std::span<const double> covariance);

/// Those of rows in memory.
/// @param rows   [N×d], d = dimension
/// @param use    [N] non-zero for the rows to count; empty = all. Rows not in use may hold anything
/// @param components  1..d (rows beyond the rank get arbitrary orthonormal vectors with zero variance)
/// @throws InputError  no rows in use, or a row in use is not finite
/// Leading vectors by Spectra, or all by Eigen when M is near d. The same for any number of threads.
/// @param rowWeights  [N] what a row counts, as RowMoments::add; empty = all the same
/// @source [IwanickiSloan2012, Sec. 4]
PcaResult computePca(std::span<const float> rows, std::span<const uint8_t> use, int dimension, int components,
                     std::span<const float> rowWeights = {});

/// w = basis · (row − mean) for all N rows.  @return [N×M]
std::vector<float> projectPca(const PcaResult& pca, std::span<const float> rows, int dimension);
/// @param weights  [N×M] out
void projectPca(const PcaResult& pca, std::span<const float> rows, int dimension, std::span<float> weights);

/// How far mean + Σ w_m basis_m is from the rows in use.
struct PcaError {
    double relativeRmse = 0;  ///< √(Σ a|row − reconstruction|² / Σ a|row|²), a what a row counts
    double rmse = 0;          ///< √(Σ a|row − reconstruction|² / (Σ a·d)), per coefficient
};
/// The sums it is made of, which add up over parts of the rows.
struct PcaErrorSums {
    double error = 0, square = 0, weight = 0;
    PcaErrorSums& operator+=(const PcaErrorSums& other);
    PcaError result(int dimension) const;
};
/// @param rows  [N×d]   @param weights  [N×M]   @param use  [N], or empty = all
/// @param rowWeights  [N] as RowMoments::add
PcaErrorSums pcaErrorSums(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                          std::span<const uint8_t> use, int dimension,
                          std::span<const float> rowWeights = {});
/// The same of all rows at once, each counting 1.
PcaError pcaError(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                  std::span<const uint8_t> use, int dimension);

/// √(Σ|row − reconstruction|² / Σ|row|²) over the rows in use.
double pcaRelativeRmse(const PcaResult& pca, std::span<const float> rows, std::span<const float> weights,
                       std::span<const uint8_t> use, int dimension);

}  // namespace prt
