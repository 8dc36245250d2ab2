// Accelerators of one scene, each built at most once, in the background, on several threads.
// Knows no renderer. Invariants: request() never waits for a build; the destructor waits no longer than one task of it.
#pragma once

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "accel/accelerator.h"
#include "core/scene.h"

namespace glint {

// What a picture asks of an accelerator: rays of all kinds.
struct RayDemand {
    double rays = 1.0e6;
};
// Samples times what a sample asks for: its camera ray, then a shadow ray to each light; mirrors and glass double it.
[[nodiscard]] RayDemand expected_rays(const Scene& scene, int width, int height, int samples_per_pixel);

// Seconds of one thread for building and asking, by kind, from counts of primitives; constants measured (core/README.md).
[[nodiscard]] std::array<double, kAcceleratorNames.size()> estimated_seconds(const Geometry& geometry, const RayDemand& demand);

// The accelerator `auto` means: the one of the least estimate.
[[nodiscard]] AcceleratorKind automatic_accelerator(const Scene& scene, const RayDemand& demand = {});

// Who else wants the cores while something is built.
enum class BuildPriority { normal, background };

class AcceleratorCache {
public:
    // threads: that a build may use, those that wait for it not counted. background: they yield to other threads.
    explicit AcceleratorCache(std::shared_ptr<const Scene> scene, int threads = 1,
                              BuildPriority priority = BuildPriority::normal);
    ~AcceleratorCache();
    AcceleratorCache(const AcceleratorCache&) = delete;
    AcceleratorCache& operator=(const AcceleratorCache&) = delete;

    // The accelerator if it is built; otherwise null, and its build has been started.
    std::shared_ptr<const AnyAccelerator> request(AcceleratorKind kind);
    // As request(), but waits. Throws SceneError when the scene is too large for this accelerator or for the memory.
    std::shared_ptr<const AnyAccelerator> wait(AcceleratorKind kind);
    // Seconds the build took; 0 while not built.
    [[nodiscard]] double build_seconds(AcceleratorKind kind) const;
    // True when the build ended without a result: request() will stay null.
    [[nodiscard]] bool failed(AcceleratorKind kind) const;

private:
    struct Slot {
        std::shared_ptr<const AnyAccelerator> accelerator;
        double seconds = 0.0;
        bool started = false;
        std::string failure;  // why there will be no accelerator; empty while there may
        std::jthread builder;
    };
    void build(Slot& slot, AcceleratorKind kind, const std::stop_token& stop);

    std::shared_ptr<const Scene> scene_;
    int threads_;
    BuildPriority priority_;
    mutable std::mutex mutex_;
    std::condition_variable built_;
    std::array<Slot, kAcceleratorNames.size()> slots_;
};

}  // namespace glint
