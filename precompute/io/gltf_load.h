// glTF files as tinygltf's model (internal to the glTF reader).
#pragma once

#include <memory>
#include <string>

namespace tinygltf {
class Model;
}

namespace prt {

/// Parses .glb or .gltf with the buffers beside it. Images keep their encoded bytes; of those in buffer views
/// (still unchecked) only the view's index is kept. Accessors are unchecked too.
/// @throws InputError  missing, truncated, not glTF 2.0, needs an extension that is not read
std::unique_ptr<tinygltf::Model> loadGltfModel(const std::string& path);

}  // namespace prt
