// Random numbers as a function, not a stream: sample `index` of a pixel is a pure function of (pixel, index, dimension, seed).
// Knows how many samples there will be as little as what a dimension is used for, except that `joint` draws the pixel, the lens
// and the first light of camera rays from one sequence of six dimensions.
// Invariant: values lie in [0, 1); any two dimensions of a pixel are independently scrambled.
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>

#include "core/settings.h"

namespace glint {

// A bijection of 32 bits that passes avalanche tests (Ettinger's "lowbias32" by the search of Wellons 2018).
constexpr std::uint32_t hash(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}
constexpr std::uint32_t hash(std::uint32_t a, std::uint32_t b) { return hash(a ^ (hash(b) + 0x9e3779b9u + (a << 6) + (a >> 2))); }

// The strata per axis of `jittered` blocks and of the `regular` lattice.
constexpr std::uint32_t kStrata = 8;

class Sampler {
public:
    Sampler() = default;
    Sampler(SamplerKind kind, std::uint32_t x, std::uint32_t y, std::uint64_t index, std::uint64_t seed)
        : kind_(kind),
          index_(static_cast<std::uint32_t>(index)),
          pixel_(hash(hash(hash(x, y), static_cast<std::uint32_t>(seed)),
                      static_cast<std::uint32_t>(seed >> 32) ^ static_cast<std::uint32_t>(index >> 32))) {}

    // By the parts that lanes keep of it: pixel() and index().
    Sampler(SamplerKind kind, std::uint32_t pixel, std::uint32_t index) : kind_(kind), index_(index), pixel_(pixel) {}
    // What stands for the pixel and the seed, and below 2^32 samples for all samples of the pixel.
    [[nodiscard]] std::uint32_t pixel() const { return pixel_; }
    [[nodiscard]] std::uint32_t index() const { return index_; }

    // A point of the unit square for `dimension`, a name such as hash(path, purpose).
    [[nodiscard]] glm::vec2 square(std::uint32_t dimension) const noexcept;
    // square() of many samples at once, given by their pixel() and index(); all arrays are read and written up to the next
    // multiple of kRun.
    static constexpr std::size_t kRun = 8;
    static void squares(SamplerKind kind, const std::uint32_t* pixel, const std::uint32_t* index, const std::uint32_t* dimension,
                        std::size_t n, float* x, float* y) noexcept;
    // The same where all ask for one dimension.
    static void squares(SamplerKind kind, const std::uint32_t* pixel, const std::uint32_t* index, std::uint32_t dimension,
                        std::size_t n, float* x, float* y) noexcept;
    // A point of the unit interval; use another dimension than for square().
    [[nodiscard]] float interval(std::uint32_t dimension) const noexcept;

private:
    SamplerKind kind_ = SamplerKind::sobol;
    std::uint32_t index_ = 0;
    std::uint32_t pixel_ = 0;
};

// Area-preserving maps of the unit square; they keep strata together.
// Concentric map onto the unit disk (Shirley & Chiu 1997).
[[nodiscard]] glm::vec2 disk_from_square(glm::vec2 u) noexcept;
// Uniform unit vectors.
[[nodiscard]] glm::vec3 sphere_from_square(glm::vec2 u) noexcept;

}  // namespace glint
