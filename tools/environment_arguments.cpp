#include "tools/environment_arguments.h"

#include <vector>

#include "precompute/math/environment_layout.h"

namespace prt::tools {

void addEnvironmentOptions(CommandLine& line, EnvironmentOptions& options) {
    std::vector<std::string> names = environmentLayoutNames();
    names.insert(names.begin(), "auto");
    line.choice("--env-layout", options.layout, names,
                "layout of the environment files; auto goes by attributes and shape");
    line.flag("--env-mirrored", options.mirrored,
              "environment files show the sphere from its other side: left and right are swapped");
}

std::vector<Environment> loadEnvironmentsOrSkies(std::vector<std::string> sources, bool withUniform) {
    if (sources.empty())
        for (const std::string& sky : builtInEnvironments())
            if (withUniform || sky != "sky:uniform") sources.push_back(sky);
    std::vector<Environment> environments;
    for (const std::string& source : sources) environments.push_back(loadEnvironment(source));
    return environments;
}

}  // namespace prt::tools
