// Compresses a bundle with as many bytes of data more than it has at its start, on one thread.
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>

#include "compress/compress_job.h"
#include "precompute/base/log.h"
#include "precompute/base/parallel.h"

namespace {

// Private writable memory, which RLIMIT_DATA limits.
size_t dataBytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmData:")) return size_t(std::atoll(line.c_str() + 7)) << 10;
    return 0;
}

}  // namespace

// limited_compress BUNDLE COMPONENTS BYTES
int main(int argc, char** argv) {
    if (argc != 4) return 2;
    prt::setQuiet(true);
    prt::setThreadCount(1);
    const size_t bytes = dataBytes();
    if (bytes == 0) return 2;
    const rlimit limit{rlim_t(bytes + size_t(std::atoll(argv[3]))), RLIM_INFINITY};
    if (::setrlimit(RLIMIT_DATA, &limit) != 0) return 2;
    try {
        prt::runCompress({argv[1], std::atoi(argv[2])});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
