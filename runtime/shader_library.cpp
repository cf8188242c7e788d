// Sources: none; plain text, with the #include that GLSL lacks.
#include "runtime/shader_library.h"

#include <algorithm>
#include <string_view>

#include "precompute/base/check.h"

namespace prt {
namespace {

const char* findShader(std::string_view name) {
    for (const ShaderSource& source : shaderSources())
        if (name == source.name) return source.text;
    return nullptr;
}

// Puts the text of files in place of lines `#include "name"`.
std::string withIncludes(std::string_view text) {
    constexpr std::string_view kInclude = "#include \"";
    std::string all;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        const std::string_view line = text.substr(at, end - at);
        if (line.starts_with(kInclude)) {
            const std::string_view rest = line.substr(kInclude.size());
            const char* included = findShader(rest.substr(0, rest.find('"')));
            PRT_CHECK(included != nullptr);
            all += withIncludes(included);
        } else {
            all += line;
        }
        at = end;
    }
    return all;
}

}  // namespace

std::string shaderText(const std::string& name, const std::string& defines) {
    const char* common = findShader("common.glsl");
    const char* text = findShader(name);
    PRT_CHECK(common && text);
    return "#version 450 core\n" + defines + common + "#line 1\n" + withIncludes(text);
}

}  // namespace prt
