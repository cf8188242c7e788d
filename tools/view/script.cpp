// Sources: none; the language is described in tools/docs/view.md.
#include "tools/view/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>

#include "precompute/base/error.h"
#include "tools/view/bindings.h"

namespace prt::tools {
namespace {

ViewEvent cursorTo(double x, double y) {
    ViewEvent event;
    event.kind = ViewEventKind::Cursor;
    event.x = x;
    event.y = y;
    return event;
}

ViewEvent buttonEvent(MouseButton button, bool pressed, bool shift = false) {
    ViewEvent event;
    event.kind = ViewEventKind::Button;
    event.button = button;
    event.pressed = pressed;
    event.shift = shift;
    return event;
}

ViewEvent keyEvent(Key key, bool pressed, bool shift = false) {
    ViewEvent event;
    event.kind = ViewEventKind::Key;
    event.key = key;
    event.pressed = pressed;
    event.shift = shift;
    return event;
}

/// The words of one line, taken one after the other.
class Words {
  public:
    Words(const std::string& line, std::string where) : where_(std::move(where)) {
        std::istringstream stream(line);
        for (std::string word; stream >> word;) words_.push_back(word);
    }
    bool empty() const { return next_ == words_.size(); }
    std::string take() {
        if (empty()) fail("something is missing");
        return words_[next_++];
    }
    std::string takeOr(const std::string& fallback) { return empty() ? fallback : take(); }
    double number() {
        const std::string word = take();
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !(std::abs(value) <= 1e6))
            fail(fmt::format("'{}' is not a number", word));
        return value;
    }
    int integer(int low, int high) {
        const double value = number();
        if (value != std::floor(value) || value < low || value > high)
            fail(fmt::format("{:g} is not a whole number in {}..{}", value, low, high));
        return int(value);
    }
    MouseButton button() {
        const std::string word = take();
        if (word == "left") return MouseButton::Left;
        if (word == "right") return MouseButton::Right;
        if (word == "middle") return MouseButton::Middle;
        fail(fmt::format("'{}' is no button; there are left, middle and right", word));
    }
    /// @param shift  null: the key must come without it
    Key key(bool* shift) {
        std::string word = take();
        constexpr std::string_view kShift = "Shift+";
        if (shift && word.starts_with(kShift)) {
            *shift = true;
            word.erase(0, kShift.size());
        }
        const Key key = keyFromName(word);
        if (key == Key::Unknown) fail(fmt::format("'{}' is no key of the viewer", word));
        return key;
    }
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(where_, problem, "usage: " + usage);
    }
    std::string usage;

  private:
    std::string where_;
    std::vector<std::string> words_;
    size_t next_ = 0;
};

// As a hand does it, in four moves.
void addDrag(Words& words, ScriptStep& step) {
    const MouseButton button = words.button();
    const double x0 = words.number(), y0 = words.number(), x1 = words.number(), y1 = words.number();
    const std::string with = words.takeOr("");
    if (!with.empty() && with != "Shift" && with != "L")
        words.fail(fmt::format("'{}' is not Shift or L", with));
    const bool shift = with == "Shift", light = with == "L";
    constexpr int kMoves = 4;
    step.events = {cursorTo(x0, y0)};
    if (light) step.events.push_back(keyEvent(Key::L, true));
    step.events.push_back(buttonEvent(button, true, shift));
    for (int i = 1; i <= kMoves; ++i)
        step.events.push_back(cursorTo(x0 + (x1 - x0) * i / kMoves, y0 + (y1 - y0) * i / kMoves));
    step.events.push_back(buttonEvent(button, false, shift));
    if (light) step.events.push_back(keyEvent(Key::L, false));
}

void addClicks(Words& words, int count, ScriptStep& step) {
    const double x = words.number();
    step.events = {cursorTo(x, words.number())};
    for (int i = 0; i < count; ++i)
        for (const bool pressed : {true, false})
            step.events.push_back(buttonEvent(MouseButton::Left, pressed));
}

struct Command {
    const char* name;
    ScriptAction action;
    ScriptCommandHelp help;
    std::function<void(Words&, ScriptStep&)> read;
};

