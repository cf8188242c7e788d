#include "precompute/base/log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <mutex>

#include "precompute/base/error.h"

namespace prt {
namespace {

std::atomic<bool> gQuiet{false};
std::string gProgramName = "prt";

std::string withSuffix(double value) {
    if (value >= 1e9) return fmt::format("{:.1f} G", value * 1e-9);
    if (value >= 1e6) return fmt::format("{:.1f} M", value * 1e-6);
    if (value >= 1e4) return fmt::format("{:.1f} k", value * 1e-3);
    return fmt::format("{:.0f} ", value);
}

}  // namespace

void setQuiet(bool quiet) { gQuiet = quiet; }
bool isQuiet() { return gQuiet; }
void setProgramName(std::string name) { gProgramName = std::move(name); }
const std::string& programName() { return gProgramName; }

void logNote(std::string_view line) {
    if (!gQuiet) std::fputs(fmt::format("{}: {}\n", gProgramName, line).c_str(), stderr);
}
void logWarning(std::string_view line) {
    std::fputs(fmt::format("{}: warning: {}\n", gProgramName, line).c_str(), stderr);
}

struct Progress::State {
    std::string label, unit;
    uint64_t total;
    std::atomic<uint64_t> done{0};
    std::mutex mutex;
    Stopwatch watch;
    double lastPrint = 0;
    bool printed = false;
    const bool terminal = ::isatty(2) != 0;

    std::string status() const {
        const uint64_t count = std::min(done.load(), total);
        const double seconds = watch.seconds();
        const double rate = seconds > 0 ? double(count) / seconds : 0;
        const double left = rate > 0 ? double(total - count) / rate : 0;
        return fmt::format("{:3.0f} %  {}{}/s  {:.0f} s left",
                           total ? 100.0 * double(count) / double(total) : 100.0, withSuffix(rate), unit,
                           left);
    }
    void print(double now) {
        lastPrint = now;
        printed = true;
        if (terminal) {
            const int width = 30;
            const int filled = total ? int(width * std::min(done.load(), total) / total) : width;
            std::fputs(fmt::format("\r{:<12} [{}{}] {}\x1b[K", label, std::string(size_t(filled), '#'),
                                   std::string(size_t(width - filled), '.'), status())
                           .c_str(),
                       stderr);
        } else {
            std::fputs(fmt::format("{}: {} {}\n", gProgramName, label, status()).c_str(), stderr);
        }
    }
};

Progress::Progress(std::string label, uint64_t total, std::string unit) : state_(new State) {
    state_->label = std::move(label);
    state_->unit = std::move(unit);
    state_->total = total;
}

Progress::~Progress() {
    if (state_->printed && state_->terminal) std::fputs("\r\x1b[K", stderr);
    delete state_;
}

void Progress::advance(uint64_t units) {
    state_->done += units;
    throwIfInterrupted();
    if (gQuiet || !state_->mutex.try_lock()) return;
    std::lock_guard lock(state_->mutex, std::adopt_lock);
    const double now = state_->watch.seconds();
    if (now - state_->lastPrint >= (state_->terminal ? 0.1 : 5.0)) state_->print(now);
}

}  // namespace prt
