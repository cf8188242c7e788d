// Keys and mouse of the viewer: the one table from which input is handled, the help overlay is drawn and the
// documentation is checked.
#pragma once

#include <span>
#include <string>

#include "tools/view/event.h"

namespace prt::tools {

enum class ViewAction {
    Quit,
    Help,
    Panel,
    Fit,
    Reset,
    NextTechnique,
    PreviousTechnique,
    NextEnvironment,
    PreviousEnvironment,
    BlendEnvironments,
    TurnLightLeft,
    TurnLightRight,
    Brighter,
    Darker,
    AutoExposure,
    ToneCurve,
    Samples,
    NormalMap,
    Background,
    ShowLit,
    ShowWeight,
    ShowCoefficient,
    ShowAo,
    ShowValidity,
    ShowCharts,
    ShowReference,
    ShowDifference,
    NextIndex,
    PreviousIndex,
    Screenshot,
    FlyForward,
    FlyBack,
    FlyLeft,
    FlyRight,
    FlyUp,
    FlyDown
};

struct KeyBinding {
    Key key;
    bool shift;        ///< with Shift held down; bindings without it do not look
    const char* name;  ///< as help and scripts call it, e.g. "Shift+T"
    ViewAction action;
    bool repeats;      ///< also while the key is held down
    const char* help;  ///< null: an alternative to the binding before it, listed together with it
};
std::span<const KeyBinding> keyBindings();

/// @return null where the key does nothing
const KeyBinding* findBinding(Key key, bool shift);

struct MouseBinding {
    const char* gesture;
    const char* help;
};
std::span<const MouseBinding> mouseBindings();

/// One line of help: keys that do the same thing, and what they do.
struct HelpLine {
    std::string keys, help;
};
/// Mouse first, then keys, in the order of their tables.
std::span<const HelpLine> helpLines();

/// The key of a name as in KeyBinding::name, without "Shift+"; also "L", "Shift" and "Control".
Key keyFromName(const std::string& name);

}  // namespace prt::tools
