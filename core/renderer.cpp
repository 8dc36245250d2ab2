#include "core/renderer.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <stdexcept>
#include <utility>

#include "core/framebuffer.h"
#include "core/render_plan.h"
#include "core/threads.h"
#include "core/tile_kernels.h"
#include "core/tile_queue.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

// Samples a pixel gets per visit at most; many are faster, since they are alike. A viewer's visits double the samples, a
// file's, which only whoever interrupts it looks at, have them eightfold.
constexpr int kMaxBatch = 32;

// A frame with everything derived from it once, before any worker sees it.
struct Order {
    Frame frame;
    RenderPlan plan;
    Camera camera;
    std::uint64_t generation = 0;
};

}  // namespace

struct Renderer::State {
    const bool preview;
    std::atomic<std::uint64_t> generation{0};

    mutable std::mutex mutex;  // guards everything below
    mutable std::condition_variable work, change;
    std::shared_ptr<const Order> order;
    std::shared_ptr<Framebuffer> framebuffer;
    TileQueue queue;
    std::uint64_t queue_generation = 0;
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

    // The first worker to look at a new order deals its tiles out; restart() itself stays O(1).
    void deal() {
        const Frame& f = order->frame;
        const TileRect area{f.x0, f.y0, f.x1, f.y1};
        if (framebuffer == nullptr || framebuffer->area() != area) framebuffer = std::make_shared<Framebuffer>(area, preview);
        const std::size_t n = framebuffer->tile_count();
        queue.deal(n, preview);
        previews_left = preview ? n : 0;
        tiles_left = n;
        queue_generation = order->generation;
    }

    // A worker's life: all of it but for frames that are too large.
    void run_worker() {
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
    // Returns when stopping; `current` is the generation of the frame it works on.
    void work_loop(std::uint64_t& current);
    // The frame can never be finished; the next one may be smaller.
    void give_up(std::uint64_t generation_given_up) {
        const std::lock_guard lock(mutex);
        failed_generation = generation_given_up;
        if (!failed()) return;
        queue.clear();
        queue_generation = failed_generation;
        run_clock(false);
        change.notify_all();
    }
};

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
        const int last = std::min(o->frame.spp, first + std::clamp(preview ? first : 7 * first, 1, kMaxBatch));
        const TileRect rect = framebuffer->tile_rect(task.tile);
        if (!task.preview) framebuffer->copy_out(task.tile, o->generation, sums);
        lock.unlock();

        workspace.counts = RayCounts();
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
        framebuffer->write_back(task.tile, o->generation, sums, last);
        if (last < o->frame.spp) {
            task.samples = last;
            queue.give_back(task);
            if (queue.size() == 1) work.notify_one();
        } else if (--tiles_left == 0) {
            run_clock(false);
            change.notify_all();
        }
    }
}

Renderer::Renderer(int threads, bool preview) : state_(std::make_unique<State>(preview)) {
    workers_.reserve(static_cast<std::size_t>(std::max(1, threads)));
    for (int i = 0; i < std::max(1, threads); ++i) {
        try {
            workers_.emplace_back([this] { state_->run_worker(); });
        } catch (const std::exception&) {
            // Fewer workers give the same picture.
            if (workers_.empty()) throw std::runtime_error("no thread can be started");
            break;
        }
    }
}

Renderer::~Renderer() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stopping = true;
        state_->generation = ~std::uint64_t{0};  // abandons tiles in progress
    }
    state_->work.notify_all();
    workers_.clear();
}

std::uint64_t Renderer::restart(Frame frame) {
    assert(frame.scene != nullptr && frame.accelerator != nullptr && frame.width > 0 && frame.height > 0 && frame.spp > 0);
    if (frame.x1 == 0 && frame.y1 == 0) {
        frame.x1 = frame.width;
        frame.y1 = frame.height;
    }
    auto order = std::make_shared<Order>();
    order->plan = plan_render(*frame.scene, frame.settings, frame.camera);
    order->camera = Camera(order->plan.camera, frame.width, frame.height);
    order->frame = std::move(frame);
    if (!order->plan.stochastic()) order->frame.spp = 1;
    State& s = *state_;
    std::shared_ptr<const Order> old;  // freed outside the lock: it may hold the last reference to a scene
    std::uint64_t generation = 0;
    {
        const std::lock_guard lock(s.mutex);
        generation = ++s.generation;
        order->generation = generation;
        old = std::exchange(s.order, order);
        s.counts = RayCounts();
        s.run_clock(false);
        s.seconds_before = 0.0;
        s.run_clock(!s.paused);
    }
    s.work.notify_all();
    return generation;
}

