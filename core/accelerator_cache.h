// Accelerators of one scene, each built at most once, in the background.
// Knows no renderer. Invariant: request() never waits for a build.
#pragma once

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "accel/accelerator.h"
#include "core/scene.h"

namespace glint {

// The accelerator `auto` means for this scene: none for a handful of primitives, else the BVH.
[[nodiscard]] AcceleratorKind automatic_accelerator(const Scene& scene);

class AcceleratorCache {
public:
    explicit AcceleratorCache(std::shared_ptr<const Scene> scene);
    ~AcceleratorCache();
    AcceleratorCache(const AcceleratorCache&) = delete;
    AcceleratorCache& operator=(const AcceleratorCache&) = delete;

    // The accelerator if it is built; otherwise null, and its build has been started.
    std::shared_ptr<const AnyAccelerator> request(AcceleratorKind kind);
    // As request(), but waits. Throws std::bad_alloc when the build ran out of memory.
    std::shared_ptr<const AnyAccelerator> wait(AcceleratorKind kind);
    // Seconds the build took; 0 while not built.
    [[nodiscard]] double build_seconds(AcceleratorKind kind) const;
    // True when the build ended without memory: request() will stay null.
    [[nodiscard]] bool failed(AcceleratorKind kind) const;

private:
    struct Slot {
        std::shared_ptr<const AnyAccelerator> accelerator;
        double seconds = 0.0;
        bool started = false, failed = false;
        std::jthread builder;
    };
    std::shared_ptr<const Scene> scene_;
    mutable std::mutex mutex_;
    std::condition_variable built_;
    std::array<Slot, kAcceleratorNames.size()> slots_;
};

}  // namespace glint
