// Which reader for which file.
#include "precompute/mesh/load_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "precompute/base/error.h"
#include "precompute/io/glb.h"
#include "precompute/mesh/readers.h"

namespace prt {

Scene loadMesh(const std::string& path, const LoadMeshOptions& options, LoadMeshReport* report) {
    LoadMeshReport local;
    LoadMeshReport& counts = report ? *report : local;
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (extension == ".gltf" || extension == ".glb")
        return prepareScene(readGltf(path), path, options, &counts);
    if (extension == ".obj") return prepareCorners(readObj(path, counts), path, options, counts);
    if (extension == ".ply") return prepareCorners(readPly(path, counts), path, options, counts);
    if (extension == ".off") return prepareCorners(readOff(path, counts), path, options, counts);
    if (extension == ".stl") return prepareCorners(readStl(path, counts), path, options, counts);
    throw InputError(path,
                     extension.empty() ? "the file name has no extension to tell its format"
                                       : fmt::format("'{}' is no mesh format that is read", extension),
                     "use .obj, .ply, .off, .stl, .gltf or .glb");
}

}  // namespace prt
