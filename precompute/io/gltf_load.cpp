// glTF 2.0 file → tinygltf's model, with images still encoded.
// Sources: glTF 2.0 specification (GLB container 4.4). Parsed by tinygltf 2.7, which trusts the length of the
// last chunk and nests as deep as the file: both are checked here.
#include "precompute/io/gltf_load.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <set>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/json_depth.h"

namespace prt {
namespace fs = std::filesystem;
namespace {

uint32_t wordAt(const std::string& bytes, size_t at) {
    uint32_t word;
    std::memcpy(&word, bytes.data() + at, 4);
    return word;
}

/// @return the JSON chunk
std::string_view checkGlb(const std::string& bytes, const std::string& where) {
    const char* const again = "the file is truncated or damaged; export it again";
    if (bytes.size() < 20) throw InputError(where, "too short for a GLB file", again);
    if (wordAt(bytes, 4) != 2)
        throw InputError(where, fmt::format("is glTF version {}, not 2", wordAt(bytes, 4)),
                         "export as glTF 2.0");
    const uint64_t length = wordAt(bytes, 8);
    if (length > bytes.size())
        throw InputError(where,
                         fmt::format("has {} bytes of the {} that its header promises", bytes.size(), length),
                         again);
    const uint64_t jsonEnd = 20 + uint64_t(wordAt(bytes, 12));
    if (jsonEnd > length) throw InputError(where, "the JSON chunk reaches beyond the end of the file", again);
    if (jsonEnd != length) {
        if (jsonEnd + 8 > length) throw InputError(where, "ends inside the header of a chunk", again);
        if (jsonEnd + 8 + wordAt(bytes, jsonEnd) > length)
            throw InputError(where, "the binary chunk reaches beyond the end of the file", again);
    }
    return std::string_view(bytes).substr(20, jsonEnd - 20);
}

// Images stay encoded. Those in buffer views come with unchecked pointers and are taken later.
bool keepImageBytes(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                    const unsigned char* bytes, int size, void*) {
    image->as_is = true;
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    return true;
}

// tinygltf's own callbacks expand paths by the shell and look in the current directory as well.
bool fileBeside(const std::string& path, void*) {
    std::error_code error;
    return fs::path(path).is_absolute() && fs::is_regular_file(path, error);
}
std::string samePath(const std::string& path, void*) { return path; }
bool readWhole(std::vector<unsigned char>* out, std::string* problem, const std::string& path, void*) {
    try {
        const std::string bytes = readFile(path);
        out->assign(bytes.begin(), bytes.end());
        return true;
    } catch (const std::exception& error) {
        if (problem) *problem = error.what();
        return false;
    }
}
bool writeNothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
}

void checkExtensions(const tinygltf::Model& model, const std::string& path) {
    static const std::set<std::string> known{"KHR_mesh_quantization", "EXT_texture_webp",
                                             "KHR_texture_transform", "KHR_lights_punctual"};
    for (const std::string& name : model.extensionsRequired)
        if (!known.contains(name) && !name.starts_with("KHR_materials_"))
            throw InputError(path, fmt::format("needs the glTF extension {}, which prt does not read", name),
                             "export it without (no compression)");
}

}  // namespace

std::unique_ptr<tinygltf::Model> loadGltfModel(const std::string& path) {
    const std::string bytes = readFile(path);
    if (bytes.size() > std::numeric_limits<uint32_t>::max())
        throw InputError(path, "has more than 4 GB", "split the mesh");
    const bool binary = bytes.starts_with("glTF");
    const std::string_view json = binary ? checkGlb(bytes, path) : std::string_view(bytes);
    if (jsonNestingDepth(json) > kMaxJsonDepth) throw InputError(path, "its JSON is nested too deeply");
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepImageBytes, nullptr);
    loader.SetFsCallbacks({fileBeside, samePath, readWhole, writeNothing, nullptr});
    const std::string folder = fs::absolute(path).parent_path().string();
    auto model = std::make_unique<tinygltf::Model>();
    std::string problem, warning;
    bool loaded = false;
    try {
        const unsigned size = unsigned(bytes.size());
        loaded =
            binary ? loader.LoadBinaryFromMemory(model.get(), &problem, &warning,
                                                 reinterpret_cast<const unsigned char*>(bytes.data()), size,
                                                 folder)
                   : loader.LoadASCIIFromString(model.get(), &problem, &warning, bytes.data(), size, folder);
    } catch (const std::exception& error) {
        problem += error.what();
    }
    if (!loaded)
        throw InputError(path, fmt::format("cannot be read as glTF: {}", problem), "export it again");
    checkExtensions(*model, path);
    return model;
}

}  // namespace prt
