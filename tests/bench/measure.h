// Time: rounds in which every competitor traces the same rays once, and builds one after the other.
// Knows no scene or table. Seconds are of the wall clock, or, on a machine shared with others, of the processor's.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "competitor.h"
#include "spread.h"

namespace glint::bench {

enum class Clock { wall, cpu };

struct Rates {
    std::string name;  // of the competitor, which the rates outlive
    Competitor::Role role;
    std::vector<double> mrays;  // per second, by round
};
// The order rotates from round to round, so that nobody always follows the same neighbour.
[[nodiscard]] std::vector<Rates> race(const Competitors& competitors, const RaySet& set, int threads, int rounds, Clock clock);

struct Build {
    std::string name;
    int threads = 1;
    std::vector<double> seconds;  // by round
    std::size_t bytes = 0;        // what traversal needs beyond the geometry itself
};
[[nodiscard]] std::vector<Build> race_builds(const std::shared_ptr<const Geometry>& geometry, bool with_grid, int rounds);

}  // namespace glint::bench
