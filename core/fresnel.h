// How light divides at a smooth dielectric boundary, and where the refracted ray goes.
// eta is the index of refraction on the ray's side divided by the one beyond. Directions point away from the surface.
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
[[nodiscard]] inline double fresnel_dielectric(double cos_i, double eta) {
    const double cos2_t = transmitted_cos2(cos_i, eta);
    if (!(cos2_t > 0.0)) return 1.0;
    const double cos_t = std::sqrt(cos2_t);
    const double s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    const double p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5 * (s * s + p * p);
}

// Schlick's approximation (1994). From the dense side the cosine is that of the transmitted ray; 1 at total reflection.
[[nodiscard]] inline double fresnel_schlick(double cos_i, double eta) {
    const double cos2_t = transmitted_cos2(cos_i, eta);
    if (!(cos2_t > 0.0)) return 1.0;
    const double c = eta > 1.0 ? std::sqrt(cos2_t) : cos_i;
    const double r = (eta - 1.0) / (eta + 1.0);
    const double r0 = r * r, m = 1.0 - c, m2 = m * m;
    return r0 + (1.0 - r0) * m2 * m2 * m;
}

// The refracted direction, unit length; `n` on the side of `wo`. Only below total reflection (transmitted_cos2 > 0).
[[nodiscard]] inline glm::vec3 refract(glm::vec3 wo, glm::vec3 n, double eta) {
    if (eta == 1.0) return -wo;
    const glm::dvec3 o(wo), m(n);
    const double cos_i = glm::dot(o, m);
    const double cos_t = std::sqrt(std::max(0.0, transmitted_cos2(cos_i, eta)));
    const glm::dvec3 t = (eta * cos_i - cos_t) * m - eta * o;
    return glm::vec3(t / std::sqrt(glm::dot(t, t)));
}

}  // namespace glint
