// Banding: neighbouring points that share directions err alike, and where a silhouette passes a direction the
// error steps. How much of the error of a bake lies in waves that the eye follows, along lines on a made
// scene, and pictures of it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "precompute/io/image.h"
#include "precompute/visibility/bake.h"

namespace prt::tools {

/// A floor of 4 × 4 with a block and a ball on it.
Scene bandingScene();

/// Bakes with sets of directions in several orientations. A set is turned by turning the scene the other way,
/// and the expansions back.
class TurnedBakes {
  public:
    /// @param turns  >= 1; the first are those of the bake (setOrientations), the others random
    TurnedBakes(const Scene& scene, int turns, uint64_t seed);

    /// @param dealt  [points] 0..turns − 1: the orientation of each
    /// @return       coefficients, ao, error and rays of BakeResult; `inside` is empty
    BakeResult bake(std::span<const SurfacePoint> points, std::span<const int> dealt,
                    BakeOptions options) const;

  private:
    std::vector<Mat3d> turns_;
    std::vector<RayCaster> casters_;
};

struct BandingStudy {
    int shOrder = 6;
    Projection projection;
    std::vector<int> counts{64, 256, 1024};  ///< uniform sets
    double error = 0.01;                     ///< of adaptive bakes
    int linePoints = 2048;                   ///< >= 512, a power of two
    int rotated = 32;                        ///< >= 4; so many orientations are as good as one for each point
    int truth = 32768;                       ///< directions over the sphere, half as many for pictures
    int picturePx = 256;                     ///< side of the pictures; 0 makes none
    uint64_t seed = 1;
};

/// Waves by their length in points: beyond kLongestWave the eye takes them for shading, below kShortestWave
/// for grain; in between for bands.
inline constexpr int kLongestWave = 256, kShortestWave = 8;

/// Errors are shares of what an open point receives.
struct BandingRow {
    std::string surface;  ///< "floor" (a straight line), "ball" (its equator)
    std::string light;    ///< "sun" (from one direction), "natural" (IrradianceNorm)
    std::string
        set;  ///< as of SamplingRow, and how many orientations points are dealt to: "-dealtN" at
              ///< random, "-tiledN" in a pattern of √N × √N; "-rotated" is BandingStudy::rotated at random
    double directions;                      ///< over the sphere; NaN where adaptive
    double rays;                            ///< traced, mean per point
    double rms;                             ///< of the error along the line, its mean excluded
    double shadingRms, bandsRms, grainRms;  ///< parts of it: waves longer than kLongestWave, between, shorter
    double bandsToWhite;                    ///< share of the power in bands, in units of that of white noise
    double step;                            ///< 99th percentile of the error's change from point to point
    std::vector<double> octaves;            ///< RMS in waves of n/2^k … n/2^(k+1) points, k = 0…
};

/// A bake of the floor under the sun. Left: irradiance as displayed; right: its error, 16 times as large
/// about grey.
struct BandingPicture {
    std::string name;  ///< set and size
    ByteImage image;   ///< RGB, twice as wide as high
    double rms;        ///< error of the irradiance, share of an open point's
    double steps;      ///< RMS error in steps of the 8-bit display
};

struct BandingResult {
    std::vector<BandingRow> rows;
    std::vector<BandingPicture> pictures;  ///< the truth first
};

/// @throws Interrupted
BandingResult studyBanding(const BandingStudy& study);

/// Power of a signal of equally spaced samples by frequency, its mean taken off, under a Hann window that is
/// made up for: the sum over all entries is the mean square of noise.
/// @param signal  [N] N a power of two
/// @return        [N/2 + 1], entry k: waves of N/k samples
/// @source [Press2007, Sec. 13.4]
std::vector<double> powerSpectrum(std::span<const double> signal);

}  // namespace prt::tools
