#include "tests/tools/prt_process.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace prt::test {
namespace fs = std::filesystem;
namespace {

std::string quoted(const std::string& text) {
    std::string result = "'";
    for (char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

}  // namespace

std::string slurp(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

Folder::Folder() {
    std::string pattern = (fs::temp_directory_path() / "prt-test-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) std::abort();
    path_ = pattern;
}

Folder::~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string Folder::write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
}

std::vector<std::string> Folder::files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_))
        if (!entry.is_directory()) names.push_back(fs::relative(entry.path(), path_).generic_string());
    std::sort(names.begin(), names.end());
    return names;
}

ProcessResult runPrt(const Folder& folder, const std::vector<std::string>& arguments,
                     const std::string& prelude) {
    // Captured outside the folder, so that its contents are what the command left.
    const std::string capture = folder.path().string() + ".capture";
    std::string words = quoted(PRT_BINARY);
    for (const std::string& argument : arguments) words += ' ' + quoted(argument);
    const std::string command =
        fmt::format("cd {} && {{ {} {}; }} >{} 2>{} </dev/null", quoted(folder.path().string()), prelude,
                    words, quoted(capture + ".out"), quoted(capture + ".err"));
    const int status = std::system(command.c_str());
    ProcessResult result;
    result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = slurp(capture + ".out");
    result.err = slurp(capture + ".err");
    fs::remove(capture + ".out");
    fs::remove(capture + ".err");
    return result;
}

std::string cubeObj() {
    return "v -0.5 0 -0.5\nv 0.5 0 -0.5\nv 0.5 0 0.5\nv -0.5 0 0.5\n"
           "v -0.5 1 -0.5\nv 0.5 1 -0.5\nv 0.5 1 0.5\nv -0.5 1 0.5\n"
           "f 1 2 3 4\nf 8 7 6 5\nf 4 3 7 8\nf 2 1 5 6\nf 3 2 6 7\nf 1 4 8 5\n";
}

std::string openBoxObj() {
    return "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1\n"
           "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

}  // namespace prt::test
