// Loops over the machine's threads: every index once, exceptions out, no more threads than asked for.
#include "core/threads.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <new>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/renderer.h"

namespace glint {
namespace {

TEST(ParallelForOn, EveryIndexOnceOnAtMostSoManyThreads) {
    for (const int threads : {-1, 0, 1, 2, 3, 100}) {
        const ParallelFor loop = parallel_for_on(threads);
        for (const std::size_t count : {0u, 1u, 2u, 5000u}) {
            std::vector<std::atomic<int>> calls(count);
            std::atomic<int> working{0}, most{0};
            std::set<std::thread::id> ids;
            std::mutex mutex;
            loop(count, [&](std::size_t i) {
                const int now = ++working;
                for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
                }
                ++calls[i];
                {
                    const std::lock_guard lock(mutex);
                    ids.insert(std::this_thread::get_id());
                }
                --working;
            });
            EXPECT_EQ(std::accumulate(calls.begin(), calls.end(), 0, [](int n, const auto& c) { return n + (c == 1); }),
                      static_cast<int>(count));
            EXPECT_LE(most, std::max(1, threads));
            if (threads <= 1 && count > 0) {
                EXPECT_EQ(ids, std::set{std::this_thread::get_id()});
            }
        }
    }
}

TEST(ParallelForOn, WhatATaskThrowsReachesTheCallerAndTheLoopGoesOnWorking) {
    for (const int threads : {1, 2, 8}) {
        const ParallelFor loop = parallel_for_on(threads);
        const auto fail = [](std::size_t i) {
            if (i == 77) throw std::bad_alloc();
        };
        EXPECT_THROW(loop(1000, fail), std::bad_alloc);
        std::atomic<int> calls{0};
        loop(100, [&](std::size_t) { ++calls; });
        EXPECT_EQ(calls, 100);
    }
}

TEST(ParallelForOn, AStopEndsTheLoopAtTheNextTask) {
    for (const int threads : {1, 2, 8}) {
        std::stop_source stop;
        const ParallelFor loop = parallel_for_on(threads, stop.get_token());
        std::atomic<int> calls{0};
        const auto task = [&](std::size_t) {
            if (++calls == 10) stop.request_stop();
        };
        EXPECT_THROW(loop(1000000, task), Abandoned);
        EXPECT_LT(calls, 10 + 2 * std::max(1, threads));
        EXPECT_THROW(loop(1, task), Abandoned);
    }
}

TEST(Threads, APinnedOneKeepsToOneProcessorOfThoseItMayUse) {
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    std::set<int> used;
    for (int i = 0; i < CPU_COUNT(&all) + 1; ++i) {
        std::jthread([&] {
            ASSERT_TRUE(pin_to_processor(i));
            cpu_set_t mine;
            ASSERT_EQ(sched_getaffinity(0, sizeof mine, &mine), 0);
            EXPECT_EQ(CPU_COUNT(&mine), 1);
            for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
                if (CPU_ISSET(static_cast<std::size_t>(cpu), &mine)) used.insert(cpu);
            }
        }).join();
    }
    EXPECT_EQ(static_cast<int>(used.size()), CPU_COUNT(&all));
    for (const int cpu : used) EXPECT_TRUE(CPU_ISSET(static_cast<std::size_t>(cpu), &all));
}

// Threads of this process that may use one processor only.
int kept_to_one() {
    int n = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
        cpu_set_t mask;
        n += sched_getaffinity(std::stoi(task.path().filename()), sizeof mask, &mask) == 0 && CPU_COUNT(&mask) == 1 ? 1 : 0;
    }
    return n;
}

TEST(Threads, WorkersThatTakeAllProcessorsHaveOneEach) {
    const int processors = usable_processors(), before = kept_to_one();
    if (processors == 1) GTEST_SKIP() << "one processor";
    const auto settles_at = [&](int expected) {
        for (int i = 0; i < 500 && kept_to_one() - before != expected; ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return kept_to_one() - before == expected;
    };
    {
        const Renderer renderer(processors, false);
        EXPECT_TRUE(settles_at(processors));
    }
    for (const int threads : {1, processors + 1}) {
        const Renderer renderer(threads, true);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        EXPECT_TRUE(settles_at(0)) << threads;
    }
}

}  // namespace
}  // namespace glint
