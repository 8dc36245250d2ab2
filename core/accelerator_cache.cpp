#include "core/accelerator_cache.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/threads.h"

namespace glint {
namespace {

// Nanoseconds, from kernels and renders of the built-in and the paper's scenes on Zen 4; only their ratios matter here.
struct Costs {
    double build, build_primitive;  // once, and for each primitive
    double ray, ray_doubling;       // for each ray, and for each doubling of the blocks of eight
};
constexpr Costs kGrid{6.0e4, 1700.0, 60.0, 20.0};
constexpr Costs kBvh{3.0e4, 500.0, 30.0, 10.0};
// Of the loop: a query, and a test by kind of primitive (triangle, sphere, box, cone).
constexpr double kLoopQuery = 20.0;
constexpr std::array<double, 4> kLoopTest{30.0, 13.0, 20.0, 40.0};

double seconds(const Costs& c, double primitives, double rays) {
    const double build = c.build + c.build_primitive * primitives;
    return 1.0e-9 * (build + rays * (c.ray + c.ray_doubling * std::log2(1.0 + primitives / 8.0)));
}

}  // namespace

RayDemand expected_rays(const Scene& scene, int width, int height, int samples_per_pixel) {
    bool branches = false;
    for (const Material& m : scene.materials) branches = branches || m.glass || m.has_mirror();
    const double a_sample = (branches ? 2.0 : 1.0) * (1.0 + static_cast<double>(scene.lights.size()));
    return {static_cast<double>(width) * height * samples_per_pixel * a_sample};
}

std::array<double, kAcceleratorNames.size()> estimated_seconds(const Geometry& geometry, const RayDemand& demand) {
    const auto primitives = static_cast<double>(geometry.bounded_count());
    double loop = kLoopQuery;
    for (std::size_t kind = 0; kind < kLoopTest.size(); ++kind) {
        loop += kLoopTest[kind] * static_cast<double>(geometry.count(static_cast<PrimitiveKind>(kind)));
    }
    return {1.0e-9 * demand.rays * loop, seconds(kGrid, primitives, demand.rays), seconds(kBvh, primitives, demand.rays)};
}

AcceleratorKind automatic_accelerator(const Scene& scene, const RayDemand& demand) {
    const auto estimate = estimated_seconds(*scene.geometry, demand);
    return static_cast<AcceleratorKind>(std::min_element(estimate.begin(), estimate.end()) - estimate.begin());
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
