// KTX 2.0 containers.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "precompute/io/texture_image.h"

namespace prt {

/// Key/value data of a KTX file, text only. Keys that begin with KTX or ktx belong to Khronos: writers set
/// KTXorientation ("rd": rows to the right, from the top down) and KTXwriter ("prt") themselves.
using KtxMetadata = std::map<std::string, std::string>;

/// One level without supercompression, linear transfer, with the data format descriptor of the format.
/// @throws OutputError
/// @source [Ktx2], [KhronosDataFormat]
void writeKtx2(const std::filesystem::path& path, const TextureImage& image,
               const KtxMetadata& metadata = {});

/// Reads what writeKtx2 writes; files of other writers when they use the same features.
/// @param metadata  where not null: all key/value data without the terminating zeros
/// @throws InputError  missing or damaged, or with what writeKtx2 does not write (other formats, several
///                     levels, supercompression, 3D)
TextureImage readKtx2(const std::filesystem::path& path, KtxMetadata* metadata = nullptr);

}  // namespace prt
