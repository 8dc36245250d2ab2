// Adaptive sampling: which tiles have their samples doubled next, so that each second takes as much of the picture's error away
// as it can. Knows no renderer, pixel or thread. Invariant: decides by the tiles' own sums alone, and those by their samples, so
// the map of samples is a function of the frame and of the mean that is asked for; on the way to a mean every smaller power of
// two is passed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/error_estimate.h"

namespace glint {

struct TileState {
    int samples = 0;  // a pixel
    std::size_t pixels = 0;
    double change = 0.0, change_before = 0.0;  // of the last two doublings, summed over pixels (Doubling::fresh)
    std::uint64_t work = 0;                    // RayCounts::work() so far
};

// Every tile takes so many before any is preferred, and later an eighth of the mean: what is rare has to have its chance, and two
// halves that both missed it agree (Kirk & Arvo 1991). A power of two.
constexpr int kUniformSamples = 8;
constexpr int kMostBehind = 8;

// The tiles whose samples go on to the next power of two now, none while others are under way, for a mean of at most `spp`
// samples a pixel. Empty when there is no room for any more: the picture is done.
[[nodiscard]] std::vector<std::size_t> tiles_to_double(std::span<const TileState> tiles, int spp);

// Where they go on to.
[[nodiscard]] int doubled(int samples);

// Pixels with the same number of samples, as adaptive sampling leaves them.
struct Stratum {
    int spp = 0;  // a power of two
    std::size_t pixels = 0;
    Doublings doublings{};  // summed over them
};
// For all of them together; `spp`: their mean. Errors of the estimates count as if they were all in the same direction.
[[nodiscard]] ErrorEstimate estimate_error(std::span<const Stratum> strata, int spp, Randomness random);

}  // namespace glint
