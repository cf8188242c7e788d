// DirectDraw Surface containers with the header of Direct3D 10.
#pragma once

#include <filesystem>

#include "precompute/io/texture_image.h"

namespace prt {

/// One level; arrays and cubes by the DX10 header, the format as a DXGI format.
/// @throws OutputError
/// @source [DdsGuide]
void writeDds(const std::filesystem::path& path, const TextureImage& image);

/// Reads what writeDds writes. DDS knows no array of one: such a texture comes back with layers 0.
/// @throws InputError  missing or damaged, without the DX10 header, or with what writeDds does not write
TextureImage readDds(const std::filesystem::path& path);

}  // namespace prt
