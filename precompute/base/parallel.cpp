#include "precompute/base/parallel.h"

#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "precompute/base/error.h"

namespace prt {
namespace {
std::unique_ptr<tbb::global_control> gControl;
int gThreads = 0;
}  // namespace

void setThreadCount(int threads) {
    gThreads = threads;
    gControl.reset();
    if (threads > 0)
        gControl = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                         size_t(threads));
}

int threadCount() { return gThreads > 0 ? gThreads : int(std::max(1u, std::thread::hardware_concurrency())); }

ScopedThreadCount::ScopedThreadCount(int threads) : before_(gThreads) { setThreadCount(threads); }
ScopedThreadCount::~ScopedThreadCount() { setThreadCount(before_); }

void parallelFor(size_t count, size_t block, const std::function<void(size_t, size_t)>& body) {
    block = std::max<size_t>(block, 1);
    const size_t blocks = (count + block - 1) / block;
    tbb::parallel_for(size_t(0), blocks, [&](size_t i) {
        throwIfInterrupted();
        body(i * block, std::min(count, (i + 1) * block));
    });
}

size_t peakResidentBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return size_t(usage.ru_maxrss) * 1024;
}

}  // namespace prt
