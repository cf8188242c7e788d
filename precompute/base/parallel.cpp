#include "precompute/base/parallel.h"

#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <thread>

#include "precompute/base/error.h"

namespace prt {
namespace {
std::unique_ptr<tbb::global_control> gControl;
int gThreads = 0;
// Where loops run. TBB's own arena of the calling thread keeps the size that it was first used with, so that
// a larger number of threads set later would go unheard.
std::mutex gArenaMutex;
std::shared_ptr<tbb::task_arena> gArena;
thread_local bool tInLoop = false;

std::shared_ptr<tbb::task_arena> arena() {
    const std::lock_guard lock(gArenaMutex);
    if (!gArena) gArena = std::make_shared<tbb::task_arena>(threadCount());
    return gArena;
}

// Marks the thread while it runs a block of a loop; loops inside stay in the same arena.
class InLoop {
  public:
    InLoop() : before_(tInLoop) { tInLoop = true; }
    ~InLoop() { tInLoop = before_; }
    InLoop(const InLoop&) = delete;
    InLoop& operator=(const InLoop&) = delete;

  private:
    bool before_;
};
}  // namespace

void setThreadCount(int threads) {
    const std::lock_guard lock(gArenaMutex);
    gThreads = threads;
    gArena.reset();
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
    const auto loop = [&] {
        tbb::parallel_for(size_t(0), blocks, [&](size_t i) {
            const InLoop mark;
            throwIfInterrupted();
            body(i * block, std::min(count, (i + 1) * block));
        });
    };
    if (tInLoop)
        loop();
    else
        arena()->execute(loop);
}

size_t peakResidentBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return size_t(usage.ru_maxrss) * 1024;
}

}  // namespace prt
