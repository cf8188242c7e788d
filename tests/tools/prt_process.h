// Runs the prt command as a user does, in a fresh folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace prt::test {

struct ProcessResult {
    int exitCode = -1;
    std::string out, err;
};

/// A temporary folder that goes away with the object.
class Folder {
  public:
    Folder();
    ~Folder();
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }
    std::string write(const std::string& name, const std::string& text) const;
    /// Every file below, relative, sorted.
    std::vector<std::string> files() const;

  private:
    std::filesystem::path path_;
};

/// The bytes of a file.
std::string slurp(const std::filesystem::path& path);

/// @param arguments  without "prt"
/// @param prelude    shell text run first in the same shell, e.g. "ulimit -f 10;"
ProcessResult runPrt(const Folder& folder, const std::vector<std::string>& arguments,
                     const std::string& prelude = "");

/// A unit cube at y = 0.5 as OBJ text with quads, no normals and no UVs.
std::string cubeObj();
/// An open box seen from above (five faces, normals inwards), which occludes itself.
std::string openBoxObj();

}  // namespace prt::test
