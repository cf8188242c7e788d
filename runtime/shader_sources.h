// The GLSL of runtime/shaders, carried inside the library: for programs of one's own that read the textures
// of a renderer (tools/docs/runtime.md has one), or that draw all by themselves.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace prt {

struct ShaderSource {
    const char* name;  ///< file name: light.frag, table.glsl, …
    const char* text;  ///< as in the file: without a version, with #include lines
};
/// All of them.
std::span<const ShaderSource> shaderSources();

/// A shader as OpenGL's compiler takes it: the version, defines, common.glsl, and the text, in which lines
/// `#include "name"` are replaced by these files.
/// @param text     may be one's own
/// @param defines  lines put in front, each with its line feed: those of a technique are
/// Renderer::shaderDefines
/// @throws InputError  a file that there is not
std::string shaderWithIncludes(std::string_view text, std::string_view defines);

/// The same of a file of shaderSources().
/// @throws InputError  there is no file of that name
std::string shaderText(std::string_view name, std::string_view defines);

}  // namespace prt
