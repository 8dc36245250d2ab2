#include "core/accelerator_cache.h"

#include <chrono>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/threads.h"

namespace glint {
namespace {

// Up to here a loop needs no build and is no slower than a tree: the paper's dof (9 primitives) takes 0.125 s without and
// 0.143 s with one, balls_low (12) 0.190 and 0.197 s. A cost model may refine it.
constexpr std::size_t kFewPrimitives = 8;

}  // namespace

AcceleratorKind automatic_accelerator(const Scene& scene) {
    return scene.geometry->bounded_count() <= kFewPrimitives ? AcceleratorKind::none : AcceleratorKind::bvh;
}

AcceleratorCache::AcceleratorCache(std::shared_ptr<const Scene> scene, int threads, BuildPriority priority)
    : scene_(std::move(scene)), threads_(threads), priority_(priority) {}

AcceleratorCache::~AcceleratorCache() {
    // All are told before the first is waited for.
    for (Slot& slot : slots_) slot.builder.request_stop();
}

std::shared_ptr<const AnyAccelerator> AcceleratorCache::request(AcceleratorKind kind) {
    const std::lock_guard lock(mutex_);
    Slot& slot = slots_[static_cast<std::size_t>(kind)];
    if (slot.started) return slot.accelerator;
    slot.started = true;
    try {
        slot.builder = std::jthread([this, &slot, kind](const std::stop_token& stop) { build(slot, kind, stop); });
    } catch (const std::system_error&) {
        // Without this nobody would ever answer those who wait.
        slot.failure = "no thread can be started";
    }
    return nullptr;
}

void AcceleratorCache::build(Slot& slot, AcceleratorKind kind, const std::stop_token& stop) {
    if (priority_ == BuildPriority::background) lower_priority();
    const auto start = std::chrono::steady_clock::now();
    std::shared_ptr<const AnyAccelerator> built;
    const char* failure = "";
    try {
        built = build_accelerator(kind, scene_->geometry, parallel_for_on(threads_, stop));
    } catch (const std::bad_alloc&) {
        failure = "not enough memory";
    } catch (const std::length_error&) {
        failure = "too many primitives";
    } catch (const Abandoned&) {
        failure = "abandoned";
    } catch (const std::runtime_error&) {
        // oneTBB's complaint when the system refuses it a thread.
        failure = "no thread can be started";
    }
    const std::lock_guard lock(mutex_);
    slot.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slot.failure = failure;
    slot.accelerator = std::move(built);
    built_.notify_all();
}

std::shared_ptr<const AnyAccelerator> AcceleratorCache::wait(AcceleratorKind kind) {
    if (auto ready = request(kind)) return ready;
    std::unique_lock lock(mutex_);
    Slot& slot = slots_[static_cast<std::size_t>(kind)];
    built_.wait(lock, [&] { return slot.accelerator != nullptr || !slot.failure.empty(); });
    if (slot.failure.empty()) return slot.accelerator;
    throw SceneError(
        fmt::format("{}: no accelerator {}: {}", scene_->name, kAcceleratorNames[static_cast<std::size_t>(kind)], slot.failure));
}

double AcceleratorCache::build_seconds(AcceleratorKind kind) const {
    const std::lock_guard lock(mutex_);
    return slots_[static_cast<std::size_t>(kind)].seconds;
}

bool AcceleratorCache::failed(AcceleratorKind kind) const {
    const std::lock_guard lock(mutex_);
    return !slots_[static_cast<std::size_t>(kind)].failure.empty();
}

}  // namespace glint
