// Random numbers for tests: a seeded stream, the same on every machine (the standard library's distributions are not).
// Knows no scene.
#pragma once

#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

namespace glint {

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 1) {}

    // SplitMix64 (Steele, Lea & Flood 2014).
    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(bits() % n); }
    // In [0, 1).
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    float uniform(float lo, float hi) { return static_cast<float>(lo + (static_cast<double>(hi) - lo) * uniform()); }
    // Between 10^lo and 10^hi, every decade as likely.
    float power_of_ten(float lo, float hi) { return static_cast<float>(std::pow(10.0, lo + (hi - lo) * uniform())); }

    glm::dvec3 unit() {
        const double z = 2.0 * uniform() - 1.0, phi = 6.283185307179586 * uniform(), r = std::sqrt(1.0 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    glm::vec3 direction() { return glm::vec3(unit()); }
    // In the cube [lo, hi)^3.
    glm::vec3 in_cube(float lo, float hi) {
        const float x = uniform(lo, hi), y = uniform(lo, hi);
        return {x, y, uniform(lo, hi)};
    }

private:
    std::uint64_t state_;
};

}  // namespace glint
