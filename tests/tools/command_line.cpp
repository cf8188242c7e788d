#include "tools/command_line.h"

#include "precompute/base/error.h"
#include "tools/relight_arguments.h"

namespace prt::tools {
namespace {

TEST(ParseSize, TakesWidthAndHeight) {
    int width = 0, height = 0;
    parseSize("--size", "1280x800", width, height);
    EXPECT_EQ(width, 1280);
    EXPECT_EQ(height, 800);
}

TEST(ParseSize, RefusesEverythingElse) {
    int width = 0, height = 0;
    for (const char* text :
         {"", "x", "12", "12x", "x12", "12x12x", "0x5", "5x0", "-1x5", "20000x5", "1e3x5", "12X12", " 1x1"})
        EXPECT_THROW(parseSize("--size", text, width, height), UsageError) << text;
}

TEST(ParseVector, TakesThreeNumbers) {
    float xyz[3];
    parseVector("--eye", "1,-2.5,3e1", xyz);
    EXPECT_EQ(xyz[0], 1);
    EXPECT_EQ(xyz[1], -2.5f);
    EXPECT_EQ(xyz[2], 30);
    for (const char* text : {"", "1", "1,2", "1,2,", "1,2,3,", "1;2;3", "nan,1,2", "inf,1,2", "a,b,c"})
        EXPECT_THROW(parseVector("--eye", text, xyz), UsageError) << text;
}

TEST(EnvironmentArgument, SplitsOffTheWeight) {
    EXPECT_EQ(parseEnvironmentArgument("a.exr:0.7").source, "a.exr");
    EXPECT_DOUBLE_EQ(parseEnvironmentArgument("a.exr:0.7").weight, 0.7);
    EXPECT_EQ(parseEnvironmentArgument("sky:clear").source, "sky:clear");
    EXPECT_DOUBLE_EQ(parseEnvironmentArgument("sky:clear").weight, 1);
    EXPECT_EQ(parseEnvironmentArgument("sky:clear:2").source, "sky:clear");
    EXPECT_DOUBLE_EQ(parseEnvironmentArgument("sky:clear:2").weight, 2);
    EXPECT_EQ(parseEnvironmentArgument("C:dir/a.exr").source, "C:dir/a.exr");
    EXPECT_THROW(parseEnvironmentArgument("a.exr:-1"), UsageError);
    EXPECT_THROW(parseEnvironmentArgument("a.exr:nan"), UsageError);
    EXPECT_THROW(parseEnvironmentArgument(":1"), UsageError);
    EXPECT_THROW(parseEnvironmentArgument(""), UsageError);
}

TEST(RelightCamera, LooksFromTheAskedSide) {
    RelightArguments arguments;
    const Bounds bounds{Vec3f(-1, -1, -1), Vec3f(1, 1, 1)};
    arguments.elevationDeg = 0;
    arguments.azimuthDeg = 0;
    EXPECT_GT(arguments.camera(bounds).eye.z(), 2);
    arguments.azimuthDeg = 90;
    EXPECT_GT(arguments.camera(bounds).eye.x(), 2);
    arguments.elevationDeg = 80;
    EXPECT_GT(arguments.camera(bounds).eye.y(), 2);
    arguments.eyeText = "0,0,0";
    EXPECT_THROW(arguments.camera(bounds), UsageError);
}

TEST(CommandLine, WhatCannotBeWrittenIsFoundBeforeTheWork) {
    const auto parse = [](std::vector<std::string> arguments) {
        std::string output;
        CommandLine line("prt test", "", "");
        line.text("-o,--output", output, "FILE", "where to");
        arguments.insert(arguments.begin(), "test");
        std::vector<char*> pointers;
        for (std::string& argument : arguments) pointers.push_back(argument.data());
        line.parse(int(pointers.size()), pointers.data());
    };
    EXPECT_NO_THROW(parse({"--json", "-"}));
    EXPECT_NO_THROW(parse({"--json", "new.json"}));
    EXPECT_THROW(parse({"--json", "/no/such/folder/new.json"}), OutputError);
    EXPECT_THROW(parse({"--json", "/tmp"}), OutputError);
    EXPECT_THROW(parse({"-o", ""}), UsageError);
    EXPECT_NO_THROW(parse({"-o", "x"}));
}

}  // namespace
}  // namespace prt::tools
