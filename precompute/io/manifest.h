// manifest.json as text and back (internal to the bundle).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "precompute/io/bundle.h"

namespace prt {

struct Manifest {
    std::vector<BundleFile> files;
    std::map<std::string, std::string> sections;  ///< name → JSON text
};

inline constexpr const char* kManifestName = "manifest.json";

/// @throws InputError  not JSON, not a bundle's, another version, missing or absurd values
Manifest parseManifest(const std::string& text, const std::string& where);
std::string manifestText(const Manifest& manifest);
/// Relative, inside the bundle, not a temporary and not the manifest itself.
bool isBundleFileName(const std::string& name);
/// True for one JSON value that nests within bounds.
bool isJson(const std::string& text);

}  // namespace prt
