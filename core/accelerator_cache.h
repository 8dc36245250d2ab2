// Accelerators of one scene, each built at most once, in the background, on several threads; for an impatient caller first a
// fast one.
// Knows no renderer. Invariants: request() never waits for a build; the destructor waits no longer than one task of it.
#pragma once

#include <array>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "core/accelerator_choice.h"

namespace glint {

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
    std::shared_ptr<const AnyAccelerator> request(AcceleratorChoice choice);
    // As request(), but where a tree of quality takes long to build there is a fast one before it. Once `may_improve`, the better
    // one is built, too, and comes in its place when it is ready: ask again.
    std::shared_ptr<const AnyAccelerator> request_best_so_far(AcceleratorKind kind, bool may_improve);
    // As request(), but waits. Throws SceneError when the scene is too large for this accelerator or for the memory.
    std::shared_ptr<const AnyAccelerator> wait(AcceleratorChoice choice);
    // Seconds the build took; 0 while not built.
    [[nodiscard]] double build_seconds(AcceleratorChoice choice) const;
    // True when the build ended without a result: request() will stay null.
    [[nodiscard]] bool failed(AcceleratorChoice choice) const;

private:
    struct Slot {
        std::shared_ptr<const AnyAccelerator> accelerator;
        double seconds = 0.0;
        bool started = false;
        std::string failure;  // why there will be no accelerator; empty while there may
        std::jthread builder;
    };
    void build(Slot& slot, AcceleratorChoice choice, const std::stop_token& stop);

    // What is there of this choice: a tree of quality is one for a first look, too. The lock is held.
    [[nodiscard]] std::shared_ptr<const AnyAccelerator> built(AcceleratorChoice choice) const;

    std::shared_ptr<const Scene> scene_;
    int threads_;
    BuildPriority priority_;
    mutable std::mutex mutex_;
    std::condition_variable built_;
    std::array<Slot, kAcceleratorChoices.size()> slots_;
};

}  // namespace glint
