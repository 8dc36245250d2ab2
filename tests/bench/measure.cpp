#include "measure.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <functional>
#include <thread>

#include <time.h>

#include "core/threads.h"
#include "embree_scene.h"

namespace glint::bench {
namespace {

constexpr std::size_t kBlocksAtOnce = 16;  // 4096 rays: what a thread takes at a time

double read_clock(clockid_t id) {
    timespec t{};
    clock_gettime(id, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Span {
    double start = 0.0, end = 0.0, cpu = 0.0;
};

void work(const Competitor& competitor, const RaySet& set, std::vector<Block>& blocks, std::atomic<std::size_t>& next,
          Span& span) {
    const double cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
    span.start = read_clock(CLOCK_MONOTONIC);
    competitor.begin_thread();
    for (;;) {
        const std::size_t first = next.fetch_add(kBlocksAtOnce);
        if (first >= blocks.size()) break;
        const std::span some = std::span(blocks).subspan(first, std::min(kBlocksAtOnce, blocks.size() - first));
        if (set.any) {
            competitor.occluded(set.order, some);
        } else {
            competitor.closest(set.order, some);
        }
    }
    competitor.end_thread();
    span.end = read_clock(CLOCK_MONOTONIC);
    span.cpu = read_clock(CLOCK_THREAD_CPUTIME_ID) - cpu;
}

double seconds_of_one_pass(const Competitor& competitor, const RaySet& set, std::vector<Block>& blocks, int threads,
                           Clock clock) {
    std::atomic<std::size_t> next{0};
    std::vector<Span> spans(static_cast<std::size_t>(threads));
    if (threads == 1) {
        work(competitor, set, blocks, next, spans[0]);
    } else {
        std::barrier start(threads);
        std::vector<std::jthread> workers;
        for (int i = 0; i < threads; ++i) {
            workers.emplace_back([&, i] {
                pin_to_processor(i);  // so that none waits for another's
                start.arrive_and_wait();
                work(competitor, set, blocks, next, spans[static_cast<std::size_t>(i)]);
            });
        }
    }
    double start = spans[0].start, end = 0.0, cpu = 0.0;
    for (const Span& s : spans) {
        start = std::min(start, s.start);
        end = std::max(end, s.end);
        cpu += s.cpu;
    }
    return clock == Clock::wall ? end - start : cpu / threads;
}

double seconds_of(const std::function<void()>& f) {
    const double start = read_clock(CLOCK_MONOTONIC);
    f();
    return read_clock(CLOCK_MONOTONIC) - start;
}

struct Builder {
    Build result;
    std::function<std::size_t(double&)> run;  // adds the seconds, returns the bytes
};

// Threads made for each call, as cheap as a caller without a pool can be.
ParallelFor parallel_for_of(int threads) {
    if (threads == 1) return serial_for;
    return [threads](std::size_t count, const std::function<void(std::size_t)>& task) {
        std::atomic<std::size_t> next{0};
        const auto take = [&] {
            for (std::size_t i = next++; i < count; i = next++) task(i);
        };
        std::vector<std::jthread> helpers;
        for (int i = 1; i < threads; ++i) helpers.emplace_back(take);
        take();
    };
}

Builder bvh_builder(const std::shared_ptr<const Geometry>& geometry, int threads, BuildQuality quality) {
    const std::string name = quality == BuildQuality::fast ? "glint bvh, fast" : "glint bvh";
    return {{name, threads, {}, 0}, [geometry, threads, quality](double& seconds) {
                std::size_t bytes = 0;
                seconds =
                    seconds_of([&] { bytes = Bvh(geometry, parallel_for_of(threads), isa_in_use(), quality).memory_bytes(); });
                return bytes;
            }};
}

Builder grid_builder(const std::shared_ptr<const Geometry>& geometry) {
    return {{"glint grid", 1, {}, 0}, [geometry](double& seconds) {
                std::size_t bytes = 0;
                seconds = seconds_of([&] { bytes = UniformGrid(geometry).memory_bytes(); });
                return bytes;
            }};
}

Builder embree_builder(std::string name, const std::shared_ptr<const EmbreeInput>& input, const EmbreeBuild& build) {
    return {{std::move(name), build.threads, {}, 0}, [input, build](double& seconds) {
                const EmbreeScene scene(input, build);
                seconds = scene.build_seconds();
                return scene.memory_bytes();
            }};
}

}  // namespace

std::vector<Rates> race(const Competitors& competitors, const RaySet& set, int threads, int rounds, Clock clock) {
    Answers answers(set.rays.size());
    std::vector<Block> blocks = make_blocks(set, answers, 0, answers.hits.size());
    std::vector<Rates> rates;
    for (const auto& c : competitors) rates.push_back({c->name(), c->role(), {}});
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t k = 0; k < rates.size(); ++k) {
            const std::size_t c = (k + static_cast<std::size_t>(round) * 3) % rates.size();
            const double seconds = seconds_of_one_pass(*competitors[c], set, blocks, threads, clock);
            rates[c].mrays.push_back(1e-6 * static_cast<double>(set.rays.size()) / seconds);
        }
    }
    return rates;
}

std::vector<Build> race_builds(const std::shared_ptr<const Geometry>& geometry, bool with_grid, int rounds) {
    const auto input = std::make_shared<const EmbreeInput>(*geometry);
    std::vector<Builder> builders;
    for (int threads : {1, 2}) builders.push_back(bvh_builder(geometry, threads, BuildQuality::quality));
    for (int threads : {1, 2}) builders.push_back(bvh_builder(geometry, threads, BuildQuality::fast));
    if (with_grid) builders.push_back(grid_builder(geometry));
    for (int threads : {1, 2}) {
        builders.push_back(embree_builder("embree low", input, {RTC_BUILD_QUALITY_LOW, false, false, threads}));
        builders.push_back(embree_builder("embree medium", input, {RTC_BUILD_QUALITY_MEDIUM, false, false, threads}));
        builders.push_back(embree_builder("embree high", input, {RTC_BUILD_QUALITY_HIGH, false, false, threads}));
    }
    for (int round = 0; round < rounds; ++round) {
        for (Builder& builder : builders) {
            double seconds = 0.0;
            builder.result.bytes = builder.run(seconds);
            builder.result.seconds.push_back(seconds);
        }
    }
    std::vector<Build> builds;
    for (Builder& builder : builders) builds.push_back(std::move(builder.result));
    return builds;
}

}  // namespace glint::bench
