// Where a light is sampled and how far its shadow ray looks: the formulas, for one receiver or for a loop over several, of which
// compilers make vector instructions. Everything is inlined and free of branches; what does not apply is chosen away at the end.
// Knows no samples' source and no surface. Invariant: the same bits in a loop and alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/light.h"
#include "core/turn.h"

namespace glint::light_formulas {

[[gnu::always_inline]] inline glm::vec3 where(bool condition, glm::vec3 a) {
    return {condition ? a.x : 0.0f, condition ? a.y : 0.0f, condition ? a.z : 0.0f};
}

// The direction towards a point; no light arrives where the receiver is at the light itself (there is no direction).
struct Aim {
    glm::vec3 wi;
    float distance2;
    bool any;
};
[[gnu::always_inline]] inline Aim aim(glm::vec3 point, glm::vec3 receiver) {
    const glm::vec3 to = point - receiver;
    const float distance2 = glm::dot(to, to);
    const bool any = distance2 >= std::numeric_limits<float>::min();
    return {where(any, to / std::sqrt(distance2)), distance2, any};
}

// A point that shines alike in all directions, however far.
template <bool kPhysical>
[[gnu::always_inline]] inline LightSample plain_point(const Light& light, glm::vec3 receiver) {
    LightSample s;
    const Aim to = aim(light.position, receiver);
    s.point = light.position;
    s.wi = to.wi;
    s.arriving = where(to.any, kPhysical ? light.emission * (1.0f / to.distance2) : light.emission);
    return s;
}

// The point of a parallelogram that shines alike in all directions, however far: spread points and quads without falloff.
[[gnu::always_inline]] inline glm::vec3 spread_point(const Light& light, glm::vec2 u) {
    return light.position + (u.x - 0.5f) * light.edge1 + (u.y - 0.5f) * light.edge2;
}
[[gnu::always_inline]] inline glm::vec3 quad_point(const Light& light, glm::vec2 u) {
    return light.position + u.x * light.edge1 + u.y * light.edge2;
}
[[gnu::always_inline]] inline LightSample everywhere_alike(const Light& light, glm::vec3 point, glm::vec3 receiver) {
    LightSample s;
    const Aim to = aim(point, receiver);
    s.point = point;
    s.wi = to.wi;
    s.arriving = where(to.any, light.emission);
    return s;
}

// Radiance times the quad's solid angle per unit area; nothing from its back or its own plane.
[[gnu::always_inline]] inline LightSample physical_quad(const Light& light, glm::vec3 receiver, glm::vec2 u) {
    LightSample s;
    s.point = quad_point(light, u);
    const Aim to = aim(s.point, receiver);
    s.wi = to.wi;
    const glm::vec3 area = glm::cross(light.edge1, light.edge2);
    s.arriving = where(to.any, light.emission * (std::max(0.0f, -glm::dot(area, to.wi)) / to.distance2));
    return s;
}

// Uniform over the cone that the sphere fills (Shirley, Wang & Zimmerman 1996, "Monte Carlo Techniques for Direct
// Lighting Calculations"), so the estimate is the exact irradiance where nothing blocks and the cone is above the horizon.
[[gnu::always_inline]] inline LightSample physical_sphere(const Light& light, glm::vec3 receiver, glm::vec2 u) {
    const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(receiver);
    const double d2 = glm::dot(to, to), r2 = static_cast<double>(light.radius) * static_cast<double>(light.radius);
    const double sin2_max = r2 / d2;
    const double cos_max = std::sqrt(1.0 - sin2_max);
    const double one_minus_cos = sin2_max / (1.0 + cos_max);  // 1 - cos_max without cancellation far away
    const double cos_theta = 1.0 - static_cast<double>(u.x) * one_minus_cos;
    const double sin2 = std::max(0.0, 1.0 - cos_theta * cos_theta);
    const double sin_theta = std::sqrt(sin2);
    const Turn phi = turn(static_cast<double>(u.y));
    const double d = std::sqrt(d2);
    const glm::dvec3 w = to / d;
    // Any axis that w is not along.
    const bool along_x = std::abs(w.x) > 0.5;
    const glm::dvec3 p = glm::normalize(glm::cross(w, glm::dvec3(along_x ? 0.0 : 1.0, along_x ? 1.0 : 0.0, 0.0)));
    const glm::dvec3 q = glm::cross(w, p);
    const glm::dvec3 direction = cos_theta * w + sin_theta * (phi.cos * p + phi.sin * q);
    const double near = d * cos_theta - std::sqrt(std::max(0.0, r2 - d2 * sin2));
    const bool any = d2 > r2;  // inside the light: it has no outside to shine from
    LightSample s;
    s.wi = where(any, glm::vec3(direction));
    s.point = where(any, glm::vec3(glm::dvec3(receiver) + near * direction));
    s.arriving = where(any, light.emission * static_cast<float>(2.0 * std::numbers::pi * one_minus_cos));
    return s;
}

// What a float intersection with the light's own triangles subtracts; each such step errs by 2^-24 of it.
[[gnu::always_inline]] inline float reach_error(const Light& light, glm::vec3 origin) {
    const glm::vec3 size = glm::abs(origin) + glm::abs(light.position) + glm::abs(light.edge1) + glm::abs(light.edge2);
    return 0x1p-20f * (std::max(size.x, std::max(size.y, size.z)) + light.radius);
}
// A receiver that close to the light has nothing in between. (Also for NaN, where edges are parallel.)
[[gnu::always_inline]] inline float at_least_nothing(double reach) { return reach > 0.0 ? static_cast<float>(reach) : 0.0f; }

// What touches a true point shadows it: the ray ends past it, or rounding would decide pixel by pixel.
[[gnu::always_inline]] inline float reach_of_point(const Light& light, glm::vec3 origin, glm::vec3 direction) {
    return 1.0f + reach_error(light, origin) / std::sqrt(glm::dot(direction, direction));
}
// Entry into a slightly larger ball: a ray that grazes the ball may enter it long before the sampled point.
[[gnu::always_inline]] inline float reach_of_sphere(const Light& light, glm::vec3 origin, glm::vec3 direction) {
    const glm::dvec3 d(direction), to = glm::dvec3(light.position) - glm::dvec3(origin);
    const double r = static_cast<double>(light.radius) + static_cast<double>(reach_error(light, origin)), d2 = glm::dot(d, d);
    const double nearest = glm::dot(to, d) / d2;
    const glm::dvec3 off = to - nearest * d;
    return at_least_nothing(nearest - std::sqrt(std::max(0.0, (r * r - glm::dot(off, off)) / d2)));
}
// Measured across the plane, since a slanted ray meets it earlier or later by 1/cos of the error.
[[gnu::always_inline]] inline float reach_of_quad(const Light& light, glm::vec3 origin, glm::vec3 direction) {
    const glm::dvec3 area = glm::cross(glm::dvec3(light.edge1), glm::dvec3(light.edge2));
    const double error = static_cast<double>(reach_error(light, origin));
    return at_least_nothing(1.0 - error * std::sqrt(glm::dot(area, area)) / std::abs(glm::dot(area, glm::dvec3(direction))));
}

}  // namespace glint::light_formulas
