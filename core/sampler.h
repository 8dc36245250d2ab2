// Random numbers as a function, not a stream: sample `index` of a pixel is a pure function of (pixel, index, dimension, seed).
// Knows neither what a dimension is used for nor how many samples there will be.
// Invariant: values lie in [0, 1); any two dimensions of a pixel are independently scrambled.
#pragma once

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

    // Sample `index` of the same pixel, where both are below 2^32.
    [[nodiscard]] Sampler at(std::uint32_t index) const {
        Sampler other = *this;
        other.index_ = index;
        return other;
    }

    // A point of the unit square for `dimension`, a name such as hash(path, purpose).
    [[nodiscard]] glm::vec2 square(std::uint32_t dimension) const noexcept;
    // square() of this sample and the kRun - 1 that follow, for less than one by one.
    static constexpr int kRun = 8;
    void squares(std::uint32_t dimension, float* x, float* y) const noexcept;
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
