// How far a picture still is from its limit, told by how much each doubling of its samples has changed it; and when to stop.
// Knows no renderer and no picture, only the sums below. Errors are relRMSE: the root of relMSE, as in error_metrics.h.
// Why it works for stratified samplers too: let I(N) be a pixel's mean of N samples. Where its halves are exchangeable
// (Owen-scrambled Sobol' at powers of two, blocks of strata, independent samples), E (I(2N) - I(N))^2 = MSE(N) - MSE(2N) exactly.
// So MSE(N) is the sum of all changes still to come, which follow the power law that those seen so far have.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "core/error_metrics.h"
#include "core/settings.h"

namespace glint {

// What doubling the samples did to some pixels: sums over them of relative_change() and of its square.
struct Changes {
    double sum = 0.0, squares = 0.0;

    void add(double c) {
        sum += c;
        squares += c * c;
    }
    void operator+=(const Changes& other) {
        sum += other.sum;
        squares += other.squares;
    }
    bool operator==(const Changes&) const = default;
};

// The same changes twice: what is rare weighs too little until it has been seen often enough, and too much where one half saw it
// and the other did not. A mean of twice the samples is a better judge.
struct Doubling {
    Changes fresh;    // weighed by the means that the doubling left
    Changes settled;  // by those of the next doubling; nothing before

    void operator+=(const Doubling& other) {
        fresh += other.fresh;
        settled += other.settled;
    }
    bool operator==(const Doubling&) const = default;
};

// [k]: from 2^k samples a pixel to 2^(k+1).
constexpr std::size_t kDoublings = 31;
using Doublings = std::array<Doubling, kDoublings>;

// Doublings that lie within so many samples a pixel.
[[nodiscard]] constexpr std::size_t doublings_within(int spp) {
    return spp > 0 ? static_cast<std::size_t>(std::bit_width(static_cast<std::uint32_t>(spp))) - 1 : 0;
}

// mean over channels of change^2 / (truth^2 + kRelativeFloor), where mean^2 - hidden stands for truth^2.
[[nodiscard]] inline double relative_change(glm::dvec3 change, glm::dvec3 mean, glm::dvec3 hidden) {
    const glm::dvec3 ratio = change * change / (glm::max(mean * mean - hidden, 0.0) + kRelativeFloor);
    return (ratio.x + ratio.y + ratio.z) / 3.0;
}
// How much of mean^2 is to be taken for error, as shares of the square of the last doubling's change: none, and a spark would
// hide its own error; all of it would be unbiased, the product of the two halves' means, but too small where a half is dark by
// chance. Measured: core/README.md.
constexpr double kHiddenFresh = 0.25, kHiddenSettled = 0.5;

struct ErrorEstimate {
    enum class Kind {
        unknown,   // too few samples, or a sampler whose errors no sample tells of
        exact,     // nothing is random
        estimated  // the numbers below
    };
    Kind kind = Kind::unknown;
    int spp = 0;                   // samples a pixel that it is for
    double relrmse = 0.0;          // most likely
    double low = 0.0, high = 0.0;  // 95 % interval
    double cautious = 0.0;         // upper end at z = 2, what stopping goes by
    double slope = 0.5;            // relrmse falls as spp^-slope here,
    double slow = 0.0;             // but this share of its square goes on as 1/spp, so that the slope falls
    double spared = 1.0;           // of the samples that halving it takes by these two, adaptive sampling takes this part
};

// What is random in a picture.
struct Randomness {
    SamplerKind sampler = SamplerKind::sobol;
    bool one_square = true;  // one point of the unit square a sample; not several, for lens, lights, mirrors
};

// For a picture of `pixels` pixels, each with `spp` samples; doublings: sums over all of them, at least doublings_within(spp).
[[nodiscard]] ErrorEstimate estimate_error(std::span<const Doubling> doublings, std::size_t pixels, int spp, Randomness random);

// What the error's square is after `doublings` more of all samples, over what it is.
[[nodiscard]] double square_left(const ErrorEstimate& estimate, double doublings);

// By how many times the samples have to grow until the error is `part` of what it is.
[[nodiscard]] double times_until(const ErrorEstimate& estimate, double part);

// Nothing stops before so many samples a pixel, a power of two: what is rare has to have had its chance to show (Kirk & Arvo
// 1991), and two halves that both missed it agree.
[[nodiscard]] int least_samples(std::size_t pixels);

// Whether a picture may stop there: at a power of two and not below least_samples(), by the cautious end.
[[nodiscard]] bool error_reached(const ErrorEstimate& estimate, std::size_t pixels, double target);

// Samples a pixel at which error_reached() is to be expected; 0 where nothing is known or it would take more than 2^30.
[[nodiscard]] int predicted_samples(const ErrorEstimate& estimate, std::size_t pixels, double target);

}  // namespace glint
