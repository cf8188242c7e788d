// Sources: none; plain text.
#include "runtime/shader_library.h"

#include <string_view>

#include "precompute/base/check.h"

namespace prt {
namespace {

const char* findShader(std::string_view name) {
    for (const ShaderSource& source : shaderSources())
        if (name == source.name) return source.text;
    return nullptr;
}

}  // namespace

std::string shaderText(const std::string& name, const std::string& defines) {
    const char* common = findShader("common.glsl");
    const char* text = findShader(name);
    PRT_CHECK(common && text);
    return "#version 450 core\n" + defines + common + "#line 1\n" + text;
}

}  // namespace prt
