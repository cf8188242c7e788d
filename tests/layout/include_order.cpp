// The order between the project's libraries, checked on what their files include; and third-party headers
// kept out of public headers.
#include <fstream>
#include <map>
#include <regex>
#include <set>

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = PRT_SOURCE_DIR;

/// Folder of a target → the folders it may include, itself left out.
const std::map<std::string, std::set<std::string>> kAllowed = {
    {"precompute/base", {}},
    {"precompute/math", {"precompute/base"}},
    {"compress/tables", {"precompute/base", "precompute/math"}},
    {"precompute/io", {"precompute/base", "precompute/math"}},
    {"precompute/rays", {"precompute/base", "precompute/math"}},
    {"precompute/mesh", {"precompute/base", "precompute/math", "precompute/io"}},
    {"precompute/visibility",
     {"precompute/base", "precompute/math", "precompute/io", "precompute/mesh", "precompute/rays"}},
    {"compress", {"precompute/base", "precompute/math", "precompute/io", "compress/tables"}},
    {"runtime", {"precompute/base", "precompute/math", "precompute/io", "compress/tables"}},
    {"runtime/reference", {"precompute/base", "precompute/math", "precompute/io", "precompute/rays"}},
};
/// The reference must not share the bake's mathematics.
const std::set<std::string> kForbiddenInReference = {"precompute/math/sh.h", "precompute/math/sh_product.h",
                                                     "precompute/math/directions.h"};

std::string folderOf(const fs::path& file) {
    return fs::relative(file.parent_path(), kRoot).generic_string();
}

std::vector<std::string> includesOf(const fs::path& file) {
    std::vector<std::string> includes;
    std::ifstream stream(file);
    const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
    std::smatch match;
    for (std::string line; std::getline(stream, line);)
        if (std::regex_search(line, match, pattern)) includes.push_back(match[1]);
    return includes;
}

std::vector<fs::path> sources() {
    std::vector<fs::path> files;
    for (const char* top : {"precompute", "compress", "runtime"})
        for (const auto& entry : fs::recursive_directory_iterator(kRoot / top))
            if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
                files.push_back(entry.path());
    return files;
}

TEST(IncludeOrder, LibrariesIncludeOnlyWhatTheyMay) {
    int checked = 0;
    for (const fs::path& file : sources()) {
        const std::string folder = folderOf(file);
        ASSERT_TRUE(kAllowed.count(folder)) << file << ": its folder is no known target";
        for (const std::string& include : includesOf(file)) {
            if (!fs::exists(kRoot / include)) continue;
            const std::string target = fs::path(include).parent_path().generic_string();
            ++checked;
            EXPECT_TRUE(target == folder || kAllowed.at(folder).count(target))
                << file << " includes " << include;
        }
    }
    EXPECT_GT(checked, 50);
}

TEST(IncludeOrder, ReferenceSharesNothingWithTheBake) {
    for (const fs::path& file : sources())
        if (folderOf(file) == "runtime/reference") {
            for (const std::string& include : includesOf(file))
                EXPECT_FALSE(kForbiddenInReference.count(include)) << file << " includes " << include;
        }
}

TEST(IncludeOrder, ThirdPartyHeadersStayOutOfPublicHeaders) {
    const std::regex thirdParty(
        R"(^(embree|GL/|OpenMesh|Imf|Imath|OpenEXR|tiny|CLI/|nlohmann|Spectra|tbb/|stb|webp|xxh))");
    for (const fs::path& file : sources()) {
        if (file.extension() != ".h") continue;
        const std::string name = file.filename().string();
        if (name.starts_with("gl_") || name.find("internal") != std::string::npos) continue;
        for (const std::string& include : includesOf(file))
            EXPECT_FALSE(std::regex_search(include, thirdParty)) << file << " includes " << include;
    }
}

TEST(IncludeOrder, EmbreeIsUsedInOneFolder) {
    for (const fs::path& file : sources()) {
        if (folderOf(file) == "precompute/rays") continue;
        for (const std::string& include : includesOf(file))
            EXPECT_FALSE(include.starts_with("embree")) << file;
    }
}

}  // namespace
