#include "tools/measure/timing.h"

#include <algorithm>
#include <fstream>

#include "precompute/base/error.h"
#include "precompute/base/log.h"

namespace prt::tools {

std::vector<double> timeMethods(const std::vector<TimedMethod>& methods, int rounds, double secondsPerRun) {
    std::vector<std::vector<double>> times(methods.size());
    for (int round = -1; round < rounds; ++round) {  // the first warms up
        for (size_t m = 0; m < methods.size(); ++m) {
            throwIfInterrupted();
            const Stopwatch watch;
            size_t calls = 0;
            double seconds = 0;
            for (size_t batch = 1; seconds < secondsPerRun; batch *= 2) {  // few looks at the clock
                for (size_t call = 0; call < batch; ++call) methods[m].body();
                calls += batch;
                seconds = watch.seconds();
            }
            if (round >= 0) times[m].push_back(seconds * 1e9 / double(calls * methods[m].items));
        }
    }
    std::vector<double> medians;
    for (auto& of : times) {
        std::nth_element(of.begin(), of.begin() + std::ptrdiff_t(of.size() / 2), of.end());
        medians.push_back(of[of.size() / 2]);
    }
    return medians;
}

std::string cpuName() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) {
            const size_t colon = line.find(": ");
            if (colon != std::string::npos) return line.substr(colon + 2);
        }
    return "unknown";
}

}  // namespace prt::tools
