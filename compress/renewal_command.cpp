#include "compress/renewal_command.h"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace prt {

std::string shellWord(const std::string& text) {
    const auto isPlain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-./:,=+%@", c) != nullptr;
    };
    if (!text.empty() && std::all_of(text.begin(), text.end(), isPlain)) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

std::string environmentWords(const EnvironmentOptions& options) {
    std::string words;
    if (options.layout != EnvironmentOptions{}.layout) words += " --env-layout " + options.layout;
    if (options.mirrored) words += " --env-mirrored";
    return words;
}

}  // namespace prt
