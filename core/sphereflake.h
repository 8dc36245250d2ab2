// Haines's sphereflake: a ball with nine balls of a third of its radius on it, each carrying nine more, and so on.
// Knows no scene, material or camera. Order: depth first, parent before children, as in the course's balls_* files.
// Recipe: Eric Haines, Standard Procedural Databases 3.14 (public domain), `balls`; z is up, the first radius is 0.5.
#pragma once

#include <vector>

#include "accel/geometry.h"

namespace glint {

constexpr int kMaxSphereflakeLevel = 6;  // 597871 balls; each level more takes nine times the memory

// (9^(level+1) - 1) / 8 balls, level in 0..kMaxSphereflakeLevel.
[[nodiscard]] std::vector<Sphere> sphereflake(int level);

}  // namespace glint
