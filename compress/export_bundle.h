// A bundle as textures, a description and shader source: what an engine ships.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace prt {

struct ExportSettings {
    std::string bundlePath;
    std::string folder;               ///< made when it is not there; files in it are replaced
    std::string container = "ktx2";   ///< or "dds"
    std::string weights = "unorm8";   ///< "float", "half", "unorm16"
    std::string tables = "half";      ///< "float", "rgb9e5", "r11f"
    std::string visibility = "auto";  ///< "half", "float", "none"; auto: half where a light-cosine table or
                                      ///< the lack of pca.exr calls for it
};

/// One texture that was written.
struct ExportRow {
    std::string part;          ///< "weights", "validity", "visibility", "table"
    std::string file;          ///< within the folder
    std::string format;        ///< texelFormatName
    int layers = 0;            ///< of the array (0: no array); cubes count once
    size_t bytes = 0;          ///< of texels, without the container's header
    double bytesPerTexel = 0;  ///< by the texels (or rows of vertices) of the bundle
};
/// What the formats cost in a picture, under one environment.
struct ExportError {
    std::string table;  ///< file of the table
    /// RMS difference of irradiance at the geometric normals of (up to 4096) valid points, from textures
    /// against from the bundle, as a share of the latter.
    double irradianceRelativeRmse = 0;
};
struct ExportReport {
    std::vector<ExportRow> rows;
    size_t points = 0;              ///< texels of the atlas, or vertices
    double bytesPerPointTexel = 0;  ///< of weights, validity and visibility
    double bytesPerTexel = 0;       ///< with tables
    size_t bytes = 0;               ///< of all textures
    /// RMS difference of the coefficients of visibility that the format of the weights makes, over valid
    /// points, as a share of the coefficients.
    double weightsRelativeRmse = 0;
    std::vector<ExportError> errors;
    std::vector<std::string> notExported;  ///< tables of other layouts than cubes
    double seconds = 0;
};

/// Writes weights, validity, visibility and tables as textures (2D arrays and cube arrays), NAME.json, which
/// says what they hold (tools/docs/export.md), and prt_shade.glsl and prt_shade.hlsl, which evaluate them.
/// @throws UsageError  no such container or format
/// @throws InputError  the bundle is damaged or stale (names file and command)
/// @throws OutputError, Interrupted
ExportReport runExport(const ExportSettings& settings);

}  // namespace prt
