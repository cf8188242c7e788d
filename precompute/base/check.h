// Checks of what only a bug can break: they print both values and abort, in every build type.
#pragma once

#include <string>

#include <fmt/format.h>

namespace prt::detail {
[[noreturn]] void checkFailed(const char* file, int line, const char* expression, const std::string& values);
}

#define PRT_CHECK(condition)                                                              \
    do {                                                                                  \
        if (!(condition)) ::prt::detail::checkFailed(__FILE__, __LINE__, #condition, {}); \
    } while (false)

#define PRT_CHECK_OP_(a, op, b)                                                               \
    do {                                                                                      \
        const auto& prtCheckA = (a);                                                          \
        const auto& prtCheckB = (b);                                                          \
        if (!(prtCheckA op prtCheckB))                                                        \
            ::prt::detail::checkFailed(__FILE__, __LINE__, #a " " #op " " #b,                 \
                                       ::fmt::format("{} against {}", prtCheckA, prtCheckB)); \
    } while (false)
#define PRT_CHECK_EQ(a, b) PRT_CHECK_OP_(a, ==, b)
#define PRT_CHECK_LE(a, b) PRT_CHECK_OP_(a, <=, b)
#define PRT_CHECK_LT(a, b) PRT_CHECK_OP_(a, <, b)
