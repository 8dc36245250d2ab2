// From a raw hit to what shading needs: an accurate point, its normals, and where the next ray may start.
// Knows no light. Invariant: `p` lies on the surface up to the rounding of its coordinates to float, and a ray started at
// spawn_origin() on the side of its normal cannot hit the surface it leaves.
#pragma once

#include <algorithm>

#include <glm/glm.hpp>

#include "core/scene.h"

namespace glint {

struct SurfacePoint {
    glm::vec3 p;
    glm::vec3 ng;           // geometric normal, unit, on the side of wo
    glm::vec3 ns;           // shading normal, unit, in the hemisphere of ng
    bool outside;           // wo is on the outer side (the winding's front)
    float error;            // how far a later intersection may misjudge the surface's position, scene units
    float error_from_afar;  // what is added for each unit of distance (largest coordinate) that a ray comes from
    std::uint32_t material;
    // Of a triangle with normals at its corners: from p to the smooth surface that they belong to, where that lies above.
    glm::vec3 lift{0.0f};
    float bend = 0.0f;  // the sine of the largest angle between the two
};

// `hit` must be found; `wo` points back along the ray. The result is written where it is wanted: see Branch.
void find_surface_point(const Scene& scene, glm::vec3 origin, glm::vec3 direction, const Hit& hit, SurfacePoint& s) noexcept;
[[nodiscard]] inline SurfacePoint surface_point(const Scene& scene, const Ray& ray, const Hit& hit) noexcept {
    SurfacePoint s;
    find_surface_point(scene, ray.origin, ray.direction, hit, s);
    return s;
}

// The origin for a ray that leaves towards the side of the unit vector `n`.
[[nodiscard]] inline glm::vec3 spawn_origin(const SurfacePoint& s, glm::vec3 n) noexcept {
    return glm::vec3(glm::dvec3(s.p) + static_cast<double>(s.error) * glm::dvec3(n));
}

// Light that comes from below the plane across this normal does not reach the surface. A facet's own plane would cut the light of
// a rounded surface facet by facet, so there the interpolated normal tells alone; but only where a lift carries the point over
// the facets around it, so that shadow rays can tell the rest.
[[nodiscard, gnu::always_inline]] inline glm::vec3 horizon(glm::vec3 ng, glm::vec3 ns, glm::vec3 lift) noexcept {
    const bool lifted = glm::dot(lift, ng) > 0.0f;
    return {lifted ? ns.x : ng.x, lifted ? ns.y : ng.y, lifted ? ns.z : ng.z};
}
[[nodiscard]] inline glm::vec3 horizon(const SurfacePoint& s) noexcept { return horizon(s.ng, s.ns, s.lift); }

// Whether light from the unit direction `wi` comes so low over the facet that its neighbours may be in the way, or itself, where
// the smooth surface is not: then it is looked for at the lifted point.
[[nodiscard, gnu::always_inline]] inline bool is_low(glm::vec3 wi, glm::vec3 ng, glm::vec3 lift, float bend) noexcept {
    return !(glm::dot(ng, wi) > bend) && glm::dot(lift, ng) > 0.0f;
}
[[nodiscard]] inline bool is_low(glm::vec3 wi, const SurfacePoint& s) noexcept { return is_low(wi, s.ng, s.lift, s.bend); }

[[nodiscard]] inline SurfacePoint lifted(const SurfacePoint& s) noexcept {
    SurfacePoint l = s;
    l.p = glm::vec3(glm::dvec3(s.p) + glm::dvec3(s.lift));
    return l;
}

// The way there. Light that takes it has passed no surface between the lamp and the point, so a closed mesh stays dark inside.
[[nodiscard]] inline Ray lift_ray(const SurfacePoint& s) noexcept {
    const glm::vec3 origin = spawn_origin(s, s.ng);
    return {origin, spawn_origin(lifted(s), s.ng) - origin, 1.0f};
}

// A direction that leaves the surface: an interpolated normal can mirror a ray into it, which is then mirrored back across the
// tangent plane.
[[nodiscard, gnu::always_inline]] inline glm::vec3 above(glm::vec3 direction, const SurfacePoint& s) noexcept {
    const float below = glm::dot(direction, s.ng);
    const glm::vec3 back = direction - 2.0f * below * s.ng;
    return {below < 0.0f ? back.x : direction.x, below < 0.0f ? back.y : direction.y, below < 0.0f ? back.z : direction.z};
}

// The direction from `start` to where rays leave the surface on the side of `ng`, so that a ray with t_max = 1 reaches all
// that lies before the surface and never the surface itself.
[[nodiscard]] inline glm::vec3 direction_to(const SurfacePoint& s, glm::vec3 start) noexcept {
    const glm::vec3 d = s.p - start, size = glm::abs(d);
    return d + (s.error + s.error_from_afar * std::max(size.x, std::max(size.y, size.z))) * s.ng;
}

}  // namespace glint
