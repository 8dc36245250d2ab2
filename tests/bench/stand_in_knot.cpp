#include "stand_in_knot.h"

#include <cmath>
#include <numbers>

namespace glint::bench {
namespace {

constexpr double kTube = 0.26;

glm::dvec3 curve(double t) {
    const double r = 1.0 + 0.45 * std::cos(3.0 * t);
    return {r * std::cos(2.0 * t), 0.45 * std::sin(3.0 * t), r * std::sin(2.0 * t)};
}

// Ripples of falling size, each a product of sines turned against the one before: rough like a scan, and smooth to index.
double relief(glm::dvec3 p) {
    double height = 0.0, size = 0.03, frequency = 9.0;
    for (int octave = 0; octave < 6; ++octave) {
        const glm::dvec3 q = frequency * glm::dvec3(p.x + 0.31 * p.y, p.y - 0.47 * p.z, p.z + 0.23 * p.x);
        height += size * std::sin(q.x + std::sin(q.y)) * std::sin(q.y + octave) * std::cos(q.z - std::sin(q.x));
        size *= 0.55;
        frequency *= 2.1;
    }
    return height;
}

}  // namespace

std::shared_ptr<const Scene> stand_in_knot(std::size_t triangles) {
    const auto around = static_cast<std::uint32_t>(std::max(3.0, std::sqrt(static_cast<double>(triangles) / 12.0)));
    const auto along = static_cast<std::uint32_t>(std::max<std::size_t>(3, triangles / 2 / around));
    SceneBuilder builder;
    builder.scene().name = "stand-in knot";
    builder.scene().cameras.emplace_back();
    const std::uint32_t material = builder.add_material({});
    for (std::uint32_t i = 0; i < along; ++i) {
        const double t = 2.0 * std::numbers::pi * i / along;
        const glm::dvec3 c = curve(t), tangent = glm::normalize(curve(t + 1e-4) - curve(t - 1e-4));
        const glm::dvec3 n = glm::normalize(glm::cross(tangent, c)), b = glm::cross(tangent, n);
        for (std::uint32_t j = 0; j < around; ++j) {
            const double a = 2.0 * std::numbers::pi * j / around;
            const glm::dvec3 out = std::cos(a) * n + std::sin(a) * b;
            builder.add_vertex(glm::vec3(c + (kTube + relief(c + kTube * out)) * out));
        }
    }
    for (std::uint32_t i = 0; i < along; ++i) {
        for (std::uint32_t j = 0; j < around; ++j) {
            const std::uint32_t next_i = (i + 1) % along, next_j = (j + 1) % around;
            const std::uint32_t a = i * around + j, b = i * around + next_j;
            const std::uint32_t c = next_i * around + j, d = next_i * around + next_j;
            builder.add_triangle(a, c, b, material);
            builder.add_triangle(b, c, d, material);
        }
    }
    return builder.finish();
}

}  // namespace glint::bench
