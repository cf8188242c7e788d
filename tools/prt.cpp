// The prt command: finds the subcommand, turns errors into one line and an exit code.
#include <fmt/format.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>
#include <string>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "tools/commands.h"

namespace {

struct Command {
    const char* name;
    const char* summary;
    void (*run)(int, char**);
};

constexpr Command kCommands[] = {
    {"precompute", "mesh file -> bundle: visibility in spherical harmonics, per texel or per vertex",
     prt::tools::runPrecomputeCommand},
    {"compress", "principal components of the visibility of a bundle", prt::tools::runCompressCommand},
    {"tabulate", "tables of light x cosine, or light x cosine x component, for shipping with a bundle",
     prt::tools::runTabulateCommand},
    {"lightmap", "light of one environment, with its bounces, at the points of a bundle",
     prt::tools::runLightmapCommand},
    {"export", "textures (KTX2, DDS), description and shader source for an engine",
     prt::tools::runExportCommand},
    {"relight", "draws a bundle under blended, rotated environments; compares with ray-traced truth",
     prt::tools::runRelightCommand},
    {"view", "opens a window on a bundle: orbit, turn and blend light, compare (in builds with windows)",
     prt::tools::runViewCommand},
    {"info", "explains a bundle: files, conventions, settings, what is stale", prt::tools::runInfoCommand},
    {"measure", "reproduces the papers' figures: parameterizations, bases, rotation, products",
     prt::tools::runMeasureCommand},
};

constexpr int kExitUsage = 2, kExitInput = 3, kExitOutput = 4, kExitInterrupted = 130;

std::string usage() {
    std::string text =
        "prt: precompute, compress and relight low-frequency visibility\n\n"
        "Usage: prt COMMAND [OPTIONS]\n\nCommands:\n";
    for (const Command& command : kCommands)
        text += fmt::format("  {:<12}{}\n", command.name, command.summary);
    text +=
        "\nprt COMMAND --help lists every option with its default and range.\n"
        "Exit codes: 0 ok, 2 usage, 3 input, 4 output, 130 interrupted.\n";
    return text;
}

volatile std::sig_atomic_t gInterruptSecond = 0;

void onInterrupt(int) {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    const auto second = static_cast<std::sig_atomic_t>(now.tv_sec);
    if (!prt::interruptRequested()) {
        gInterruptSecond = second;
        prt::requestInterrupt();
        return;
    }
    // A later Ctrl-C does not wait for work to reach its next check. One that follows at once may be the same
    // one: some senders (timeout(1)) signal the process and then its group.
    if (second - gInterruptSecond > 1) ::_exit(kExitInterrupted);
}

int runCommand(int argc, char** argv) {
    if (argc < 2) {
        std::fputs(usage().c_str(), stderr);
        return kExitUsage;
    }
    const std::string name = argv[1];
    if (name == "--help" || name == "-h" || name == "help") {
        std::fputs(usage().c_str(), stdout);
        return 0;
    }
    if (name == "--version") {
        std::puts("prt " PRT_VERSION);
        return 0;
    }
    for (const Command& command : kCommands) {
        if (name != command.name) continue;
        prt::setProgramName("prt " + name);
        command.run(argc - 1, argv + 1);
        return 0;
    }
    throw prt::UsageError("", fmt::format("'{}' is not a command", name), "prt --help lists them");
}

int fail(const char* message, int code) {
    std::fputs(fmt::format("{}: error: {}\n", prt::programName(), message).c_str(), stderr);
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    struct sigaction action = {};
    action.sa_handler = onInterrupt;
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
    ::signal(SIGXFSZ, SIG_IGN);  // a file-size limit then shows as a failed write
    try {
        return runCommand(argc, argv);
    } catch (const prt::UsageError& error) {
        return fail(error.what(), kExitUsage);
    } catch (const prt::InputError& error) {
        return fail(error.what(), kExitInput);
    } catch (const prt::OutputError& error) {
        return fail(error.what(), kExitOutput);
    } catch (const prt::Interrupted&) {
        return fail("interrupted; nothing was changed", kExitInterrupted);
    } catch (const std::bad_alloc&) {
        return fail("not enough memory; lower --texels, --order or --size", kExitInput);
    } catch (const std::exception& error) {
        return fail(fmt::format("unexpected: {}", error.what()).c_str(), 1);
    }
}
