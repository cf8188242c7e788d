// Calls a command of prt in this process.
#pragma once

#include <string>
#include <vector>

namespace prt::tools::test {

/// As main() would.
/// @param arguments  the command's name first
inline void runCommand(void (*command)(int argc, char** argv), std::vector<std::string> arguments) {
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    command(int(pointers.size()), pointers.data());
}

}  // namespace prt::tools::test