const std::vector<Command>& commands() {
    using enum ScriptAction;
    const auto file = [](Words& words, ScriptStep& step) { step.text = words.take(); };
    const auto nothing = [](Words&, ScriptStep&) {};
    static const std::vector<Command> list = {
        {"drag",
         Events,
         {"drag BUTTON X0 Y0 X1 Y1 [Shift|L]",
          "drag with a mouse button (left, middle, right) and a key held"},
         [](Words& words, ScriptStep& step) { addDrag(words, step); }},
        {"move",
         Events,
         {"move X Y", "the cursor to a point, from the window's top left corner"},
         [](Words& words, ScriptStep& step) {
             const double x = words.number();
             step.events = {cursorTo(x, words.number())};
         }},
        {"click",
         Events,
         {"click X Y", "with the left button"},
         [](Words& words, ScriptStep& step) { addClicks(words, 1, step); }},
        {"doubleclick",
         Events,
         {"doubleclick X Y", "with the left button"},
         [](Words& words, ScriptStep& step) { addClicks(words, 2, step); }},
        {"scroll",
         Events,
         {"scroll STEPS", "the wheel; positive goes nearer"},
         [](Words& words, ScriptStep& step) {
             ViewEvent event;
             event.kind = ViewEventKind::Scroll;
             event.y = words.number();
             step.events = {event};
         }},
        {"key",
         Events,
         {"key [Shift+]NAME", "a key, pressed and let go"},
         [](Words& words, ScriptStep& step) {
             bool shift = false;
             const Key key = words.key(&shift);
             step.events = {keyEvent(key, true, shift), keyEvent(key, false, shift)};
         }},
        {"hold",
         Hold,
         {"hold NAME SECONDS", "a key, held down for so long (no time passes)"},
         [](Words& words, ScriptStep& step) {
             const Key key = words.key(nullptr);
             step.events = {keyEvent(key, true), keyEvent(key, false)};
             step.number = words.number();
             if (step.number < 0) words.fail("time does not go back");
         }},
        {"technique",
         Technique,
         {"technique NAME", "light by this technique"},
         [](Words& words, ScriptStep& step) { step.text = words.take(); }},
        {"show",
         Show,
         {"show WHAT [NUMBER]", "lit, weight, coefficient, ao, validity, charts, reference or difference"},
         [](Words& words, ScriptStep& step) {
             step.text = words.take();
             step.index = words.empty() ? 0 : words.integer(0, 9999);
         }},
        {"rotate",
         Rotate,
         {"rotate DEGREES", "turn of the environments"},
         [](Words& words, ScriptStep& step) { step.number = words.number(); }},
        {"exposure",
         Exposure,
         {"exposure STOPS|auto", "brightness"},
         [](Words& words, ScriptStep& step) {
             Words copy = words;
             if (copy.take() == "auto")
                 step.text = words.take();
             else
                 step.number = words.number();
         }},
        {"weight",
         Weight,
         {"weight ENVIRONMENT VALUE", "of an environment, by its name, in the blend"},
         [](Words& words, ScriptStep& step) {
             step.text = words.take();
             step.number = words.number();
             if (step.number < 0) words.fail("a weight is not negative");
         }},
        {"resize",
         Resize,
         {"resize WIDTH HEIGHT", "the window"},
         [](Words& words, ScriptStep& step) {
             step.index = words.integer(1, 16384);
             step.index2 = words.integer(1, 16384);
         }},
        {"wait-reference",
         WaitReference,
         {"wait-reference", "until the ray-traced reference of the picture is there"},
         nothing},
        {"screenshot", Screenshot, {"screenshot FILE", "the scene as PNG, without panel and help"}, file},
        {"window", WindowShot, {"window FILE", "the whole window as PNG"}, file},
        {"report", Report, {"report", "a line of JSON about what is shown, to standard output"}, nothing},
        {"quit", Quit, {"quit", "ends the viewer; without it, it stays open for a person"}, nothing},
    };
    return list;
}

}  // namespace

std::vector<ScriptStep> parseViewScript(std::string_view text, const std::string& where) {
    std::vector<ScriptStep> steps;
    std::istringstream lines{std::string(text)};
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++number;
        Words words(line.substr(0, line.find('#')), fmt::format("{}:{}", where, number));
        if (words.empty()) continue;
        words.usage = "COMMAND …, see prt view --help";
        const std::string name = words.take();
        const auto command =
            std::ranges::find_if(commands(), [&](const Command& known) { return name == known.name; });
        if (command == commands().end()) words.fail(fmt::format("there is no command '{}'", name));
        words.usage = command->help.usage;
        ScriptStep step;
        step.line = number;
        step.action = command->action;
        command->read(words, step);
        if (!words.empty()) words.fail(fmt::format("'{}' is too much", words.take()));
        steps.push_back(std::move(step));
    }
    return steps;
}

const std::vector<ScriptCommandHelp>& scriptHelp() {
    static const std::vector<ScriptCommandHelp> help = [] {
        std::vector<ScriptCommandHelp> made;
        for (const Command& command : commands()) made.push_back(command.help);
        return made;
    }();
    return help;
}

}  // namespace prt::tools
