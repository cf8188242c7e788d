// Scripts of the viewer: what each line becomes, and what is said about wrong ones.
#include "precompute/base/error.h"
#include "tools/view/bindings.h"
#include "tools/view/script.h"

namespace prt::tools {
namespace {

using testing::HasSubstr;

std::string errorOf(const std::string& text) {
    try {
        parseViewScript(text, "input.txt");
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(ViewScript, DragsAsAHandDoes) {
    const auto steps = parseViewScript("drag left 100 110 300 120\n", "s");
    ASSERT_EQ(steps.size(), 1u);
    const std::vector<ViewEvent>& events = steps[0].events;
    ASSERT_GE(events.size(), 4u);
    EXPECT_EQ(events.front().kind, ViewEventKind::Cursor);
    EXPECT_EQ(events.front().x, 100);
    EXPECT_EQ(events.front().y, 110);
    EXPECT_EQ(events[1].kind, ViewEventKind::Button);
    EXPECT_TRUE(events[1].pressed);
    EXPECT_EQ(events[events.size() - 2].x, 300);
    EXPECT_EQ(events[events.size() - 2].y, 120);
    EXPECT_FALSE(events.back().pressed);
    EXPECT_EQ(events.back().kind, ViewEventKind::Button);
}

TEST(ViewScript, KeysAndModifiers) {
    const auto steps =
        parseViewScript("key N\nkey Shift+T # before\n\n  # nothing\ndrag left 0 0 5 5 L\n", "s");
    ASSERT_EQ(steps.size(), 3u);
    EXPECT_EQ(steps[0].events[0].key, Key::N);
    EXPECT_TRUE(steps[0].events[0].pressed);
    EXPECT_FALSE(steps[0].events[1].pressed);
    EXPECT_TRUE(steps[1].events[0].shift);
    EXPECT_EQ(steps[1].events[0].key, Key::T);
    EXPECT_EQ(steps[2].line, 5);
    EXPECT_EQ(steps[2].events[1].key, Key::L);
    EXPECT_EQ(steps[2].events.back().key, Key::L);
    EXPECT_FALSE(steps[2].events.back().pressed);
    EXPECT_TRUE(parseViewScript("drag middle 0 0 1 1 Shift", "s")[0].events[1].shift);
}

TEST(ViewScript, EveryCommandOfTheHelpIsRead) {
    const std::string script =
        "drag right 1 2 3 4\nmove 5 6\nclick 1 2\ndoubleclick 1 2\nscroll -1.5\nkey [\nhold W 0.5\n"
        "technique pca16\nshow weight 3\nrotate 40\nexposure -1\nexposure auto\nweight sky 0.5\n"
        "resize 320 200\nwait-reference\nscreenshot a.png\nwindow b.png\nreport\nquit\n";
    const auto steps = parseViewScript(script, "s");
    EXPECT_EQ(steps.size(), 19u);
    for (const ScriptCommandHelp& help : scriptHelp()) {
        const std::string usage = help.usage, name = usage.substr(0, usage.find(' '));
        EXPECT_THAT("\n" + script, HasSubstr("\n" + name)) << name;
    }
    EXPECT_EQ(steps[4].events[0].y, -1.5);
    EXPECT_EQ(steps[6].action, ScriptAction::Hold);
    EXPECT_EQ(steps[6].number, 0.5);
    EXPECT_EQ(steps[7].text, "pca16");
    EXPECT_EQ(steps[8].index, 3);
    EXPECT_EQ(steps[10].number, -1);
    EXPECT_EQ(steps[11].text, "auto");
    EXPECT_EQ(steps[13].index2, 200);
    EXPECT_EQ(steps[18].action, ScriptAction::Quit);
}

TEST(ViewScript, ErrorsSayWhereAndHow) {
    EXPECT_THAT(errorOf("key N\njump 3\n"), testing::AllOf(HasSubstr("input.txt:2: "), HasSubstr("'jump'")));
    EXPECT_THAT(errorOf("drag left 1 2 3\n"), HasSubstr("drag BUTTON X0 Y0 X1 Y1"));
    EXPECT_THAT(errorOf("drag thumb 1 2 3 4\n"), HasSubstr("'thumb'"));
    EXPECT_THAT(errorOf("drag left 1 2 3 4 Alt\n"), HasSubstr("'Alt'"));
    EXPECT_THAT(errorOf("key Nonsense\n"), HasSubstr("'Nonsense'"));
    EXPECT_THAT(errorOf("scroll up\n"), HasSubstr("'up' is not a number"));
    EXPECT_THAT(errorOf("scroll nan\n"), HasSubstr("'nan' is not a number"));
    EXPECT_THAT(errorOf("scroll 1 2\n"), HasSubstr("'2' is too much"));
    EXPECT_THAT(errorOf("hold W -1\n"), HasSubstr("time"));
    EXPECT_THAT(errorOf("weight sky -1\n"), HasSubstr("not negative"));
    EXPECT_THAT(errorOf("resize 0 100\n"), HasSubstr("0 is not a whole number in 1..16384"));
    EXPECT_THAT(errorOf("screenshot\n"), HasSubstr("missing"));
    EXPECT_EQ(errorOf(""), "");
}

}  // namespace
}  // namespace prt::tools
