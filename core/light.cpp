#include "core/light.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/sampler.h"

namespace glint {
namespace {

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

// Sets wi and returns the squared distance; 0 where the receiver is at the light itself (no direction, no light).
float aim(LightSample& s, glm::vec3 receiver) {
    const glm::vec3 to = s.point - receiver;
    const float distance2 = glm::dot(to, to);
    if (!(distance2 >= std::numeric_limits<float>::min())) return 0.0f;
    s.wi = to / std::sqrt(distance2);
    return distance2;
}

// Uniform over the cone that the sphere fills (Shirley, Wang & Zimmerman 1996, "Monte Carlo Techniques for Direct
// Lighting Calculations"), so the estimate is the exact irradiance where nothing blocks and the cone is above the horizon.
LightSample sample_physical_sphere(const Light& light, glm::vec3 receiver, glm::vec2 u) {
    LightSample s;
    const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(receiver);
    const double d2 = glm::dot(to, to), r2 = static_cast<double>(light.radius) * light.radius;
    if (!(d2 > r2)) return s;  // inside the light: it has no outside to shine from
    const double sin2_max = r2 / d2;
    const double cos_max = std::sqrt(1.0 - sin2_max);
    const double one_minus_cos = sin2_max / (1.0 + cos_max);  // 1 - cos_max without cancellation far away
    const double cos_theta = 1.0 - u.x * one_minus_cos;
    const double sin2 = std::max(0.0, 1.0 - cos_theta * cos_theta);
    const double sin_theta = std::sqrt(sin2), phi = 2.0 * std::numbers::pi * u.y;
    const double d = std::sqrt(d2);
    const glm::dvec3 w = to / d;
    const glm::dvec3 a = std::abs(w.x) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 p = glm::normalize(glm::cross(w, a)), q = glm::cross(w, p);
    const glm::dvec3 direction = cos_theta * w + sin_theta * (std::cos(phi) * p + std::sin(phi) * q);
    const double near = d * cos_theta - std::sqrt(std::max(0.0, r2 - d2 * sin2));
    s.wi = glm::vec3(direction);
    s.point = glm::vec3(glm::dvec3(receiver) + near * direction);
    s.arriving = light.emission * static_cast<float>(2.0 * std::numbers::pi * one_minus_cos);
    return s;
}

}  // namespace

LightSample sample_light(const Light& light, glm::vec3 receiver, glm::vec2 u) noexcept {
    const bool physical = light.falloff == Light::Falloff::physical;
    LightSample s;
    switch (light.shape) {
        case Light::Shape::directional:
            s.wi = -light.direction;
            s.at_infinity = true;
            s.arriving = light.emission;
            return s;
        case Light::Shape::sphere:
            if (physical) return sample_physical_sphere(light, receiver, u);
            s.point = light.position + light.radius * sphere_from_square(u);
            break;
        case Light::Shape::quad: s.point = light.position + u.x * light.edge1 + u.y * light.edge2; break;
        case Light::Shape::point:
            s.point = light.position;
            if (light.edge1 != glm::vec3(0.0f)) s.point += (u.x - 0.5f) * light.edge1 + (u.y - 0.5f) * light.edge2;
            break;
    }
    const float distance2 = aim(s, receiver);
    if (distance2 == 0.0f) return s;
    s.arriving = light.emission;
    if (light.shape == Light::Shape::quad && physical) {
        // Radiance times the quad's solid angle per unit area; nothing from its back or its own plane.
        const glm::vec3 area = glm::cross(light.edge1, light.edge2);
        s.arriving *= std::max(0.0f, -glm::dot(area, s.wi)) / distance2;
    } else if (physical) {
        s.arriving *= spot_factor(light, s.wi) * range_factor(light, distance2) / distance2;
    }
    return s;
}

float shadow_reach(const Light& light, glm::vec3 origin, glm::vec3 direction) noexcept {
    // The numbers that a float intersection with the light's own triangles subtracts; each such step errs by 2^-24 of them.
    const glm::vec3 size = glm::abs(origin) + glm::abs(light.position) + glm::abs(light.edge1) + glm::abs(light.edge2);
    const float error = 0x1p-20f * (std::max(size.x, std::max(size.y, size.z)) + light.radius);
    // What touches a true point shadows it: the ray ends past it, or rounding would decide pixel by pixel.
    if (!light.has_area()) return 1.0f + error / std::sqrt(glm::dot(direction, direction));
    const glm::dvec3 d(direction);
    double reach = 0.0;
    if (light.shape == Light::Shape::sphere) {
        // Entry into a slightly larger ball: a ray that grazes the ball may enter it long before the sampled point.
        const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(origin);
        const double r = static_cast<double>(light.radius) + static_cast<double>(error), d2 = glm::dot(d, d);
        const double nearest = glm::dot(to, d) / d2;
        const glm::dvec3 off = to - nearest * d;
        reach = nearest - std::sqrt(std::max(0.0, (r * r - glm::dot(off, off)) / d2));
    } else {
        // Measured across the plane, since a slanted ray meets it earlier or later by 1/cos of the error.
        const glm::dvec3 area = glm::cross(glm::dvec3(light.edge1), glm::dvec3(light.edge2));
        reach = 1.0 - static_cast<double>(error) * std::sqrt(glm::dot(area, area)) / std::abs(glm::dot(area, d));
    }
    // A receiver that close to the light has nothing in between. (Also for NaN, where edges are parallel.)
    return reach > 0.0 ? static_cast<float>(reach) : 0.0f;
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