bool Renderer::replace_accelerator(std::uint64_t generation, std::shared_ptr<const AnyAccelerator> accelerator) {
    std::shared_ptr<const Order> old;  // freed outside the lock
    std::unique_lock lock(state_->mutex);
    old = state_->order;
    if (old == nullptr || old->generation != generation) return false;
    lock.unlock();
    auto order = std::make_shared<Order>(*old);
    order->frame.accelerator = std::move(accelerator);
    lock.lock();
    // Tiles in progress end with the accelerator they began with; their results count as ever.
    if (state_->order == old) state_->order = std::move(order);
    return order == nullptr;
}

void Renderer::set_paused(bool paused) {
    {
        const std::lock_guard lock(state_->mutex);
        state_->paused = paused;
        state_->run_clock(!paused && state_->order != nullptr && !state_->finished());
    }
    state_->work.notify_all();
}

Progress Renderer::progress() const {
    const State& s = *state_;
    const std::lock_guard lock(s.mutex);
    Progress p;
    p.seconds = s.seconds();
    p.rays = s.counts;
    if (s.order == nullptr) return p;
    p.generation = s.order->generation;
    p.out_of_memory = s.failed();
    if (s.queue_generation != s.order->generation || p.out_of_memory) return p;
    p.finished = s.finished();
    p.preview_complete = s.covered();
    p.spp_min = s.order->frame.spp;
    for (std::size_t i = 0; i < s.framebuffer->tile_count(); ++i) {
        const int n = s.framebuffer->samples(i, p.generation);
        p.spp_min = std::min(p.spp_min, n);
        p.spp_max = std::max(p.spp_max, n);
    }
    if (!s.preview) p.preview_complete = p.spp_min > 0;
    return p;
}

double Renderer::relative_standard_error() const {
    const State& s = *state_;
    const std::lock_guard lock(s.mutex);
    return s.framebuffer != nullptr ? s.framebuffer->relative_standard_error(s.order->generation) : 0.0;
}

bool Renderer::resolve(Image& image) const {
    const State& s = *state_;
    std::unique_lock lock(s.mutex);
    if (s.order == nullptr || s.queue_generation != s.order->generation || !s.covered() || s.failed()) return false;
    const std::uint64_t shown = s.order->generation;
    const std::shared_ptr<const Framebuffer> framebuffer = s.framebuffer;
    lock.unlock();
    image.width = framebuffer->area().x1 - framebuffer->area().x0;
    image.height = framebuffer->area().y1 - framebuffer->area().y0;
    image.pixels.assign(framebuffer->area().pixels(), glm::vec3(0.0f));
    // One short lock a tile, so that workers merging theirs hardly wait.
    for (std::size_t i = 0; i < framebuffer->tile_count(); ++i) {
        lock.lock();
        framebuffer->resolve(i, shown, image);
        lock.unlock();
    }
    return s.generation.load() == shown;
}

int Renderer::resolve_pass(Image& image) const {
    const State& s = *state_;
    const std::lock_guard lock(s.mutex);
    if (s.order == nullptr || s.queue_generation != s.order->generation || s.failed()) return 0;
    return s.framebuffer->resolve_pass(s.order->generation, image);
}

void Renderer::wait(double deadline_seconds, const std::atomic<bool>* stop) const {
    const State& s = *state_;
    std::unique_lock lock(s.mutex);
    while (!s.finished() && !s.failed() && s.seconds() < deadline_seconds && !(stop != nullptr && stop->load())) {
        // Signals only set a flag, so it is looked at a few dozen times a second.
        s.change.wait_for(lock, std::chrono::milliseconds(20));
    }
}

}  // namespace glint
