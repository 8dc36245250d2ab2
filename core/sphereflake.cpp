#include "core/sphereflake.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include <glm/gtc/constants.hpp>

#include "core/rotation.h"

namespace glint {
namespace {

using Directions = std::array<glm::dvec3, 9>;

// Where the nine children sit on a parent that grows along +z: three above its equator, six on it.
Directions child_directions() {
    const double k = 1.0 / std::sqrt(2.0);
    const std::array<glm::dvec3, 3> trio{glm::dvec3(k, k, 0.0), glm::dvec3(k, 0.0, -k), glm::dvec3(0.0, k, -k)};
    const glm::dmat3 tilt = rotation_about(glm::dvec3(k, -k, 0.0), std::asin(2.0 / std::sqrt(6.0)));
    Directions directions;
    for (std::size_t j = 0; j < 3; ++j) {
        const glm::dmat3 turn = rotation_about(glm::dvec3(0.0, 0.0, 1.0), static_cast<double>(j) * glm::two_pi<double>() / 3.0);
        for (std::size_t i = 0; i < 3; ++i) directions[3 * j + i] = turn * (tilt * trio[i]);
    }
    return directions;
}

// Takes +z to `u`. Near the poles the axis of rotation is undefined, and SPD's own thresholds pick the case.
glm::dmat3 rotation_from_z(glm::dvec3 u) {
    if (u.z >= 0.9999) return glm::dmat3(1.0);
    if (u.z <= -0.9999) return rotation_about(glm::dvec3(0.0, 1.0, 0.0), glm::pi<double>());
    return rotation_about(glm::normalize(glm::cross(glm::dvec3(0.0, 0.0, 1.0), u)), std::acos(u.z));
}

struct Flake {
    Directions directions = child_directions();
    std::vector<Sphere> spheres;

    void grow(int level, glm::dvec3 center, double radius, glm::dvec3 up) {
        spheres.push_back({glm::vec3(center), static_cast<float>(radius)});
        if (level == 0) return;
        const glm::dmat3 rotation = rotation_from_z(up);
        const double child_radius = radius / 3.0;
        for (const glm::dvec3& direction : directions) {
            const glm::dvec3 outward = rotation * direction;
            grow(level - 1, center + outward * (radius + child_radius), child_radius, outward);
        }
    }
};

}  // namespace

std::vector<Sphere> sphereflake(int level) {
    assert(level >= 0 && level <= kMaxSphereflakeLevel);
    Flake flake;
    std::size_t count = 1;
    for (int i = 0; i < level; ++i) count = 9 * count + 1;
    flake.spheres.reserve(count);
    flake.grow(level, glm::dvec3(0.0), 0.5, glm::dvec3(0.0, 0.0, 1.0));
    return std::move(flake.spheres);
}

}  // namespace glint
