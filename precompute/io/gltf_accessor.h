// Numbers out of glTF accessors, every access checked (internal to the glTF reader).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace prt {

/// Bytes of a buffer view.
/// @throws InputError  view or buffer absent, or the view reaches beyond its buffer
std::span<const uint8_t> gltfViewBytes(const tinygltf::Model& model, int view, const std::string& where);

/// Number of elements that an accessor promises.
/// @throws InputError  no such accessor
size_t gltfAccessorCount(const tinygltf::Model& model, int accessor, const std::string& where);

/// @param components  numbers per element: 2 to 4
/// @return            [count×components]; normalised integers as fractions, other integers as they are
/// @throws InputError  other type, out of bounds
std::vector<float> readGltfFloats(const tinygltf::Model& model, int accessor, int components,
                                  const std::string& where);
/// @throws InputError  not unsigned scalars, out of bounds
std::vector<uint32_t> readGltfIndices(const tinygltf::Model& model, int accessor, const std::string& where);

}  // namespace prt
