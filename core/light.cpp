#include "core/light.h"

#include <cmath>
#include <numbers>

#include "core/light_formulas.h"
#include "core/sampler.h"

namespace glint {
namespace {

using namespace light_formulas;

constexpr float kPi = std::numbers::pi_v<float>;

// Falls from 1 inside the inner cone to 0 outside the outer one (KHR_lights_punctual, "Inner and Outer Cone Angles").
float spot_factor(const Light& light, glm::vec3 wi) {
    if (light.cos_outer < -1.0f) return 1.0f;
    const float c = -glm::dot(wi, light.direction);
    if (c <= light.cos_outer) return 0.0f;
    if (c >= light.cos_inner) return 1.0f;
    const float f = (c - light.cos_outer) / (light.cos_inner - light.cos_outer);
    return f * f;
}

// Fades to 0 at the light's range (KHR_lights_punctual, "Range Property").
float range_factor(const Light& light, float distance2) {
    if (!(light.range > 0.0f)) return 1.0f;
    const float q2 = distance2 / (light.range * light.range);
    return std::max(0.0f, std::min(1.0f, 1.0f - q2 * q2));
}

}  // namespace

LightSample sample_light(const Light& light, glm::vec3 receiver, glm::vec2 u) noexcept {
    const bool physical = light.falloff == Light::Falloff::physical;
    LightSample s;
    glm::vec3 point = light.position;
    switch (light.shape) {
        case Light::Shape::directional:
            s.wi = -light.direction;
            s.at_infinity = true;
            s.arriving = light.emission;
            return s;
        case Light::Shape::sphere:
            if (physical) return physical_sphere(light, receiver, u);
            point = light.position + light.radius * sphere_from_square(u);
            break;
        case Light::Shape::quad:
            if (physical) return physical_quad(light, receiver, u);
            point = quad_point(light, u);
            break;
        case Light::Shape::point:
            if (light.has_area()) point = spread_point(light, u);
            break;
    }
    s = everywhere_alike(light, point, receiver);
    if (physical) {
        const Aim to = aim(point, receiver);
        const float factor = spot_factor(light, to.wi) * range_factor(light, to.distance2) / to.distance2;
        s.arriving = where(to.any, s.arriving * factor);
    }
    return s;
}

float shadow_reach(const Light& light, glm::vec3 origin, glm::vec3 direction) noexcept {
    if (!light.has_area()) return reach_of_point(light, origin, direction);
    return light.shape == Light::Shape::sphere ? reach_of_sphere(light, origin, direction)
                                               : reach_of_quad(light, origin, direction);
}

Light without_area(const Light& light) {
    Light hard = light;
    if (light.shape == Light::Shape::point) {
        hard.edge1 = hard.edge2 = glm::vec3(0.0f);
    } else if (light.shape == Light::Shape::sphere) {
        hard.shape = Light::Shape::point;
        if (light.falloff == Light::Falloff::physical) hard.emission *= kPi * light.radius * light.radius;
    } else if (light.shape == Light::Shape::quad && light.falloff == Light::Falloff::none) {
        hard.shape = Light::Shape::point;
        hard.position = light.position + 0.5f * light.edge1 + 0.5f * light.edge2;
        hard.edge1 = hard.edge2 = glm::vec3(0.0f);
    }
    return hard;  // a physical quad keeps its facing; its centre is sampled
}

}  // namespace glint
