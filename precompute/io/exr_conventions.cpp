// Sources: the conventions of this project, tools/docs/conventions.md.
#include "precompute/io/exr_conventions.h"

#include <fmt/format.h>

#include "precompute/base/check.h"
#include "precompute/base/error.h"

namespace prt {
namespace {

constexpr const char* kContent = "prtContent";
constexpr const char* kVersion = "formatVersion";
constexpr const char* kShOrder = "shOrder";

// String attributes that OpenEXR itself or this project puts into headers.
bool isReserved(const std::string& name) {
    return name == "name" || name == "type" || name == "view" || name == kContent || name == "domain" ||
           name == "tableKind" || name == "layout" || fileConventions().contains(name);
}

}  // namespace

const std::map<std::string, std::string>& fileConventions() {
    static const std::map<std::string, std::string> conventions{
        {"worldAxes", "right-handed, +Y up"},
        {"shConvention", "real, orthonormal, Condon-Shortley phase, polar axis +Z, index l(l+1)+m"},
        {"visibilityConvention", "1 unoccluded, 0 blocked, 0 below the geometric horizon"},
        {"cosineConvention", "max(0, n.w), not divided by pi"},
        {"cubeConvention", "OpenGL face order +X -X +Y -Y +Z -Z and orientation, faces stacked vertically"},
    };
    return conventions;
}

ExrAttributes conventionAttributes(const std::string& content, int shOrder,
                                   const std::map<std::string, std::string>& own) {
    ExrAttributes attributes;
    for (const auto& [name, value] : own)
        if (!isReserved(name)) attributes.strings[name] = value;
    for (const auto& [name, value] : fileConventions()) attributes.strings[name] = value;
    attributes.strings[kContent] = content;
    attributes.ints[kVersion] = kExrFormatVersion;
    attributes.ints[kShOrder] = shOrder;
    for (const char* name : {kVersion, kShOrder, "vertexCount", "componentCount", "size"})
        attributes.strings.erase(name);
    return attributes;
}

std::map<std::string, std::string> checkConventions(const ExrAttributes& attributes,
                                                    const std::string& content, const std::string& path) {
    const auto found = attributes.strings.find(kContent);
    if (found == attributes.strings.end())
        throw InputError(path, "was not written by prt (it has no attribute prtContent)");
    if (found->second != content)
        throw InputError(path, fmt::format("holds {}, not {}", found->second, content));
    const auto version = attributes.ints.find(kVersion);
    if (version == attributes.ints.end()) throw InputError(path, "has no format version");
    if (version->second != kExrFormatVersion)
        throw InputError(
            path,
            fmt::format("has format version {}, this program reads {}", version->second, kExrFormatVersion),
            "make it again with this version of prt");
    for (const auto& [name, value] : fileConventions()) {
        const auto it = attributes.strings.find(name);
        if (it == attributes.strings.end() || it->second != value)
            throw InputError(path,
                             fmt::format("has another {}: \"{}\", expected \"{}\"", name,
                                         it == attributes.strings.end() ? "" : it->second, value),
                             "make it again with this version of prt");
    }
    std::map<std::string, std::string> own;
    for (const auto& [name, value] : attributes.strings)
        if (!isReserved(name)) own[name] = value;
    return own;
}

int requireInt(const ExrAttributes& attributes, const std::string& name, int low, int high,
               const std::string& path) {
    const auto it = attributes.ints.find(name);
    if (it == attributes.ints.end()) throw InputError(path, fmt::format("has no attribute {}", name));
    if (it->second < low || it->second > high)
        throw InputError(path, fmt::format("has {} = {}, outside {} to {}", name, it->second, low, high));
    return it->second;
}

const std::string& requireString(const ExrAttributes& attributes, const std::string& name,
                                 const std::string& path) {
    const auto it = attributes.strings.find(name);
    if (it == attributes.strings.end()) throw InputError(path, fmt::format("has no attribute {}", name));
    return it->second;
}

std::string indexedName(const std::string& prefix, int index) {
    return fmt::format("{}.{:02d}", prefix, index);
}

}  // namespace prt
