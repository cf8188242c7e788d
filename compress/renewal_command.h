// Words of the commands that a manifest names to renew a file.
#pragma once

#include <string>

#include "precompute/io/environment_file.h"

namespace prt {

/// A text as a shell takes it for one word.
std::string shellWord(const std::string& text);

/// Options of how environments are read, each behind a space; empty where all are the defaults.
std::string environmentWords(const EnvironmentOptions& options);

}  // namespace prt
