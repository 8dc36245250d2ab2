#include "core/mountain.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include <glm/gtc/constants.hpp>

#include "core/rotation.h"

namespace glint {
namespace {

// A Gaussian deviate by the polar method (Marsaglia & Bray 1964) from SPD's own linear congruence.
double gaussian(std::uint32_t seed) {
    constexpr std::uint32_t kModulus = 134456;
    const auto next = [](std::uint32_t s) { return (28411 + 8121 * s) % kModulus; };
    std::uint32_t q = seed;
    for (;;) {
        const std::uint32_t p = next(q);
        q = next(p);
        const double v1 = 2.0 * p / kModulus - 1.0, v2 = 2.0 * q / kModulus - 1.0;
        const double r = v1 * v1 + v2 * v2;
        if (r < 1.0 && r > 0.0) return v1 * std::sqrt(-2.0 * std::log(r) / r);
    }
}

// Midpoint displacement on an integer lattice. Neighbouring cells displace a shared point by the same amount,
// because the deviate depends on the point alone; so the surface has no cracks and vertices can be shared.
class Terrain {
public:
    explicit Terrain(int level) : level_(level), cells_(1u << level) {
        constexpr double kDimension = 2.2;
        const double ratio = 2.0 / std::pow(2.0, 1.0 / (kDimension - 1.0));
        roughness_ = std::sqrt(ratio * ratio - 1.0);
        const std::size_t side = cells_ + 1;
        mountain_.vertices.resize(side * side);
        mountain_.triangles.reserve(2 * std::size_t{cells_} * cells_);
    }

    Mountain raise() {
        divide(cells_, 0, 0, {});
        return std::move(mountain_);
    }

private:
    struct Corners {
        double lower_left = 0.0, lower_right = 0.0, upper_right = 0.0, upper_left = 0.0;
    };

    [[nodiscard]] double deviate(std::uint32_t a, std::uint32_t b) const {
        constexpr std::uint32_t kMountain = 21;  // which of SPD's mountains
        const std::uint32_t hash = (a << (23 - level_)) + (b << (15 - level_)) + (a << (7 - level_));
        return gaussian(kMountain + (hash & 0xffffu));
    }

    std::uint32_t put(std::uint32_t x, std::uint32_t y, double height) {
        const std::uint32_t index = y * (cells_ + 1) + x;
        const double step = 2.0 / cells_;
        mountain_.vertices[index] = glm::vec3(glm::dvec3(x * step - 1.0, y * step - 1.0, height));
        return index;
    }

    void divide(std::uint32_t width, std::uint32_t x, std::uint32_t y, const Corners& c) {
        if (width == 1) {
            const std::uint32_t ll = put(x, y, c.lower_left), lr = put(x + 1, y, c.lower_right);
            const std::uint32_t ur = put(x + 1, y + 1, c.upper_right), ul = put(x, y + 1, c.upper_left);
            mountain_.triangles.push_back({ll, lr, ur});
            mountain_.triangles.push_back({ur, ul, ll});
            return;
        }
        const std::uint32_t h = width / 2;
        const double rise = h * 2.0 / cells_ * roughness_;
        const double lower = (c.lower_left + c.lower_right) / 2.0 + rise * deviate(x + h, y);
        const double right = (c.lower_right + c.upper_right) / 2.0 + rise * deviate(x + width, y + h);
        const double upper = (c.upper_right + c.upper_left) / 2.0 + rise * deviate(x + h, y + width);
        const double left = (c.upper_left + c.lower_left) / 2.0 + rise * deviate(x, y + h);
        // The root of 2 as SPD writes it: with more digits some heights differ in the last place that the files print.
        constexpr double kDiagonal = 1.4142136;
        const double middle =
            (c.lower_left + c.lower_right + c.upper_right + c.upper_left) / 4.0 + kDiagonal * rise * deviate(x + h, y + h);
        divide(h, x, y, {c.lower_left, lower, middle, left});
        divide(h, x + h, y, {lower, c.lower_right, right, middle});
        divide(h, x + h, y + h, {middle, right, c.upper_right, upper});
        divide(h, x, y + h, {left, middle, upper, c.upper_left});
    }

    int level_;
    std::uint32_t cells_;
    double roughness_ = 0.0;
    Mountain mountain_;
};

}  // namespace

Mountain fractal_mountain(int level) {
    assert(level >= 1 && level <= kMaxMountainLevel);
    return Terrain(level).raise();
}

std::array<Sphere, 4> mountain_balls() {
    const glm::dvec3 center(-0.8, 0.8, 1.0);
    const double k = 1.0 / std::sqrt(2.0);
    const glm::dvec3 top(0.0, 0.0, 0.17 * std::sqrt(1.5));
    // The corners of a regular tetrahedron see each other under acos(-1/3) from its centre.
    const glm::dvec3 low = rotation_about(glm::dvec3(k, k, 0.0), std::acos(-1.0 / 3.0)) * top;
    std::array<Sphere, 4> balls;
    balls[0] = {glm::vec3(center + top), 0.17f};
    for (std::size_t i = 0; i < 3; ++i) {
        const double turn = static_cast<double>(i) * glm::two_pi<double>() / 3.0;
        const glm::dvec3 offset = rotation_about(glm::dvec3(0.0, 0.0, 1.0), turn) * low;
        balls[i + 1] = {glm::vec3(center + offset), static_cast<float>(0.169 - 0.001 * static_cast<double>(i))};
    }
    return balls;
}

}  // namespace glint
