#include "tools/command_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"

namespace prt::tools {

struct CommandLine::State {
    CLI::App app;
    CommonOptions common;
    std::vector<std::function<void()>> checks;

    /// The long name, as errors should call it.
    // Positional arguments have no long name: theirs as it is.
    static std::string longName(const std::string& names) {
        const size_t dashes = names.find("--");
        return dashes == std::string::npos ? names : names.substr(dashes);
    }
};

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& epilogue)
    : state_(std::make_unique<State>()) {
    state_->app.description(description);
    state_->app.name(name);
    state_->app.footer(epilogue);
    state_->app.get_formatter()->column_width(34);
    state_->app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::Throw);
}

CommandLine::~CommandLine() = default;

void CommandLine::positional(const std::string& name, std::string& value, const std::string& help) {
    state_->app.add_option(name, value, help)->required()->type_name("");
}

void CommandLine::positionalList(const std::string& name, std::vector<std::string>& values,
                                 const std::string& help) {
    state_->app.add_option(name, values, help)
        ->required()
        ->type_name("")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void CommandLine::integer(const std::string& names, int& value, int low, int high, const std::string& help) {
    state_->app.add_option(names, value, fmt::format("{} [{}..{}, default {}]", help, low, high, value))
        ->type_name("INTEGER");
    state_->checks.push_back([&value, low, high, name = State::longName(names)] {
        if (value < low || value > high)
            throw UsageError(name, fmt::format("{} is outside {}..{}", value, low, high), "see --help");
    });
}

void CommandLine::real(const std::string& names, double& value, double low, double high,
                       const std::string& help) {
    state_->app
        .add_option(names, value, fmt::format("{} [{:g}..{:g}, default {:g}]", help, low, high, value))
        ->type_name("NUMBER");
    state_->checks.push_back([&value, low, high, name = State::longName(names)] {
        if (!(value >= low && value <= high))
            throw UsageError(name, fmt::format("{:g} is outside {:g}..{:g}", value, low, high), "see --help");
    });
}

void CommandLine::text(const std::string& names, std::string& value, const std::string& type,
                       const std::string& help, bool required) {
    const std::string text = value.empty() ? help : fmt::format("{} [default {}]", help, value);
    CLI::Option* option = state_->app.add_option(names, value, text)->type_name(type);
    if (required) option->required();
    state_->checks.push_back([option, &value, name = State::longName(names)] {
        if (option->count() > 0 && value.empty()) throw UsageError(name, "its value is empty", "see --help");
    });
}

void CommandLine::textList(const std::string& names, std::vector<std::string>& values,
                           const std::string& type, const std::string& help) {
    state_->app.add_option(names, values, help)
        ->type_name(type)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void CommandLine::choice(const std::string& names, std::string& value,
                         const std::vector<std::string>& choices, const std::string& help) {
    const std::string list = fmt::format("{}", fmt::join(choices, " | "));
    state_->app.add_option(names, value, fmt::format("{} [{}; default {}]", help, list, value))
        ->type_name("NAME");
    state_->checks.push_back([&value, choices, list, name = State::longName(names)] {
        if (std::find(choices.begin(), choices.end(), value) == choices.end())
            throw UsageError(name, fmt::format("'{}' is not one of: {}", value, list), "see --help");
    });
}

void CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
    state_->app.add_flag(names, value, help);
}

namespace {

// Before hours of work rather than after them.
void checkWritable(const std::string& json) {
    if (json.empty() || json == "-") return;
    const std::filesystem::path path(json);
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        throw OutputError(json, fmt::format("there is no folder {}", folder.string()), "make it first");
    if (::access(folder.c_str(), W_OK) != 0)
        throw OutputError(json, fmt::format("the folder {} cannot be written", folder.string()));
    if (std::filesystem::is_directory(path, ignored)) throw OutputError(json, "is a folder", "name a file");
}

}  // namespace

bool CommandLine::parse(int argc, char** argv) {
    CommonOptions& common = state_->common;
    text("--json", common.json, "FILE|-", "write results as JSON to a file, or to standard output (-)");
    integer("--threads", common.threads, 0, 1024, "threads to use; 0 = all cores");
    flag("--quiet", common.quiet, "no notes, no progress; warnings and errors only");
    try {
        state_->app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        std::cout << state_->app.help();
        return false;
    } catch (const CLI::ParseError& error) {
        throw UsageError("", error.what(), "see --help");
    }
    for (const auto& check : state_->checks) check();
    checkWritable(common.json);
    setThreadCount(common.threads);
    setQuiet(common.quiet);
    return true;
}

bool CommandLine::isGiven(const std::string& name) const { return state_->app.count(name) > 0; }
const CommonOptions& CommandLine::common() const { return state_->common; }

namespace {

/// Reads one number at the start of `text` and drops it; false when there is none or it is not finite.
template <typename Number>
bool takeNumber(std::string_view& text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return false;
    text.remove_prefix(size_t(end - text.data()));
    return true;
}

}  // namespace

void parseSize(const std::string& option, const std::string& text, int& width, int& height) {
    std::string_view rest = text;
    bool ok = takeNumber(rest, width) && !rest.empty() && rest.front() == 'x';
    if (ok) {
        rest.remove_prefix(1);
        ok = takeNumber(rest, height) && rest.empty();
    }
    if (!ok) throw UsageError(option, fmt::format("'{}' is not WIDTHxHEIGHT", text), "for example 1280x800");
    if (width < 1 || height < 1 || width > 16384 || height > 16384)
        throw UsageError(option, fmt::format("{} is outside 1x1..16384x16384", text));
}

void parseVector(const std::string& option, const std::string& text, float* xyz) {
    std::string_view rest = text;
    bool ok = true;
    for (int i = 0; i < 3 && ok; ++i) {
        if (i > 0) {
            ok = !rest.empty() && rest.front() == ',';
            if (ok) rest.remove_prefix(1);
        }
        ok = ok && takeNumber(rest, xyz[i]) && std::isfinite(xyz[i]);
    }
    if (!ok || !rest.empty())
        throw UsageError(option, fmt::format("'{}' is not X,Y,Z", text), "for example 8,4,10");
}

}  // namespace prt::tools
