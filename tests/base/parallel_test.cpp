// Blocks do not depend on threads; exceptions arrive.
#include "precompute/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "precompute/base/error.h"

namespace prt {
namespace {

using Blocks = std::vector<std::pair<size_t, size_t>>;

class Parallel : public testing::TestWithParam<int> {
  protected:
    void SetUp() override {
        clearInterrupt();
        setThreadCount(GetParam());
    }
    void TearDown() override {
        clearInterrupt();
        setThreadCount(0);
    }
};

Blocks blocksOf(size_t count, size_t block) {
    Blocks blocks;
    std::mutex mutex;
    parallelFor(count, block, [&](size_t begin, size_t end) {
        const std::lock_guard lock(mutex);
        blocks.emplace_back(begin, end);
    });
    std::sort(blocks.begin(), blocks.end());
    return blocks;
}

TEST_P(Parallel, BlocksAreConsecutiveAndFull) {
    for (const auto& [count, block] :
         {std::pair<size_t, size_t>{0, 4}, {1, 4}, {4, 4}, {1000, 7}, {10, 1000}, {5, 0}}) {
        Blocks expected;
        for (size_t begin = 0; begin < count; begin += std::max<size_t>(block, 1))
            expected.emplace_back(begin, std::min(count, begin + std::max<size_t>(block, 1)));
        EXPECT_EQ(blocksOf(count, block), expected) << count << " by " << block;
    }
}

TEST_P(Parallel, SumsPerBlockAreTheSameBits) {
    // Sums of floats differ when they are split differently.
    const auto sums = [] {
        std::vector<float> perBlock(143);
        parallelFor(1000, 7, [&](size_t begin, size_t end) {
            float sum = 0;
            for (size_t i = begin; i < end; ++i) sum += 1.0f / float(i + 1);
            perBlock[begin / 7] = sum;
        });
        return perBlock;
    };
    const std::vector<float> here = sums();
    setThreadCount(1);
    EXPECT_EQ(here, sums());
}

TEST_P(Parallel, ExceptionsReachTheCaller) {
    EXPECT_THROW(parallelFor(100, 1,
                             [](size_t begin, size_t) {
                                 if (begin == 57) throw InputError("item 57", "bad");
                             }),
                 InputError);
    EXPECT_THROW(parallelFor(100, 1, [](size_t, size_t) { throw std::runtime_error("x"); }),
                 std::runtime_error);
}

TEST_P(Parallel, InterruptsStopTheLoop) {
    std::atomic<size_t> done{0};
    EXPECT_THROW(parallelFor(100000, 1,
                             [&](size_t, size_t) {
                                 if (++done == 10) requestInterrupt();
                             }),
                 Interrupted);
    // Each thread may finish what it was about to do.
    EXPECT_LT(done.load(), 10u + 64u);
}

TEST_P(Parallel, LoopsMayNest) {
    std::atomic<size_t> sum{0};
    parallelFor(20, 3, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            parallelFor(30, 4, [&](size_t innerBegin, size_t innerEnd) { sum += innerEnd - innerBegin; });
    });
    EXPECT_EQ(sum.load(), 600u);
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, testing::Values(0, 1, 2, 5));

TEST(ThreadCount, ZeroMeansAllCores) {
    setThreadCount(3);
    EXPECT_EQ(threadCount(), 3);
    setThreadCount(0);
    EXPECT_GE(threadCount(), 1);
}

// As many threads as a loop runs on, at most `sought` of them waited for: each block waits until so many
// threads have come, or gives up after a second.
size_t threadsOfLoop(size_t sought) {
    std::mutex mutex;
    std::set<std::thread::id> seen;
    parallelFor(64, 1, [&](size_t, size_t) {
        for (int tries = 0; tries < 1000; ++tries) {
            {
                const std::lock_guard lock(mutex);
                seen.insert(std::this_thread::get_id());
                if (seen.size() >= sought) break;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    });
    return seen.size();
}

// A loop takes up what was set last, be it more or less than before, and each scope leaves what it found.
TEST(ThreadCount, ScopesNest) {
    setThreadCount(3);
    {
        const ScopedThreadCount one(1);
        EXPECT_EQ(threadCount(), 1);
        EXPECT_EQ(threadsOfLoop(1), 1u);
        {
            const ScopedThreadCount two(2);
            EXPECT_EQ(threadCount(), 2);
            EXPECT_EQ(threadsOfLoop(2), 2u);
        }
        EXPECT_EQ(threadCount(), 1);
        EXPECT_EQ(threadsOfLoop(1), 1u);
    }
    EXPECT_EQ(threadCount(), 3);
    EXPECT_EQ(threadsOfLoop(3), 3u);
    setThreadCount(0);
    const int all = threadCount();
    { const ScopedThreadCount two(2); }
    EXPECT_EQ(threadCount(), all);
}

TEST(PeakResidentBytes, CountsBytes) {
    const std::vector<char> large(size_t(64) << 20, 'x');
    EXPECT_GE(peakResidentBytes(), large.size());
    EXPECT_LT(peakResidentBytes(), size_t(1) << 42);
}

}  // namespace
}  // namespace prt
