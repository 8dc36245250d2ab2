// Light that reaches a surface straight from a source and is reflected by it, and the ray that asks whether it does.
// Knows no accelerator, no branches and no random numbers.
#pragma once

#include <cmath>

#include "accel/ray.h"
#include "core/light.h"
#include "core/material.h"
#include "core/surface_point.h"

namespace glint {

// Blinn-Phong (Blinn 1977): the light of `l` that leaves towards `wo`; black where it would not show.
[[nodiscard]] inline glm::vec3 reflected_light(const LightSample& l, const SurfacePoint& s, const Material& m, glm::vec3 wo,
                                               bool highlight) {
    const float n_l = glm::dot(s.ns, l.wi);
    // Both terms need the light above the surface; a highlight on the dark side is a classic slip.
    if (!(n_l > 0.0f) || !(glm::dot(s.ng, l.wi) > 0.0f)) return glm::vec3(0.0f);
    glm::vec3 reflectance = m.diffuse * n_l;
    if (highlight) {
        const glm::vec3 h = wo + l.wi;
        const float h2 = glm::dot(h, h);
        const float n_h = h2 > 0.0f ? glm::dot(s.ns, h) / std::sqrt(h2) : 0.0f;
        if (n_h > 0.0f) reflectance += m.specular * (m.highlight_scale * std::pow(n_h, m.shininess));
    }
    return l.arriving * reflectance;
}

// The ray that asks whether the sampled point of the light is seen from `s`. From a light whose rays start at it (see
// shadow_origins.h) they all have one origin, which lets an accelerator trace them together.
[[nodiscard]] inline Ray shadow_ray(const Light& light, const LightSample& l, const SurfacePoint& s, bool starts_at_light) {
    if (starts_at_light) return {light.position, direction_to(s, light.position), 1.0f};
    const glm::vec3 origin = spawn_origin(s, s.ng);
    if (l.at_infinity) return {origin, l.wi, kInfinity};
    const glm::vec3 direction = l.point - origin;
    return {origin, direction, shadow_reach(light, origin, direction)};
}

}  // namespace glint
