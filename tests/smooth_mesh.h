// Round bodies as coarse meshes whose corners have the normals of the true surface, and the distance to that surface.
// Knows no light. Invariant: every corner lies on the surface, up to rounding, and the front faces outwards.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/scene.h"

namespace glint {

// A ball when `tube` is its radius and `ring` is 0, else a ring around the y axis: all points `tube` away from a circle.
struct RoundBody {
    double ring, tube;

    [[nodiscard]] double distance(glm::dvec3 p) const {
        const double out = std::sqrt(p.x * p.x + p.z * p.z) - ring;
        return ring > 0.0 ? std::sqrt(out * out + p.y * p.y) - tube : std::sqrt(glm::dot(p, p)) - tube;
    }
    // Of the surface's nearest point.
    [[nodiscard]] glm::dvec3 normal(glm::dvec3 p) const {
        const double out = std::sqrt(p.x * p.x + p.z * p.z);
        const glm::dvec3 from = ring > 0.0 ? ring / out * glm::dvec3(p.x, 0.0, p.z) : glm::dvec3(0.0);
        return (p - from) / std::sqrt(glm::dot(p - from, p - from));
    }
    [[nodiscard]] glm::dvec3 nearest(glm::dvec3 p) const { return p - distance(p) * normal(p); }
    // Whether the segment from a point of the surface stays outside by at least `clearance` of the way (sphere tracing, Hart
    // 1996).
    [[nodiscard]] bool sees(glm::dvec3 p, glm::dvec3 light, double clearance) const {
        const double far = glm::length(light - p);
        const glm::dvec3 d = (light - p) / far;
        if (!(glm::dot(normal(p), d) > clearance)) return false;
        for (double t = 1e-3 * tube; t < far;) {
            const double free = distance(p + t * d);
            if (!(free > std::max(clearance * t, 1e-7 * tube))) return false;
            t += free;
        }
        return true;
    }
};

// `columns` quads around the axis and `rows` across, each cut in two; a ball's end in points. `at` maps the body's coordinates.
template <class At>
void add_round_mesh(SceneBuilder& b, const RoundBody& body, int columns, int rows, std::uint32_t material, At at,
                    bool normals = true) {
    const double pi = 3.14159265358979323846;
    const bool ball = !(body.ring > 0.0);
    const std::uint32_t first = static_cast<std::uint32_t>(b.geometry().vertices.size());
    const int rings = ball ? rows + 1 : rows;
    for (int j = 0; j < rings; ++j) {
        const double theta = (ball ? 1.0 : 2.0) * pi * j / rows;
        for (int i = 0; i < columns; ++i) {
            const double phi = 2.0 * pi * i / columns;
            const glm::dvec3 outwards(std::cos(phi), 0.0, std::sin(phi));
            const glm::dvec3 n = std::sin(theta) * outwards + std::cos(theta) * glm::dvec3(0.0, 1.0, 0.0);
            b.add_vertex(at(body.ring * outwards + body.tube * n), normals ? glm::vec3(n) : glm::vec3(0.0f));
        }
    }
    const auto corner = [&](int i, int j) { return first + static_cast<std::uint32_t>(j % rings * columns + i % columns); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            if (!ball || j > 0) b.add_triangle(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), material);
            if (!ball || j + 1 < rows) b.add_triangle(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1), material);
        }
    }
}
inline void add_round_mesh(SceneBuilder& b, const RoundBody& body, int columns, int rows, std::uint32_t material) {
    add_round_mesh(b, body, columns, rows, material, [](glm::dvec3 p) { return glm::vec3(p); });
}

}  // namespace glint
