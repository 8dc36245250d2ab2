// Light sources and how a point on them is sampled.
// Knows no geometry: whether the point is visible is the integrator's question.
// Invariant: sample_light() is an unbiased estimate of the light's mean (falloff none) or of its integral (physical).
#pragma once

#include <glm/glm.hpp>

namespace glint {

struct Light {
    enum class Shape { point, directional, quad, sphere };
    // none: the light's colour counts in full from anywhere (P3F). physical: cosine at the light and 1/d^2.
    enum class Falloff { none, physical };

    Shape shape = Shape::point;
    Falloff falloff = Falloff::none;
    glm::vec3 position{0.0f};  // the point; the quad's corner; the sphere's centre
    // quad: position + s*edge1 + t*edge2, facing cross(edge1, edge2). point: a parallelogram centred on the point over
    // which it is spread (its mean is what counts; the paper's soft shadow); zero = a true point.
    glm::vec3 edge1{0.0f};
    glm::vec3 edge2{0.0f};
    float radius = 0.0f;                     // sphere
    glm::vec3 direction{0.0f, 0.0f, -1.0f};  // unit, the way the light travels: directional lights and spot axes
    float cos_inner = -2.0f;                 // spot: full inside cos_inner, none outside cos_outer; -2 = no spot
    float cos_outer = -2.0f;
    float range = 0.0f;  // physical points: fades to 0 at this distance (KHR_lights_punctual); 0 = unlimited
    // none: colour. physical: point and spot = radiant intensity, directional = irradiance, quad and sphere = radiance.
    glm::vec3 emission{1.0f};

    bool operator==(const Light&) const = default;
    [[nodiscard]] bool is_true_point() const { return shape == Shape::point && edge1 == glm::vec3(0.0f); }
    [[nodiscard]] bool has_area() const {
        return shape == Shape::quad || shape == Shape::sphere || (shape == Shape::point && edge1 != glm::vec3(0.0f));
    }
};

// One point of a light as seen from a receiver.
struct LightSample {
    glm::vec3 wi{0.0f};     // unit, towards the light
    glm::vec3 point{0.0f};  // on the light (directional: unused)
    bool at_infinity = false;
    glm::vec3 arriving{0.0f};  // light per receiver cosine: what diffuse * n.l multiplies; black = nothing arrives
};

// The point that u of the unit square chooses; u = (1/2, 1/2) gives the centre of points, quads and spreads.
[[nodiscard]] LightSample sample_light(const Light& light, glm::vec3 receiver, glm::vec2 u) noexcept;

// How far a shadow ray looks, in lengths of `direction`, which leads from `origin` to a sampled point of the light.
// A light with area may be geometry of its own: the ray ends short of its surface by the rounding of the coordinates. A true
// point has no surface: the ray ends that much past it, so that what touches the point shadows it (not surely so where it is
// triangles many times larger than their distance: their hits are less precise).
[[nodiscard]] float shadow_reach(const Light& light, glm::vec3 origin, glm::vec3 direction) noexcept;

// The same light without extent, for hard shadows: same colour, same light at a distance.
[[nodiscard]] Light without_area(const Light& light);

}  // namespace glint
