// What a window tells the viewer, whoever made it: a person through GLFW, or a script.
#pragma once

#include <cstdint>

namespace prt::tools {

// clang-format off
/// Numbers are those of GLFW 3.3, so that a window's key is this key.
enum class Key : int {
    Unknown = -1, Space = 32, Comma = 44, Minus = 45, Period = 46,
    Digit0 = 48, Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9, Equal = 61,
    A = 65, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P, Q, R, S, T, U, V, W, X, Y, Z,
    LeftBracket = 91, RightBracket = 93,
    Escape = 256, Enter, Tab, Backspace, Insert, Delete, Right, Left, Down, Up, PageUp, PageDown,
    Home = 268, End, F1 = 290, F12 = 301, KeypadSubtract = 333, KeypadAdd = 334,
    LeftShift = 340, LeftControl = 341, RightShift = 344, RightControl = 345
};
// clang-format on
/// One more than the largest number of GLFW.
inline constexpr int kKeyCount = 349;

enum class MouseButton : int { Left, Right, Middle };
inline constexpr int kMouseButtonCount = 3;

enum class ViewEventKind { Cursor, Button, Scroll, Key, Text, Leave, Close, Refresh };

struct ViewEvent {
    ViewEventKind kind = ViewEventKind::Refresh;
    double x = 0, y = 0;  ///< Cursor: from the window's top left corner, in its units; Scroll: steps
    MouseButton button = MouseButton::Left;
    Key key = Key::Unknown;
    bool pressed = false;   ///< Button, Key; else it was let go
    bool repeated = false;  ///< Key: held down
    bool shift = false, control = false;
    uint32_t character = 0;  ///< Text
    double seconds = 0;      ///< when, on a clock that never goes back
};

}  // namespace prt::tools
