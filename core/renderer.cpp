#include "core/renderer.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <utility>

#include "core/renderer_state.h"
#include "core/threads.h"

namespace glint {

Renderer::Renderer(int threads, bool preview, bool pinned) : state_(std::make_unique<State>(preview)) {
    workers_.reserve(static_cast<std::size_t>(std::max(1, threads)));
    // Woken together, workers may start on one processor and wait for each other there until the system notices.
    const bool one_each = pinned || threads == usable_processors();
    for (int i = 0; i < std::max(1, threads); ++i) {
        try {
            workers_.emplace_back([this, one_each, i] {
                if (one_each) pin_to_processor(i);
                state_->run_worker();
            });
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

bool Renderer::extend(std::uint64_t generation, int spp) {
    State& s = *state_;
    std::shared_ptr<const Order> old;  // freed outside the lock
    {
        const std::lock_guard lock(s.mutex);
        if (s.order == nullptr || s.order->generation != generation || s.failed()) return false;
        old = s.order;
        if (spp <= old->frame.spp || !old->plan.stochastic()) return true;
        auto longer = std::make_shared<Order>(*old);
        longer->frame.spp = spp;
        s.order = std::move(longer);
        s.take_up_again(old->frame.spp);
        s.run_clock(!s.paused);
    }
    s.work.notify_all();
    return true;
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
    p.spp_min = s.least_samples_so_far();
    for (std::size_t i = 0; i < s.framebuffer->tile_count(); ++i)
        p.spp_max = std::max(p.spp_max, s.framebuffer->samples(i, p.generation));
    p.spp = s.samples_so_far();
    if (!s.preview) p.preview_complete = p.spp_min > 0;
    return p;
}

ErrorEstimate Renderer::error() const {
    const State& s = *state_;
    std::unique_lock lock(s.mutex);
    ErrorEstimate e;
    if (s.order == nullptr || s.queue_generation != s.order->generation || s.failed()) return e;
    const std::shared_ptr<const Order> order = s.order;
    const int samples = s.samples_so_far();
    if (!order->plan.stochastic()) {
        if (samples > 0) e.kind = ErrorEstimate::Kind::exact;
        e.spp = samples;
        return e;
    }
    if (s.adaptive()) {
        const std::vector<Stratum> strata = s.framebuffer->strata(order->generation);
        lock.unlock();
        return estimate_error(strata, samples, {order->plan.sampler, order->plan.one_square()});
    }
    const Doublings doublings = s.framebuffer->doublings(order->generation, samples);
    const std::size_t pixels = s.framebuffer->area().pixels();
    lock.unlock();
    return estimate_error(doublings, pixels, samples, {order->plan.sampler, order->plan.one_square()});
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
