// glTF 2.0 binary out. Written by hand: tinygltf's writer puts images into data URIs.
// Sources: glTF 2.0 specification (GLB container 4.4, accessors 3.6.2, alignment 3.6.2.4); EXT_texture_webp.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "precompute/base/atomic_file.h"
#include "precompute/base/error.h"
#include "precompute/io/glb.h"
#include "precompute/io/image.h"

namespace prt {
namespace {

using Json = nlohmann::ordered_json;

enum : int { kFloat = 5126, kUnsignedInt = 5125, kArrayBuffer = 34962, kElementArrayBuffer = 34963 };

class GlbWriter {
  public:
    GlbWriter(const Scene& scene, const std::string& path) : scene_(scene), path_(path) {}

    std::string build() {
        json_["asset"] = {{"version", "2.0"}, {"generator", "prt"}};
        writeGeometry();
        writeMaterials();
        writeTextures();
        json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
        return assemble();
    }

  private:
    void pad(std::string& bytes, char with) const {
        while (bytes.size() % 4 != 0) bytes.push_back(with);
    }

    /// @return index of the new buffer view
    int addView(const void* bytes, size_t size, int target, size_t stride = 0) {
        pad(binary_, '\0');
        Json view{{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
        // Asked for where several accessors share a view.
        if (stride != 0) view["byteStride"] = stride;
        if (target != 0) view["target"] = target;
        binary_.append(static_cast<const char*>(bytes), size);
        json_["bufferViews"].push_back(std::move(view));
        return int(json_["bufferViews"].size()) - 1;
    }

    /// @return index of the new accessor
    int addAccessor(int view, size_t offset, int componentType, size_t count, const char* type) {
        json_["accessors"].push_back({{"bufferView", view},
                                      {"byteOffset", offset},
                                      {"componentType", componentType},
                                      {"count", count},
                                      {"type", type}});
        return int(json_["accessors"].size()) - 1;
    }

    template <class Vector>
    int addAttributeView(const std::vector<Vector>& values) {
        if (values.empty()) return -1;
        return addView(values.data(), values.size() * sizeof(Vector), kArrayBuffer, sizeof(Vector));
    }

    void addAttribute(Json& attributes, const char* name, int view, const ScenePrimitive& primitive,
                      size_t components) {
        if (view < 0) return;
        const std::string type = fmt::format("VEC{}", components);
        attributes[name] = addAccessor(view, size_t(primitive.firstVertex) * components * sizeof(float),
                                       kFloat, primitive.vertexCount, type.c_str());
    }

    void setBounds(Json& accessor, const ScenePrimitive& primitive) const {
        Vec3f low = scene_.positions[primitive.firstVertex], high = low;
        for (uint32_t i = 0; i < primitive.vertexCount; ++i) {
            low = low.cwiseMin(scene_.positions[primitive.firstVertex + i]);
            high = high.cwiseMax(scene_.positions[primitive.firstVertex + i]);
        }
        accessor["min"] = {double(low.x()), double(low.y()), double(low.z())};
        accessor["max"] = {double(high.x()), double(high.y()), double(high.z())};
    }

    void writeGeometry() {
        const int positions = addAttributeView(scene_.positions), normals = addAttributeView(scene_.normals);
        const int tangents = addAttributeView(scene_.tangents);
        // TEXCOORD_1 may not stand alone.
        const bool standIn = scene_.uv0.empty() && !scene_.uv1.empty();
        const std::vector<Vec2f> zeros(standIn ? scene_.uv1.size() : 0, Vec2f::Zero());
        const int uv0 = addAttributeView(standIn ? zeros : scene_.uv0), uv1 = addAttributeView(scene_.uv1);
        std::vector<uint32_t> local(scene_.indices);
        for (const ScenePrimitive& primitive : scene_.primitives)
            for (uint32_t i = 0; i < primitive.indexCount; ++i)
                local[primitive.firstIndex + i] -= primitive.firstVertex;
        const int indices = addView(local.data(), local.size() * sizeof(uint32_t), kElementArrayBuffer);

        Json primitives = Json::array();
        for (const ScenePrimitive& primitive : scene_.primitives) {
            Json attributes;
            addAttribute(attributes, "POSITION", positions, primitive, 3);
            setBounds(json_["accessors"].back(), primitive);
            addAttribute(attributes, "NORMAL", normals, primitive, 3);
            addAttribute(attributes, "TANGENT", tangents, primitive, 4);
            addAttribute(attributes, "TEXCOORD_0", uv0, primitive, 2);
            addAttribute(attributes, "TEXCOORD_1", uv1, primitive, 2);
            const int triangles = addAccessor(indices, size_t(primitive.firstIndex) * sizeof(uint32_t),
                                              kUnsignedInt, primitive.indexCount, "SCALAR");
            primitives.push_back({{"attributes", std::move(attributes)},
                                  {"indices", triangles},
                                  {"material", primitive.material}});
        }
        json_["meshes"] = Json::array({{{"primitives", std::move(primitives)}}});
        json_["nodes"] = Json::array({{{"mesh", 0}}});
        json_["scenes"] = Json::array({{{"nodes", {0}}}});
        json_["scene"] = 0;
    }

    void writeMaterials() {
        for (const SceneMaterial& material : scene_.materials) {
            const Vec3f colour = material.baseColor.cwiseMax(0.0f).cwiseMin(1.0f);
            Json surface{
                {"baseColorFactor", {double(colour.x()), double(colour.y()), double(colour.z()), 1.0}}};
            if (material.baseColorTexture >= 0)
                surface["baseColorTexture"] = {{"index", material.baseColorTexture}};
            surface["metallicFactor"] = 0.0;
            surface["roughnessFactor"] = 1.0;
            Json json;
            if (!material.name.empty()) json["name"] = material.name;
            json["pbrMetallicRoughness"] = std::move(surface);
            if (material.normalTexture >= 0)
                json["normalTexture"] = {{"index", material.normalTexture},
                                         {"scale", double(material.normalScale)}};
            if (material.doubleSided) json["doubleSided"] = true;
            json_["materials"].push_back(std::move(json));
        }
    }

    void writeTextures() {
        if (scene_.textures.empty()) return;
        bool webp = false;
        // Trilinear, repeating.
        json_["samplers"] =
            Json::array({{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}}});
        for (size_t i = 0; i < scene_.textures.size(); ++i) {
            const SceneTexture& texture = scene_.textures[i];
            const std::string type = imageMimeType(texture.encoded);
            if (type.empty())
                throw InputError(fmt::format("texture {} ({})", i, texture.name),
                                 "is not a PNG, JPEG or WebP image", "convert it to one of these");
            const int view = addView(texture.encoded.data(), texture.encoded.size(), 0);
            Json image{{"bufferView", view}, {"mimeType", type}};
            if (!texture.name.empty()) image["name"] = texture.name;
            json_["images"].push_back(std::move(image));
            Json reference{{"sampler", 0}};
            if (type == "image/webp") {
                webp = true;
                reference["extensions"]["EXT_texture_webp"]["source"] = i;
            } else {
                reference["source"] = i;
            }
            json_["textures"].push_back(std::move(reference));
        }
        if (webp) json_["extensionsUsed"] = json_["extensionsRequired"] = Json::array({"EXT_texture_webp"});
    }

    static void appendWord(std::string& bytes, size_t value) {
        const uint32_t word = uint32_t(value);
        char raw[4];
        std::memcpy(raw, &word, 4);
        bytes.append(raw, 4);
    }

    std::string assemble() {
        pad(binary_, '\0');
        std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
        pad(text, ' ');
        const size_t total = 12 + 8 + text.size() + 8 + binary_.size();
        if (total > std::numeric_limits<uint32_t>::max())
            throw OutputError(path_, fmt::format("{} bytes are more than a GLB file can hold", total),
                              "split the mesh or use smaller textures");
        std::string bytes = "glTF";
        bytes.reserve(total);
        appendWord(bytes, 2);
        appendWord(bytes, total);
        appendWord(bytes, text.size());
        bytes += "JSON";
        bytes += text;
        appendWord(bytes, binary_.size());
        bytes.append("BIN\0", 4);
        bytes += binary_;
        return bytes;
    }

    const Scene& scene_;
    std::string path_, binary_;
    Json json_;
};

}  // namespace

void writeGlb(const Scene& scene, const std::string& path) {
    validateScene(scene, path);
    if (scene.primitives.empty()) throw InputError(path, "a mesh without triangles cannot be written");
    for (size_t i = 0; i < scene.primitives.size(); ++i)
        if (scene.primitives[i].indexCount == 0 || scene.primitives[i].vertexCount == 0)
            throw InputError(path, fmt::format("primitive {} has no triangles", i));
    writeFileAtomically(path, std::string_view(GlbWriter(scene, path).build()));
}

}  // namespace prt
