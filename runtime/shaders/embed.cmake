# Writes OUTPUT, a C++ file that holds the text of every file in SHADERS under its name.
set(entries "")
foreach(path IN LISTS SHADERS)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" text)
  string(APPEND entries "    {\"${name}\", R\"GLSL(${text})GLSL\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "// Made from runtime/shaders; edit those.
#include \"runtime/shader_sources.h\"

namespace prt {

std::span<const ShaderSource> shaderSources() {
    static constexpr ShaderSource kSources[] = {
${entries}    };
    return kSources;
}

}  // namespace prt
")
