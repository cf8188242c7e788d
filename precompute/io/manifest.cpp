// Sources: the layout is this project's own (tools/docs/formats.md).
#include "precompute/io/manifest.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/json_depth.h"

namespace prt {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "prt-bundle";

[[noreturn]] void throwDamaged(const std::string& where, const std::string& what) {
    throw InputError(where, "damaged manifest: " + what, "make the bundle again with prt precompute");
}

std::string requireText(const Json& object, const char* key, const std::string& where) {
    const auto it = object.find(key);
    if (it == object.end() || !it->is_string()) throwDamaged(where, fmt::format("no text \"{}\"", key));
    return it->get<std::string>();
}

bool isHash(const std::string& text) {
    return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

BundleFile parseFile(const Json& json, const std::string& where) {
    if (!json.is_object()) throwDamaged(where, "a file that is not an object");
    BundleFile file;
    file.name = requireText(json, "name", where);
    if (!isBundleFileName(file.name)) throwDamaged(where, fmt::format("the file name \"{}\"", file.name));
    const auto bytes = json.find("bytes");
    if (bytes == json.end() || !bytes->is_number_unsigned()) throwDamaged(where, "no size of " + file.name);
    file.bytes = bytes->get<uint64_t>();
    file.xxh3 = requireText(json, "xxh3_128", where);
    if (!isHash(file.xxh3)) throwDamaged(where, "no hash of " + file.name);
    if (json.contains("made_by")) file.madeBy = requireText(json, "made_by", where);
    if (const auto from = json.find("made_from"); from != json.end()) {
        if (!from->is_object()) throwDamaged(where, "made_from of " + file.name);
        for (const auto& [name, hash] : from->items()) {
            if (!hash.is_string()) throwDamaged(where, "made_from of " + file.name);
            file.madeFrom[name] = hash.get<std::string>();
        }
    }
    return file;
}

void checkManifestConventions(const Json& json, const std::string& where) {
    const auto conventions = json.find("conventions");
    if (conventions == json.end() || !conventions->is_object()) throwDamaged(where, "no conventions");
    for (const auto& [name, meaning] : fileConventions()) {
        const auto it = conventions->find(name);
        if (it == conventions->end() || *it != meaning)
            throw InputError(where,
                             fmt::format("has another {}: {}, expected \"{}\"", name,
                                         it == conventions->end() ? "none" : it->dump(), meaning),
                             "make the bundle again with this version of prt");
    }
}

}  // namespace

bool isBundleFileName(const std::string& name) {
    if (name.empty() || name == kManifestName || name.find('\0') != std::string::npos) return false;
    if (name.find(".prt-tmp-") != std::string::npos) return false;
    const std::filesystem::path path(name);
    if (path.is_absolute() || !path.has_filename()) return false;
    for (const auto& part : path)
        if (part == ".." || part == ".") return false;
    return true;
}

bool isJson(const std::string& text) { return jsonNestingDepth(text) <= kMaxJsonDepth && Json::accept(text); }

Manifest parseManifest(const std::string& text, const std::string& where) {
    if (jsonNestingDepth(text) > kMaxJsonDepth + 8) throwDamaged(where, "nested too deeply");
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded() || !json.is_object()) throwDamaged(where, "not a JSON object");
    if (requireText(json, "format", where) != kFormat) throwDamaged(where, "not that of a prt bundle");
    const auto version = json.find("formatVersion");
    if (version == json.end() || !version->is_number_integer()) throwDamaged(where, "no formatVersion");
    if (*version != kBundleFormatVersion)
        throw InputError(where,
                         fmt::format("has format version {}, this program reads {}", version->dump(),
                                     kBundleFormatVersion),
                         "make the bundle again with prt precompute");
    checkManifestConventions(json, where);
    Manifest manifest;
    const auto files = json.find("files");
    if (files == json.end() || !files->is_array()) throwDamaged(where, "no list of files");
    for (const Json& entry : *files) {
        manifest.files.push_back(parseFile(entry, where));
        for (size_t i = 0; i + 1 < manifest.files.size(); ++i)
            if (manifest.files[i].name == manifest.files.back().name)
                throwDamaged(where, "two entries for " + manifest.files[i].name);
    }
    if (const auto sections = json.find("sections"); sections != json.end()) {
        if (!sections->is_object()) throwDamaged(where, "sections that are not an object");
        for (const auto& [name, section] : sections->items()) manifest.sections[name] = section.dump(2);
    }
    return manifest;
}

std::string manifestText(const Manifest& manifest) {
    Json json;
    json["format"] = kFormat;
    json["formatVersion"] = kBundleFormatVersion;
    json["conventions"] = fileConventions();
    json["files"] = Json::array();
    for (const BundleFile& file : manifest.files) {
        Json entry;
        entry["name"] = file.name;
        entry["bytes"] = file.bytes;
        entry["xxh3_128"] = file.xxh3;
        entry["made_from"] = Json::object();
        for (const auto& [name, hash] : file.madeFrom) entry["made_from"][name] = hash;
        entry["made_by"] = file.madeBy;
        json["files"].push_back(std::move(entry));
    }
    json["sections"] = Json::object();
    for (const auto& [name, section] : manifest.sections) json["sections"][name] = Json::parse(section);
    // File names of the file system need not be UTF-8.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace prt
