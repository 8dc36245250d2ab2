// fast_first: how long a viewer shows nothing, with and without a fast tree before the good one. fast_first SCENE...
// Does what the viewer does, window and drawing left out: asks for an accelerator until there is one, and renders.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include <fmt/core.h>

#include "app/options.h"
#include "app/session.h"
#include "core/accelerator_cache.h"
#include "core/scene_io.h"
#include "spread.h"

namespace {

using namespace glint;

struct Times {
    double preview = 0.0, picture = 0.0, swapped = 0.0;  // seconds after start; swapped: 0 = never
    double build = 0.0;                                  // of the accelerator that the first picture is made with
    int restarts = 0;
};

Times look(const std::shared_ptr<const Scene>& scene, bool fast_first, int threads) {
    const auto start = std::chrono::steady_clock::now();
    const auto now = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
    Times times;
    AcceleratorCache cache(scene, threads, BuildPriority::background);
    Renderer renderer(threads, true);
    const AcceleratorSource source{AcceleratorKind::bvh,
                                   [&](AcceleratorKind kind) {
                                       return fast_first ? cache.request_best_so_far(kind, times.picture > 0.0)
                                                         : cache.request(kind);
                                   },
                                   [&](AcceleratorKind kind) { return cache.failed(kind); }};
    Choices choices;
    choices.settings.features = features_of(*scene);
    Session session(scene, choices, scene->cameras.front(), source);
    session.resize(1280, 720);
    std::uint64_t generation = 0;
    const auto wanted = [&] { return times.picture == 0.0 || (fast_first && times.swapped == 0.0); };
    while (wanted() && now() < 60.0) {
        if (auto frame = session.next_frame(renderer.progress())) {
            generation = renderer.restart(std::move(*frame));
            ++times.restarts;
            const AcceleratorChoice first{AcceleratorKind::bvh, fast_first ? BuildQuality::fast : BuildQuality::quality};
            times.build = cache.build_seconds(first);
            // Where a good tree is built at once there is no fast one, and nothing will be swapped.
            if (times.build == 0.0) fast_first = false, times.build = cache.build_seconds(AcceleratorKind::bvh);
        }
        if (auto better = session.take_replacement()) {
            if (renderer.replace_accelerator(generation, std::move(better))) times.swapped = now();
        }
        const Progress p = renderer.progress();
        if (times.preview == 0.0 && p.preview_complete && generation != 0) times.preview = now();
        if (times.picture == 0.0 && p.spp_min > 0) times.picture = now();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return times;
}

}  // namespace

int main(int argc, char** argv) try {
    const int threads = available_threads();
    fmt::print("1280x720, {} threads, medians of 5; seconds from the loaded scene on\n", threads);
    fmt::print("{:<26} {:>10} {:<8} {:>7} {:>12} {:>14} {:>8} {:>8}\n", "scene", "primitives", "tree", "build", "coarse look",
               "first picture", "swapped", "restarts");
    for (int i = 1; i < argc; ++i) {
        const auto scene = load_scene(argv[i]);
        std::array<std::array<std::vector<double>, 4>, 2> seconds;
        std::array<int, 2> restarts{};
        for (int round = 0; round < 5; ++round) {
            for (const std::size_t fast : {std::size_t{0}, std::size_t{1}}) {
                const Times t = look(scene, fast == 1, threads);
                seconds[fast][0].push_back(t.build);
                seconds[fast][1].push_back(t.preview);
                seconds[fast][2].push_back(t.picture);
                seconds[fast][3].push_back(t.swapped);
                restarts[fast] = std::max(restarts[fast], t.restarts - 1);
            }
        }
        for (const std::size_t fast : {std::size_t{0}, std::size_t{1}}) {
            std::array<double, 4> m{};
            for (std::size_t k = 0; k < 4; ++k) m[k] = bench::spread(seconds[fast][k]).median;
            fmt::print("{:<26} {:>10} {:<8} {:>7.3f} {:>12.3f} {:>14.3f} {:>8} {:>8}\n", argv[i],
                       scene->geometry->bounded_count(), fast == 1 ? "fast" : "quality", m[0], m[1], m[2],
                       m[3] > 0.0 ? fmt::format("{:.3f}", m[3]) : "-", restarts[fast]);
        }
    }
} catch (const std::exception& error) {
    fmt::print(stderr, "fast_first: {}\n", error.what());
    return 2;
}
