// OBJ and MTL through tinyobjloader, after our own scan for damage (obj_scan.cpp). Material statements: Kd,
// map_Kd, norm (the PBR extension of tinyobjloader's author) and map_Kn.
#include <fmt/format.h>
#include <stb_image.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <istream>
#include <map>
#include <set>
#include <streambuf>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/image.h"
#include "precompute/mesh/readers.h"
#include "precompute/mesh/text_scanner.h"

namespace prt {
namespace {

/// Text in memory as a stream, without copying it.
class TextBuffer : public std::streambuf {
  public:
    explicit TextBuffer(std::string& text) { setg(text.data(), text.data(), text.data() + text.size()); }
};

std::string withSlashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    return path;
}

/// Reads .mtl files beside the .obj and remembers what tinyobjloader does not tell: the folder of each
/// material, and whether its colour was stated.
class MaterialFiles : public tinyobj::MaterialReader {
  public:
    explicit MaterialFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

    bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                    std::map<std::string, int>* indexOf, std::string* warnings,
                    std::string* errors) override {
        const std::filesystem::path path = folder_ / withSlashes(name);
        std::string text;
        try {
            text = readFile(path);
        } catch (const InputError&) {
            logWarning(fmt::format("{}: material file is missing; its materials become grey", path.string()));
            return true;
        }
        noteColours(text);
        TextBuffer buffer(text);
        std::istream stream(&buffer);
        tinyobj::LoadMtl(indexOf, materials, &stream, warnings, errors);
        folderOf.resize(materials->size(), path.parent_path());
        return true;
    }

    std::vector<std::filesystem::path> folderOf;  ///< [materials]
    std::set<std::string> coloured;               ///< names of materials with a Kd statement

  private:
    void noteColours(std::string_view text) {
        TextScanner scanner(text, "");
        std::string name;
        while (!scanner.atEnd()) {
            std::string_view line = scanner.restOfLine();
            const std::string_view keyword = takeWord(line);
            if (keyword == "newmtl") name = std::string(takeWord(line));
            if (keyword == "Kd") coloured.insert(name);
        }
    }

    std::filesystem::path folder_;
};

/// Reads each image once. Formats other than PNG, JPEG and WebP become PNG.
class TextureFiles {
  public:
    TextureFiles(CornerMesh& mesh, LoadMeshReport& report) : mesh_(mesh), report_(report) {}

    /// @return index into textures, −1 when the file is missing or unreadable (which is warned of)
    int load(const std::filesystem::path& folder, const std::string& name) {
        if (name.empty()) return -1;
        const std::filesystem::path path = (folder / withSlashes(name)).lexically_normal();
        const auto [entry, isNew] = indexOf_.try_emplace(path.string(), -1);
        if (isNew) entry->second = read(path);
        return entry->second;
    }

  private:
    int read(const std::filesystem::path& path) {
        std::string bytes;
        try {
            bytes = readFile(path);
        } catch (const InputError& error) {
            return missing(path, error.problem());
        }
        SceneTexture texture;
        texture.name = path.filename().string();
        texture.encoded.assign(bytes.begin(), bytes.end());
        texture.mimeType = imageMimeType(texture.encoded);
        if (texture.mimeType.empty()) {
            ByteImage image;
            int channels = 0;
            unsigned char* pixels = stbi_load_from_memory(texture.encoded.data(), int(texture.encoded.size()),
                                                          &image.width, &image.height, &channels, 4);
            if (pixels == nullptr) return missing(path, "is no image that can be read");
            image.channels = 4;
            image.pixels.assign(pixels, pixels + size_t(image.width) * size_t(image.height) * 4);
            stbi_image_free(pixels);
            texture.encoded = encodePng(image);
            texture.mimeType = "image/png";
        }
        mesh_.textures.push_back(std::move(texture));
        return int(mesh_.textures.size()) - 1;
    }

    int missing(const std::filesystem::path& path, const std::string& why) {
        logWarning(fmt::format("{}: {}; the material goes without this texture", path.string(), why));
        countRepair(report_, "textures_missing", 1);
        return -1;
    }

    CornerMesh& mesh_;
    LoadMeshReport& report_;
    std::map<std::string, int> indexOf_;
};

