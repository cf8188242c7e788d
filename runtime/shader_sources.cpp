// Sources: none; plain text, with the #include that GLSL lacks.
#include "runtime/shader_sources.h"

#include <algorithm>
#include <string_view>

#include "precompute/base/error.h"

namespace prt {
namespace {

std::string_view findShader(std::string_view name) {
    for (const ShaderSource& source : shaderSources())
        if (name == source.name) return source.text;
    throw InputError("shader " + std::string(name), "there is no such file", "runtime/shaders has them");
}

std::string included(std::string_view text) {
    constexpr std::string_view kInclude = "#include \"";
    std::string all;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        const std::string_view line = text.substr(at, end - at);
        if (line.starts_with(kInclude)) {
            const std::string_view rest = line.substr(kInclude.size());
            all += included(findShader(rest.substr(0, rest.find('"'))));
        } else {
            all += line;
        }
        at = end;
    }
    return all;
}

}  // namespace

std::string shaderWithIncludes(std::string_view text, std::string_view defines) {
    std::string all = "#version 450 core\n";
    all += defines;
    all += findShader("common.glsl");
    all += "#line 1\n";
    return all + included(text);
}

std::string shaderText(std::string_view name, std::string_view defines) {
    return shaderWithIncludes(findShader(name), defines);
}

}  // namespace prt
