// Whether the measured answers are right: glint's among themselves and against brute force to the bit, Embree's nearly.
// Knows no clock. Invariant: `failed` counts only what glint promises; peers may differ and are merely counted.
#pragma once

#include <string>
#include <vector>

#include "competitor.h"

namespace glint::bench {

struct Check {
    std::string set;
    std::size_t rays = 0, hits = 0;
    std::size_t paths_differ = 0;                         // any glint path against its one-ray BVH
    std::size_t sampled = 0, brute_force_differs = 0;     // rays asked of brute force
    std::size_t peer_hit_or_miss = 0, peer_distance = 0;  // Embree robust: other verdict; other primitive beyond 1e-4 of t
    [[nodiscard]] std::size_t failed() const { return paths_differ + brute_force_differs; }
};

// Needs one bvh_single among the competitors; embree_robust is optional.
[[nodiscard]] Check check(const Competitors& competitors, const RaySet& set, const BruteForce& brute_force,
                          std::size_t primitives);

}  // namespace glint::bench
