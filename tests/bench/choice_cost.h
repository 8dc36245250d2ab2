// What each accelerator costs for a picture: building it and rendering with it, on one thread.
// Knows the renderer's kernels; not which accelerator `auto` takes. Seconds are of the thread's processor, beside them the
// wall's. A picture is measured on a sample of its tiles and of their visits, the same for everyone, and scaled up.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/accelerator_choice.h"

namespace glint::bench {

struct Demand {
    int width, height, spp;
};

// One candidate, round by round.
struct CandidateCost {
    std::vector<double> build, trace, wall;  // wall: of both together
    double build_serial = 0.0;               // the part of `build` outside the loops that threads share, of the last round
};

struct DemandCost {
    Demand demand;
    double rays = 0.0;                                         // of all kinds, in the whole picture
    double sampled = 1.0;                                      // the part of the picture that was traced
    std::array<CandidateCost, kAcceleratorChoices.size()> by;  // in the order of kAcceleratorChoices
    bool brute_force_sampled = false;                          // brute force saw fewer tiles than the others
};

struct Effort {
    int rounds = 9;
    double samples = 24000.0;  // about as many a round and candidate
};

[[nodiscard]] std::vector<DemandCost> measure_demands(const std::shared_ptr<const Scene>& scene,
                                                      const std::vector<Demand>& demands, const Effort& effort);

}  // namespace glint::bench
