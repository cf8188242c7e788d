#include "tools/context_arguments.h"

namespace prt::tools {

void ContextArguments::addTo(CommandLine& line) {
    line.choice("--context", name,
                {glContextKindName(GlContextKind::OsMesa), glContextKindName(GlContextKind::Egl)},
                "draw in software, or through EGL: on a GPU where there is one");
}

GlContextKind ContextArguments::kind() const {
    return name == glContextKindName(GlContextKind::Egl) ? GlContextKind::Egl : GlContextKind::OsMesa;
}

}  // namespace prt::tools
