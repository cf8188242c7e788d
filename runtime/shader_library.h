// The shaders of runtime/shaders, carried inside the library. Internal.
#pragma once

#include <span>
#include <string>

namespace prt {

struct ShaderSource {
    const char* name;  ///< file name
    const char* text;
};
/// All of them (made from runtime/shaders by CMake).
std::span<const ShaderSource> shaderSources();

/// A shader as the compiler takes it: version, defines, common.glsl, the file with what it includes.
/// @param name  of a .vert or .frag file
std::string shaderText(const std::string& name, const std::string& defines);

}  // namespace prt
