// Haines's fractal mountain and the pyramid of four glass balls that floats before it.
// Knows no scene, material or camera. Order of triangles as in the course's mount_* files; z is up, ground [-1,1]^2.
// Recipe: Eric Haines, Standard Procedural Databases 3.14 (public domain), `mount`, with its original (faulty) hash.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/geometry.h"

namespace glint {

constexpr int kMaxMountainLevel = 7;  // the recipe's hash shifts by 7 - level bits and is undefined beyond

struct Mountain {
    std::vector<glm::vec3> vertices;                      // a lattice of (2^level + 1)^2 points, shared by the triangles
    std::vector<std::array<std::uint32_t, 3>> triangles;  // 2 * 4^level, counter-clockwise from above
};

// level in 1..kMaxMountainLevel.
[[nodiscard]] Mountain fractal_mountain(int level);
// Top ball first. The radii shrink from 0.17 by 0.001 each, so that no two balls touch.
[[nodiscard]] std::array<Sphere, 4> mountain_balls();

}  // namespace glint
