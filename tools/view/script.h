// Input from a file in place of a person's: the viewer's tests, and pictures made without hands.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/view/event.h"

namespace prt::tools {

enum class ScriptAction {
    Events,         ///< `events`, one after the other
    Hold,           ///< `events` press the key `events[0]` and let it go `number` seconds later
    Technique,      ///< `text`, its name
    Show,           ///< `text`, a name of Shown; `index` of the weight or coefficient
    Rotate,         ///< to `number`, degrees
    Exposure,       ///< to `number`, stops; `text` "auto": chosen from the picture
    Weight,         ///< of the environment `text`: `number`
    Resize,         ///< the window to `index` × `index2`
    WaitReference,  ///< until the reference of the picture is there
    Screenshot,     ///< of the scene into the file `text`
    WindowShot,     ///< of the whole window, panel included, into the file `text`
    Report,         ///< a line of JSON about the state to standard output
    Quit
};

struct ScriptStep {
    int line = 0;  ///< from 1
    ScriptAction action = ScriptAction::Events;
    std::vector<ViewEvent> events = {};  ///< times are 0
    std::string text = {};
    double number = 0;
    int index = 0, index2 = 0;
};

/// Reads a script: a command a line, words apart by blanks; empty lines and what follows # do nothing. The
/// commands are those of scriptHelp().
/// @param where  names the script in errors
/// @throws InputError  where:line, what is wrong with it and how it should be
std::vector<ScriptStep> parseViewScript(std::string_view text, const std::string& where);

/// Every command with its arguments and what it does, a line each.
struct ScriptCommandHelp {
    const char* usage;
    const char* help;
};
const std::vector<ScriptCommandHelp>& scriptHelp();

}  // namespace prt::tools