SceneMaterial convertMaterial(const tinyobj::material_t& from, const std::filesystem::path& folder,
                              bool coloured, TextureFiles& textures) {
    SceneMaterial material;
    material.name = from.name;
    material.baseColorTexture = textures.load(folder, from.diffuse_texname);
    const Vec3f diffuse(from.diffuse[0], from.diffuse[1], from.diffuse[2]);
    const bool textured = material.baseColorTexture >= 0;
    if (coloured && diffuse.allFinite() && !(textured && diffuse.isZero(0.0f)))
        material.baseColor = diffuse.cwiseMax(0.0f);
    else if (textured)
        material.baseColor = Vec3f(1, 1, 1);

    std::string normalName = from.normal_texname;
    tinyobj::texture_option_t options = from.normal_texopt;
    if (const auto kn = from.unknown_parameter.find("map_Kn");
        normalName.empty() && kn != from.unknown_parameter.end())
        tinyobj::ParseTextureNameAndOption(&normalName, &options, kn->second.c_str());
    material.normalTexture = textures.load(folder, normalName);
    if (options.bump_multiplier > 0) material.normalScale = options.bump_multiplier;
    return material;
}

void convertCorners(const tinyobj::attrib_t& attrib, const std::vector<tinyobj::shape_t>& shapes,
                    CornerMesh& mesh, LoadMeshReport& report, const std::string& where) {
    for (size_t i = 0; i + 2 < attrib.vertices.size(); i += 3)
        mesh.positions.emplace_back(attrib.vertices[i], attrib.vertices[i + 1], attrib.vertices[i + 2]);
    for (size_t i = 0; i + 2 < attrib.normals.size(); i += 3)
        mesh.normals.emplace_back(attrib.normals[i], attrib.normals[i + 1], attrib.normals[i + 2]);
    // Their v points up.
    for (size_t i = 0; i + 1 < attrib.texcoords.size(); i += 2)
        mesh.uv0.emplace_back(attrib.texcoords[i], 1 - attrib.texcoords[i + 1]);

    PolygonAppender polygons(mesh, report);
    std::vector<uint32_t> position, normal, texcoord;
    // The scan has checked what it understands; what tinyobjloader understands differently ends here.
    const auto index = [&](int i, size_t count, bool required) {
        if (i >= 0 ? size_t(i) >= count : required)
            throw InputError(where, fmt::format("a face uses element {} of {}", i + 1, count),
                             "re-export the mesh");
        return i < 0 ? kNone : uint32_t(i);
    };
    int fallback = -1;
    for (const tinyobj::shape_t& shape : shapes) {
        size_t first = 0;
        for (size_t face = 0; face < shape.mesh.num_face_vertices.size(); ++face) {
            position.clear(), normal.clear(), texcoord.clear();
            const size_t corners = shape.mesh.num_face_vertices[face];
            for (size_t k = first; k < first + corners; ++k) {
                const tinyobj::index_t& corner = shape.mesh.indices[k];
                position.push_back(index(corner.vertex_index, mesh.positions.size(), true));
                if (!mesh.normals.empty())
                    normal.push_back(index(corner.normal_index, mesh.normals.size(), false));
                if (!mesh.uv0.empty())
                    texcoord.push_back(index(corner.texcoord_index, mesh.uv0.size(), false));
            }
            first += corners;
            int material = shape.mesh.material_ids[face];
            if (material < 0) {
                if (fallback < 0) {
                    fallback = int(mesh.materials.size());
                    mesh.materials.emplace_back().name = "default";
                }
                material = fallback;
            }
            polygons.append(position, normal, texcoord, material, where);
        }
    }
}

}  // namespace

CornerMesh readObj(const std::filesystem::path& path, LoadMeshReport& report) {
    std::string text = readFile(path);
    scanObj(text, path.string());
    tinyobj::attrib_t attrib;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    MaterialFiles files(path.parent_path());
    {
        TextBuffer buffer(text);
        std::istream stream(&buffer);
        if (!tinyobj::LoadObj(&attrib, &shapes, &materials, &warnings, &errors, &stream, &files, false,
                              false))
            throw InputError(path.string(), errors.substr(0, errors.find('\n')), "re-export the mesh");
    }
    TextScanner lines(warnings, "");
    for (std::string_view line = lines.contentLine(); !line.empty(); line = lines.contentLine())
        logWarning(fmt::format("{}: {}", path.string(), line));

    CornerMesh mesh;
    TextureFiles textures(mesh, report);
    files.folderOf.resize(materials.size(), path.parent_path());
    for (size_t m = 0; m < materials.size(); ++m)
        mesh.materials.push_back(convertMaterial(materials[m], files.folderOf[m],
                                                 files.coloured.count(materials[m].name) > 0, textures));
    convertCorners(attrib, shapes, mesh, report, path.string());
    return mesh;
}

}  // namespace prt
