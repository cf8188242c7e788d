// Pictures of compressed visibility, and the time they take.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "precompute/io/environment_file.h"
#include "precompute/io/surface_image.h"
#include "tools/measure/compression_scene.h"

namespace prt::tools {

struct CompressionView {
    Camera camera;
    int width = 640, height = 400;
    int tableSize = 32;        ///< texels along an edge of the tables
    int referenceRays = 1024;  ///< directions of the ray-traced reference, before refinement
};

/// A picture of a figure, and how far its irradiance is from what the figure compares it with.
struct PictureRow {
    std::string figure, picture, against;
    std::string file, differenceFile;  ///< in the folder; the second empty where nothing is compared
    double relativeRmse = 0;           ///< over covered pixels and colours
};

/// Makes sure before long work that pictures can be drawn and written.
/// @param folder  made when it is not there
/// @throws InputError   no OSMesa
/// @throws OutputError  the folder cannot be made, or not be written to
void checkCompressionFigures(const std::filesystem::path& folder);

/// Numbers of vectors in the paper's Fig. 5.
inline constexpr int kFigure5Components[] = {4, 12, 24};

/// Writes figure5.png and figure6.png, and each of their pictures by itself, as sRGB PNGs of one exposure:
///   Fig. 5  the highest order from 4, 12 and 24 vectors (those that it has), and uncompressed; 4 ×
///   differences
///           to uncompressed
///   Fig. 6  every order, uncompressed, and ray tracing; 4 × differences to ray tracing
/// Normal maps of the materials are on.
/// @param folder    one that checkCompressionFigures passed; files in it are replaced
/// @param orders    rising, at least one   @param encoding  of weights
/// @throws InputError  no OSMesa; OutputError; Interrupted
/// @source [IwanickiSloan2012, Figs. 5 and 6]
std::vector<PictureRow> drawCompressionFigures(CompressionScene& scene, const std::vector<int>& orders,
                                               const std::string& encoding, const Environment& environment,
                                               const CompressionView& view,
                                               const std::filesystem::path& folder);

/// Time of a frame.
struct FrameTime {
    int shOrder = 0;          ///< uncompressed visibility of so many bands, or 0
    int components = 0;       ///< so many vectors, or 0
    double milliseconds = 0;  ///< median
    double ratio = 0;  ///< median, to a frame of uncompressed visibility of the highest order right before
};

/// Frames of every order uncompressed and of every number of vectors, in turn with frames of the highest
/// order uncompressed. What the coefficients are does not matter, so all are cut from one compression.
/// @param components  rising; those above n² of the highest order are left out
/// @param frames      of each, at least 1
/// @throws InputError  no OSMesa
std::vector<FrameTime> timeCompressionFrames(CompressionScene& scene, const std::vector<int>& orders,
                                             const std::vector<int>& components,
                                             const Environment& environment, const CompressionView& view,
                                             int frames);

}  // namespace prt::tools
