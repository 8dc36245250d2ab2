// Light that reaches surfaces straight from a source and is reflected by them, and the rays that ask whether it does: for one
// point, and for many at once.
// Knows no accelerator, no branches and no random numbers. Invariant: many points get what each gets alone, to the bit.
#pragma once

#include <cmath>

#include "accel/ray_batch.h"
#include "core/light.h"
#include "core/material.h"
#include "core/surface_point.h"
#include "core/vertices.h"

namespace glint {

// Blinn-Phong (Blinn 1977): the light of `l` that leaves towards `wo`; black where it would not show.
[[nodiscard]] inline glm::vec3 reflected_light(const LightSample& l, const SurfacePoint& s, const Material& m, glm::vec3 wo,
                                               bool highlight) {
    const float n_l = glm::dot(s.ns, l.wi);
    // Both terms need the light above the surface; a highlight on the dark side is a classic slip.
    if (!(n_l > 0.0f) || !(glm::dot(horizon(s), l.wi) > 0.0f)) return glm::vec3(0.0f);
    glm::vec3 reflectance = m.diffuse * n_l;
    if (highlight) {
        const glm::vec3 h = wo + l.wi;
        const float h2 = glm::dot(h, h);
        const float n_h = h2 > 0.0f ? glm::dot(s.ns, h) / std::sqrt(h2) : 0.0f;
        if (n_h > 0.0f) reflectance += m.specular * (m.highlight_scale * std::pow(n_h, m.shininess));
    }
    return l.arriving * reflectance;
}

// The ray that asks whether the sampled point of the light is seen from `point`. From a light whose rays start at it (see
// shadow_origins.h) they all have one origin, which lets an accelerator trace them together.
[[nodiscard]] inline Ray shadow_ray(const Light& light, const LightSample& l, const SurfacePoint& point, bool starts_at_light) {
    const SurfacePoint s = is_low(l.wi, point) ? lifted(point) : point;
    if (starts_at_light) return {light.position, direction_to(s, light.position), 1.0f};
    const glm::vec3 origin = spawn_origin(s, s.ng);
    if (l.at_infinity) return {origin, l.wi, kInfinity};
    const glm::vec3 direction = l.point - origin;
    return {origin, direction, shadow_reach(light, origin, direction)};
}

// The same for all vertices of a wave and one light after the other.
struct alignas(64) DirectLight {
    // To be set before each light with area: where on it each vertex looks.
    float u[2][kRayBatch];

    // Finds the light that arrives at each vertex and is reflected if nothing is in the way.
    void reflect(const Light& light, const Vertices& vertices) noexcept;
    // The rays that ask, in the order of the vertices, for those with any light.
    void cast(const Light& light, bool starts_at_light, const Vertices& vertices, RayBatch& rays) noexcept;
    // Where light has reached a lifted point, the rays that ask whether it gets down from there; false when there are none.
    [[nodiscard]] bool cast_lifts(const OccludedBatch& blocked, const Vertices& vertices, RayBatch& rays) noexcept;
    // Blocks the light whose way down is blocked.
    void block(const OccludedBatch& lifts, OccludedBatch& blocked) const noexcept;
    // Adds the light to the vertices whose ray was not blocked.
    void add(const OccludedBatch& blocked, Vertices& vertices) const noexcept;
    // Adds it to all.
    void add(Vertices& vertices) const noexcept;

private:
    friend struct DirectLightLoops;

    void cast_to_lifted(const Light& light, bool starts_at_light, const Vertices& vertices, RayBatch& rays) noexcept;

    float wi_[3][kRayBatch], point_[3][kRayBatch], light_[3][kRayBatch], highlight_[kRayBatch];
    std::uint32_t shows_[kRayBatch];   // all bits where there is any light, else none
    std::uint32_t vertex_[kRayBatch];  // of each ray
    std::size_t rays_ = 0;
    std::uint32_t lift_[kRayBatch];  // of each ray from lifted points, its place among the rays; then of those on lifts
    std::size_t lifts_ = 0;
};

}  // namespace glint
