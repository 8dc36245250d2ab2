// What a Renderer's workers and its callers share, and the one lock over it. Only renderer.cpp and renderer_workers.cpp see this.
// Invariants: the queue holds exactly the tiles that lack samples and that no worker has; tiles_left counts both.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "core/adaptive.h"
#include "core/camera.h"
#include "core/framebuffer.h"
#include "core/render_plan.h"
#include "core/renderer.h"
#include "core/tile_queue.h"

namespace glint {

// A frame with everything derived from it once, before any worker sees it.
struct Order {
    Frame frame;
    RenderPlan plan;
    Camera camera;
    std::uint64_t generation = 0;
};

struct Renderer::State {
    using Clock = std::chrono::steady_clock;

    const bool preview;
    std::atomic<std::uint64_t> generation{0};

    mutable std::mutex mutex;  // guards everything below
    mutable std::condition_variable work, change;
    std::shared_ptr<const Order> order;
    std::shared_ptr<Framebuffer> framebuffer;
    TileQueue queue;
    std::uint64_t queue_generation = 0;
    std::vector<int> goals;  // samples that each tile is on its way to
    std::size_t previews_left = 0, tiles_left = 0;
    bool paused = false, stopping = false;
    std::uint64_t failed_generation = 0;  // of the frame that memory did not suffice for
    RayCounts counts;
    Clock::time_point running_since;
    double seconds_before = 0.0;  // until the last pause or the finish
    bool running = false;

    explicit State(bool with_preview) : preview(with_preview) {}

    [[nodiscard]] double seconds() const {
        return seconds_before + (running ? std::chrono::duration<double>(Clock::now() - running_since).count() : 0.0);
    }
    void run_clock(bool on) {
        if (on == running) return;
        if (on)
            running_since = Clock::now();
        else
            seconds_before = seconds();
        running = on;
    }
    [[nodiscard]] bool failed() const { return order != nullptr && failed_generation == order->generation; }
    // Every pixel shows this frame. The last samples may overtake a preview whose worker was held up.
    [[nodiscard]] bool covered() const { return previews_left == 0 || finished(); }
    [[nodiscard]] bool finished() const {
        return order != nullptr && queue_generation == order->generation && tiles_left == 0 && !failed();
    }
    // Of the frame whose tiles were dealt.
    [[nodiscard]] int least_samples_so_far() const {
        int least = order->frame.spp;
        for (std::size_t i = 0; i < framebuffer->tile_count(); ++i)
            least = std::min(least, framebuffer->samples(i, order->generation));
        return least;
    }

    // Samples that the picture counts for.
    [[nodiscard]] int samples_so_far() const {
        if (!adaptive()) return least_samples_so_far();
        return finished() ? order->frame.spp
                          : static_cast<int>(counts.camera / static_cast<std::uint64_t>(framebuffer->area().pixels()));
    }
    [[nodiscard]] bool adaptive() const { return order->frame.settings.adaptive && order->plan.stochastic(); }

    // The first worker to look at a new order deals its tiles out; restart() itself stays O(1).
    void deal();
    // A worker's life: all of it but for frames that are too large.
    void run_worker();
    // Returns when stopping; `current` is the generation of the frame it works on.
    void work_loop(std::uint64_t& current);
    // The frame can never be finished; the next one may be smaller.
    void give_up(std::uint64_t generation_given_up);
    // The order wants more samples than `before`: puts tiles back that have fewer and that nobody has.
    void take_up_again(int before);
    // When all tiles have reached their goals: sets new ones where samples are adaptive and the order wants more. False:
    // finished.
    bool deal_again();
};

}  // namespace glint
