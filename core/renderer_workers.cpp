#include <algorithm>
#include <new>
#include <vector>

#include "core/renderer_state.h"
#include "core/threads.h"
#include "core/tile_kernels.h"

namespace glint {
namespace {

// Samples a pixel gets per visit at most; many are faster, since they are alike. A viewer's visits double the samples, a
// file's, which only whoever interrupts it looks at, have them eightfold.
constexpr int kMaxBatch = 32;

}  // namespace

void Renderer::State::deal() {
    const Frame& f = order->frame;
    const TileRect area{f.x0, f.y0, f.x1, f.y1};
    if (framebuffer == nullptr || framebuffer->area() != area) framebuffer = std::make_shared<Framebuffer>(area, preview);
    const std::size_t n = framebuffer->tile_count();
    queue.deal(n, preview);
    goals.assign(n, adaptive() ? std::min(f.spp, kUniformSamples) : f.spp);
    previews_left = preview ? n : 0;
    tiles_left = n;
    queue_generation = order->generation;
}

void Renderer::State::run_worker() {
    if (preview) lower_priority();
    std::uint64_t current = 0;
    for (bool stopped = false; !stopped;) {
        try {
            work_loop(current);
            stopped = true;
        } catch (const std::bad_alloc&) {
            give_up(current);
        }
    }
}

void Renderer::State::give_up(std::uint64_t generation_given_up) {
    const std::lock_guard lock(mutex);
    failed_generation = generation_given_up;
    if (!failed()) return;
    queue.clear();
    queue_generation = failed_generation;
    run_clock(false);
    change.notify_all();
}

void Renderer::State::take_up_again(int before) {
    if (queue_generation != order->generation || failed()) return;
    if (adaptive()) {
        if (tiles_left == 0) deal_again();
        return;
    }
    goals.assign(goals.size(), order->frame.spp);
    for (std::size_t i = 0; i < framebuffer->tile_count(); ++i) {
        // A tile with fewer is in the queue, or a worker has it, who will look at the order again when done.
        if (framebuffer->samples(i, order->generation) != before) continue;
        queue.give_back({i, false, before});
        ++tiles_left;
    }
}

bool Renderer::State::deal_again() {
    if (!adaptive()) return false;
    const std::vector<std::size_t> next = tiles_to_double(framebuffer->states(order->generation), order->frame.spp);
    for (const std::size_t tile : next) {
        const int samples = framebuffer->samples(tile, order->generation);
        goals[tile] = doubled(samples);
        queue.give_back({tile, false, samples});
    }
    tiles_left = next.size();
    return tiles_left > 0;
}

void Renderer::State::work_loop(std::uint64_t& current) {
    std::vector<PixelSum> sums;
    std::vector<glm::vec3> blocks;
    Workspace workspace;
    std::unique_lock lock(mutex);
    for (;;) {
        work.wait(lock, [this] {
            return stopping || (order != nullptr && !paused && (queue_generation != order->generation || !queue.empty()));
        });
        if (stopping) return;
        current = order->generation;
        if (queue_generation != order->generation) {
            deal();
            work.notify_all();
        }
        TileTask task = queue.take();
        const std::shared_ptr<const Order> o = order;
        const int first = task.samples;
        const int last = std::min(goals[task.tile], first + std::clamp(preview ? first : 7 * first, 1, kMaxBatch));
        const TileRect rect = framebuffer->tile_rect(task.tile);
        if (!task.preview && first > 0) framebuffer->copy_out(task.tile, o->generation, sums);
        lock.unlock();

        if (!task.preview && first == 0) set_to_zero(sums, rect.pixels());
        workspace.counts = RayCounts();
        workspace.doublings = {};
        const KernelInput input{*o->frame.scene, *o->frame.accelerator, o->plan, o->camera, generation, o->generation};
        const bool done = task.preview ? render_preview(input, rect, blocks, workspace)
                                       : render_tile(input, rect, first, last, sums, workspace);
        lock.lock();
        // A newer order makes this result worthless; it is dropped here and nowhere else.
        if (!done || o->generation != order->generation || failed()) continue;
        if (task.preview) {
            framebuffer->write_preview(task.tile, o->generation, blocks);
            if (--previews_left == 0) change.notify_all();
            continue;
        }
        counts += workspace.counts;
        framebuffer->write_back(task.tile, o->generation, sums, last, workspace.doublings, workspace.counts.work());
        if (last < goals[task.tile]) {
            task.samples = last;
            queue.give_back(task);
            if (queue.size() == 1) work.notify_one();
        } else if (--tiles_left == 0) {
            if (deal_again()) {
                work.notify_all();
                continue;
            }
            run_clock(false);
            change.notify_all();
        }
    }
}

}  // namespace glint
