// Results of prt measure compression as tables and figures.
#pragma once

#include <string>

#include "tools/measure/compression.h"
#include "tools/measure/compression_images.h"
#include "tools/measure/figure.h"
#include "tools/measure/table.h"

namespace prt::tools {

/// A row per way to store visibility.
/// @param encoding   of the weights
/// @param tableSize  texels along an edge of the tables
Table compressionTable(const CompressionResult& result, const std::string& encoding, int tableSize);
/// What an order gives without compression.
Table orderTable(const CompressionResult& result);
/// Numbers of vectors that the paper finds enough.
Table claimTable(const CompressionResult& result);
/// Errors by bands of the light.
Table lightTable(const CompressionResult& result);
/// Range of the errors over bands of the light.
Table sensitivityTable(const CompressionResult& result);
/// Bytes of a point of visibility, and of the transfer matrices it replaces.
Table storageTable(const CompressionResult& result, const std::string& encoding);

/// Times of frames, and their ratio to uncompressed visibility of the highest order.
Table frameTable(const std::vector<FrameTime>& times);
/// Files and errors of the pictures.
Table pictureTable(const std::vector<PictureRow>& pictures);

/// The claims in words, a line each.
std::string verdictText(const CompressionResult& result);

/// Errors and fetches over bytes of a point, errors over bands of the light, bytes beside transfer matrices.
Figure compressionFigure(const CompressionResult& result);

}  // namespace prt::tools
