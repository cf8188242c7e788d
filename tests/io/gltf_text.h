// glTF files by hand.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace prt {

inline std::string word(size_t value) {
    const uint32_t bits = uint32_t(value);
    char raw[4];
    std::memcpy(raw, &bits, 4);
    return std::string(raw, 4);
}

/// Bytes of any numbers.
template <class Value>
std::string raw(const std::vector<Value>& values) {
    return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

inline std::string glbFile(std::string json, std::string binary) {
    while (json.size() % 4 != 0) json += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    std::string chunks = word(json.size()) + "JSON" + json;
    if (!binary.empty()) chunks += word(binary.size()) + std::string("BIN\0", 4) + binary;
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

inline std::string base64(const std::string& bytes) {
    const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        for (size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0);
        for (size_t k = 0; k < 4; ++k)
            text += i + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

/// A document of one buffer, grown piece by piece. Strings are JSON fragments.
struct GltfText {
    std::string binary;
    std::vector<std::string> views, accessors;
    std::string meshes, nodes = R"([{"mesh":0}])", scenes = R"([{"nodes":[0]}])", more;

    int addView(const std::string& bytes, const std::string& extra = "") {
        while (binary.size() % 4 != 0) binary += '\0';
        views.push_back(R"({"buffer":0,"byteOffset":)" + std::to_string(binary.size()) + R"(,"byteLength":)" +
                        std::to_string(bytes.size()) + extra + "}");
        binary += bytes;
        return int(views.size()) - 1;
    }
    int addAccessor(const std::string& bytes, int componentType, size_t count, const std::string& type,
                    const std::string& extra = "", const std::string& viewExtra = "") {
        const int view = addView(bytes, viewExtra);
        accessors.push_back(R"({"bufferView":)" + std::to_string(view) + R"(,"componentType":)" +
                            std::to_string(componentType) + R"(,"count":)" + std::to_string(count) +
                            R"(,"type":")" + type + "\"" + extra + "}");
        return int(accessors.size()) - 1;
    }
    int addFloats(const std::vector<float>& values, size_t components) {
        return addAccessor(raw(values), 5126, values.size() / components, "VEC" + std::to_string(components));
    }
    static std::string join(const std::vector<std::string>& items) {
        std::string text;
        for (const std::string& item : items) text += (text.empty() ? "" : ",") + item;
        return "[" + text + "]";
    }
    /// @param uri  of the buffer; empty: the binary chunk
    std::string json(const std::string& uri = "") const {
        return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
               (uri.empty() ? "" : R"(,"uri":")" + uri + "\"") + R"(}],"bufferViews":)" + join(views) +
               R"(,"accessors":)" + join(accessors) + R"(,"meshes":)" + meshes +
               (nodes.empty() ? "" : R"(,"nodes":)" + nodes) +
               (scenes.empty() ? "" : R"(,"scenes":)" + scenes) + more + "}";
    }
    std::string glb() const { return glbFile(json(), binary); }
};

/// One triangle in z = 0, without indices.
inline GltfText triangleText() {
    GltfText text;
    text.addFloats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    text.meshes = R"([{"primitives":[{"attributes":{"POSITION":0}}]}])";
    return text;
}

}  // namespace prt
