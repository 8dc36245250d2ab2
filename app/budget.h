// When a render ends: samples, seconds or error, whichever is reached first; and what is written down at each doubling.
// Knows no files and no options. Invariant: by samples and error alone the picture is the same for any number of threads, since
// both are looked at only when the picture has all the samples asked for.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <string_view>

#include "core/renderer.h"

namespace glint {

struct Budget {
    int spp = 64;
    double seconds = std::numeric_limits<double>::infinity();
    double noise = 0.0;           // relRMSE to get below; 0 = none
    bool every_doubling = false;  // at_step is wanted at 1, 2, 4 ... samples
};

struct BudgetWatch {
    // A few times a second.
    std::function<void(const Progress&)> at_beat;
    // Whenever the picture has all the samples asked for: at the end, and at the doublings on the way where the budget has any.
    std::function<void(const Progress&, const ErrorEstimate&)> at_step;
};

// Renders the frame (its own spp is ignored) and returns what ended it: "spp", "time", "noise" or "signal", the last when *stop.
// Throws std::bad_alloc for a picture that memory does not suffice for.
[[nodiscard]] std::string_view render_within(Renderer& renderer, Frame frame, const Budget& budget, const std::atomic<bool>& stop,
                                             const BudgetWatch& watch);

}  // namespace glint
