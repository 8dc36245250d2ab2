// How light divides at a smooth dielectric boundary, and where the refracted ray goes.
// eta is the index of refraction on the ray's side divided by the one beyond. Directions point away from the surface. Free of
// branches and inlined, so that loops over many vertices become vector instructions.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace glint {

// The mirror direction of `wo` about the unit normal `n`.
[[nodiscard]] inline glm::vec3 reflect(glm::vec3 wo, glm::vec3 n) { return 2.0f * glm::dot(n, wo) * n - wo; }

// cos^2 of the transmitted angle (Snell). At 0 and below all light is reflected. Written so that 1 - cos^2 is never formed:
// grazing light keeps its digits, and between equal media the angle is kept exactly.
[[nodiscard]] inline double transmitted_cos2(double cos_i, double eta) {
    const double c = eta * cos_i;
    return (1.0 - eta) * (1.0 + eta) + c * c;
}

// Unpolarised reflectance (Fresnel 1823; Born & Wolf, section 1.5.2), the mean of both polarisations; 1 at total reflection.
[[nodiscard, gnu::always_inline]] inline double fresnel_dielectric(double cos_i, double eta) {
    const double cos2_t = transmitted_cos2(cos_i, eta);
    const double cos_t = std::sqrt(cos2_t);
    const double s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const double p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double reflected = 0.5 * (s * s + p * p);
    return cos2_t > 0.0 ? reflected : 1.0;
}

// Schlick's approximation (1994). From the dense side the cosine is that of the transmitted ray; 1 at total reflection.
[[nodiscard, gnu::always_inline]] inline double fresnel_schlick(double cos_i, double eta) {
    const double cos2_t = transmitted_cos2(cos_i, eta);
    const double cos_t = std::sqrt(cos2_t);
    const double c = eta > 1.0 ? cos_t : cos_i;
    const double r = (eta - 1.0) / (eta + 1.0);
    const double r0 = r * r, m = 1.0 - c, m2 = m * m;
    const double reflected = r0 + (1.0 - r0) * m2 * m2 * m;
    return cos2_t > 0.0 ? reflected : 1.0;
}

// The refracted direction, unit length; `n` on the side of `wo`. Only below total reflection (transmitted_cos2 > 0).
[[nodiscard, gnu::always_inline]] inline glm::vec3 refract(glm::vec3 wo, glm::vec3 n, double eta) {
    const glm::dvec3 o(wo), m(n);
    const double cos_i = glm::dot(o, m);
    const double cos_t = std::sqrt(std::max(0.0, transmitted_cos2(cos_i, eta)));
    const glm::dvec3 t = (eta * cos_i - cos_t) * m - eta * o;
    const glm::vec3 bent(t / std::sqrt(glm::dot(t, t)));
    const bool straight = eta == 1.0;
    return {straight ? -wo.x : bent.x, straight ? -wo.y : bent.y, straight ? -wo.z : bent.z};
}

}  // namespace glint
