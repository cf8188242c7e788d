// How commands are told where to draw.
#pragma once

#include <string>

#include "runtime/gl_context.h"
#include "tools/command_line.h"

namespace prt::tools {

struct ContextArguments {
    std::string name = "osmesa";  ///< as glContextKindName

    /// Adds --context.
    void addTo(CommandLine& line);
    GlContextKind kind() const;
};

}  // namespace prt::tools
