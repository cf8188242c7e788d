// What every EXR file of a bundle says about itself, and the check of it on load.
#pragma once

#include <map>
#include <string>

#include "precompute/io/exr_file.h"

namespace prt {

/// Version of the layouts of visibility.exr, pca.exr and tables/*.exr.
inline constexpr int kExrFormatVersion = 1;
/// Bands that files may hold.
inline constexpr int kMaxFileShOrder = 10;

/// The conventions that all files share, as string attributes; also in the manifest.
const std::map<std::string, std::string>& fileConventions();

/// Conventions, version and content kind ("visibility", "pca", "normal-table"), joined with the caller's own
/// attributes. Where a name is both, the file's own value is written.
ExrAttributes conventionAttributes(const std::string& content, int shOrder,
                                   const std::map<std::string, std::string>& own);

/// @return the caller's own attributes, as they were passed to conventionAttributes
/// @throws InputError  another content, version or convention
std::map<std::string, std::string> checkConventions(const ExrAttributes& attributes,
                                                    const std::string& content, const std::string& path);

/// An integer attribute in [low, high].
/// @throws InputError  absent or out of range
int requireInt(const ExrAttributes& attributes, const std::string& name, int low, int high,
               const std::string& path);
/// @throws InputError  absent
const std::string& requireString(const ExrAttributes& attributes, const std::string& name,
                                 const std::string& path);

/// "V.07": a prefix and a two-digit index.
std::string indexedName(const std::string& prefix, int index);

}  // namespace prt
