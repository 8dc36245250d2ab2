#include "core/accelerator_cache.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/threads.h"

namespace glint {
namespace {

constexpr AcceleratorChoice kFast{AcceleratorKind::bvh, BuildQuality::fast};
// Builds shorter than this are not worth a first look: fast trees take about half as long, and 50 ms more is not seen.
constexpr double kFirstLookSeconds = 0.1;

std::size_t index_of(AcceleratorChoice choice) {
    return static_cast<std::size_t>(std::ranges::find(kAcceleratorChoices, choice) - kAcceleratorChoices.begin());
}

}  // namespace

std::shared_ptr<const AnyAccelerator> AcceleratorCache::built(AcceleratorChoice choice) const {
    if (choice == kFast && slots_[index_of(AcceleratorKind::bvh)].accelerator) choice = AcceleratorKind::bvh;
    return slots_[index_of(choice)].accelerator;
}

AcceleratorCache::AcceleratorCache(std::shared_ptr<const Scene> scene, int threads, BuildPriority priority)
    : scene_(std::move(scene)), threads_(threads), priority_(priority) {}

AcceleratorCache::~AcceleratorCache() {
    // All are told before the first is waited for.
    for (Slot& slot : slots_) slot.builder.request_stop();
}

std::shared_ptr<const AnyAccelerator> AcceleratorCache::request(AcceleratorChoice choice) {
    const std::lock_guard lock(mutex_);
    Slot& slot = slots_[index_of(choice)];
    if (auto ready = built(choice); ready || slot.started) return ready;
    slot.started = true;
    try {
        slot.builder = std::jthread([this, &slot, choice](const std::stop_token& stop) { build(slot, choice, stop); });
    } catch (const std::system_error&) {
        // Without this nobody would ever answer those who wait.
        slot.failure = "no thread can be started";
    }
    return nullptr;
}

void AcceleratorCache::build(Slot& slot, AcceleratorChoice choice, const std::stop_token& stop) {
    if (priority_ == BuildPriority::background) lower_priority();
    const auto start = std::chrono::steady_clock::now();
    std::shared_ptr<const AnyAccelerator> made;
    const char* failure = "";
    const auto build_on = [&](int threads) {
        made = build_accelerator(choice.kind, scene_->geometry, parallel_for_on(threads, stop), choice.quality);
    };
    try {
        try {
            build_on(threads_);
        } catch (const std::runtime_error&) {
            // oneTBB's complaint when the system refuses it a thread, mostly for want of memory; alone it may go on.
            build_on(1);
        }
    } catch (const std::bad_alloc&) {
        failure = "not enough memory";
    } catch (const std::length_error&) {
        failure = "too many primitives";
    } catch (const Abandoned&) {
        failure = "abandoned";
    }
    std::shared_ptr<const AnyAccelerator> superseded;  // freed outside the lock
    const std::lock_guard lock(mutex_);
    slot.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slot.failure = failure;
    slot.accelerator = std::move(made);
    if (choice == AcceleratorKind::bvh && slot.accelerator) superseded = std::move(slots_[index_of(kFast)].accelerator);
    built_.notify_all();
}

std::shared_ptr<const AnyAccelerator> AcceleratorCache::request_best_so_far(AcceleratorKind kind, bool may_improve) {
    const auto build_alone = estimated_seconds(*scene_->geometry, {0.0, threads_});
    if (kind != AcceleratorKind::bvh || build_alone[index_of(kind)] < kFirstLookSeconds) return request(kind);
    std::shared_ptr<const AnyAccelerator> first = request(kFast);
    // One after the other: side by side they would share the cores, and the first look would wait for both.
    if (first ? !may_improve : !failed(kFast)) return first;
    std::shared_ptr<const AnyAccelerator> best = request(kind);
    return best ? best : first;
}

std::shared_ptr<const AnyAccelerator> AcceleratorCache::wait(AcceleratorChoice choice) {
    if (auto ready = request(choice)) return ready;
    std::unique_lock lock(mutex_);
    Slot& slot = slots_[index_of(choice)];
    std::shared_ptr<const AnyAccelerator> ready;
    built_.wait(lock, [&] { return (ready = built(choice)) != nullptr || !slot.failure.empty(); });
    if (ready) return ready;
    throw SceneError(fmt::format("{}: no accelerator {}: {}", scene_->name,
                                 kAcceleratorNames[static_cast<std::size_t>(choice.kind)], slot.failure));
}

double AcceleratorCache::build_seconds(AcceleratorChoice choice) const {
    const std::lock_guard lock(mutex_);
    return slots_[index_of(choice)].seconds;
}

bool AcceleratorCache::failed(AcceleratorChoice choice) const {
    const std::lock_guard lock(mutex_);
    return !slots_[index_of(choice)].failure.empty();
}

}  // namespace glint
