// Rotation about an axis in double, for recipes that must come out equal to printed digits.
// Knows no scene. Right-handed: counter-clockwise when the axis points at the observer.
#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace glint {

// `axis` of unit length, `angle` in radians; applied as matrix * column vector (Rodrigues 1840).
[[nodiscard]] inline glm::dmat3 rotation_about(glm::dvec3 axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const glm::dmat3 cross(0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0);
    return glm::dmat3(c) + s * cross + (1.0 - c) * glm::outerProduct(axis, axis);
}

}  // namespace glint
