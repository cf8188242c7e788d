// Sources: none; the viewer's own table.
#include "tools/view/bindings.h"

#include <utility>
#include <vector>

namespace prt::tools {
namespace {

using enum ViewAction;

constexpr KeyBinding kKeys[] = {
    {Key::T, false, "T", NextTechnique, false, "next technique; with Shift the one before"},
    {Key::T, true, "Shift+T", PreviousTechnique, false, nullptr},
    {Key::E, false, "E", NextEnvironment, false, "next environment alone; with Shift the one before"},
    {Key::E, true, "Shift+E", PreviousEnvironment, false, nullptr},
    {Key::Digit0, false, "0", BlendEnvironments, false, "all environments, by their weights"},
    {Key::LeftBracket, false, "[", TurnLightLeft, true, "turn the light by 5 degrees"},
    {Key::RightBracket, false, "]", TurnLightRight, true, nullptr},
    {Key::Minus, false, "-", Darker, true, "exposure, a third of a stop less or more"},
    {Key::KeypadSubtract, false, "Keypad-", Darker, true, nullptr},
    {Key::Equal, false, "=", Brighter, true, nullptr},
    {Key::KeypadAdd, false, "Keypad+", Brighter, true, nullptr},
    {Key::X, false, "X", AutoExposure, false, "exposure chosen from the picture, or kept"},
    {Key::C, false, "C", ViewAction::ToneCurve, false, "next tone curve: none, filmic, neutral"},
    {Key::M, false, "M", Samples, false, "1 or 4 samples a pixel"},
    {Key::N, false, "N", NormalMap, false, "normal map on or off"},
    {Key::B, false, "B", Background, false, "environment behind the scene, or black"},
    {Key::Digit1, false, "1", ShowLit, false, "show the scene lit by the technique"},
    {Key::Digit2, false, "2", ShowWeight, false, "show one weight of the principal components"},
    {Key::Digit3, false, "3", ShowCoefficient, false, "show one coefficient of visibility"},
    {Key::Digit4, false, "4", ShowAo, false, "show ambient occlusion"},
    {Key::Digit5, false, "5", ShowValidity, false, "show where values of points come from"},
    {Key::Digit6, false, "6", ShowCharts, false, "show the charts of the atlas and their edges"},
    {Key::Digit7, false, "7", ShowReference, false, "show the ray-traced reference"},
    {Key::Digit8, false, "8", ShowDifference, false, "show 4 x |technique - reference|"},
    {Key::Left, false, "Left", PreviousIndex, true, "the weight or coefficient before, or the next one"},
    {Key::Right, false, "Right", NextIndex, true, nullptr},
    {Key::W, false, "W", FlyForward, false, "fly forward, left, back, right"},
    {Key::A, false, "A", FlyLeft, false, nullptr},
    {Key::S, false, "S", FlyBack, false, nullptr},
    {Key::D, false, "D", FlyRight, false, nullptr},
    {Key::PageUp, false, "PageUp", FlyUp, false, "fly up or down"},
    {Key::PageDown, false, "PageDown", FlyDown, false, nullptr},
    {Key::F, false, "F", Fit, false, "fit the scene into the window"},
    {Key::R, false, "R", Reset, false, "everything as it was at the start"},
    {Key::P, false, "P", Screenshot, false, "write the picture to a numbered PNG file, without panel"},
    {Key::F12, false, "F12", Screenshot, false, nullptr},
    {Key::Tab, false, "Tab", Panel, false, "panel on or off"},
    {Key::H, false, "H", Help, false, "this help on or off"},
    {Key::F1, false, "F1", Help, false, nullptr},
    {Key::Escape, false, "Escape", Quit, false, "quit"},
};

constexpr MouseBinding kMouse[] = {
    {"left drag", "turn the camera around its target"},
    {"middle drag, Shift + left drag", "move the camera sideways"},
    {"wheel", "nearer or farther; very near, the camera flies on"},
    {"double click", "look at that point and turn around it"},
    {"right drag, L + left drag", "turn the light about the up axis"},
};

}  // namespace

std::span<const KeyBinding> keyBindings() { return kKeys; }
std::span<const MouseBinding> mouseBindings() { return kMouse; }

const KeyBinding* findBinding(Key key, bool shift) {
    const KeyBinding* plain = nullptr;
    for (const KeyBinding& binding : kKeys) {
        if (binding.key != key) continue;
        if (binding.shift && shift) return &binding;
        if (!binding.shift) plain = &binding;
    }
    return plain;
}

std::span<const HelpLine> helpLines() {
    static const std::vector<HelpLine> lines = [] {
        std::vector<HelpLine> made;
        for (const MouseBinding& binding : kMouse) made.push_back({binding.gesture, binding.help});
        for (const KeyBinding& binding : kKeys) {
            if (binding.help)
                made.push_back({binding.name, binding.help});
            else
                made.back().keys += std::string(" ") + binding.name;
        }
        return made;
    }();
    return lines;
}

Key keyFromName(const std::string& name) {
    for (const KeyBinding& binding : kKeys)
        if (!binding.shift && name == binding.name) return binding.key;
    constexpr std::pair<const char*, Key> kOthers[] = {
        {"L", Key::L}, {"Shift", Key::LeftShift}, {"Control", Key::LeftControl}, {"Enter", Key::Enter}};
    for (const auto& [other, key] : kOthers)
        if (name == other) return key;
    return Key::Unknown;
}

}  // namespace prt::tools
