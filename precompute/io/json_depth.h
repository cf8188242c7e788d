// Guard in front of JSON readers that recurse.
#pragma once

#include <string_view>

namespace prt {

/// Deepest nesting of brackets in a JSON text, without parsing it.
size_t jsonNestingDepth(std::string_view text);
/// Nothing that the project reads nests deeper; recursion over this is safe.
inline constexpr size_t kMaxJsonDepth = 128;

}  // namespace prt
