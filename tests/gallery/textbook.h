// The textbook methods that the exhibits show failing, as they are printed. They live here alone: the product has none of them.
// Knows nothing of glint. Invariant: each is one formula, in float where its readers use float.
#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace glint::textbook {

// The offset of a thousand tutorials.
constexpr float kEpsilon = 1e-4f;

// a.b and a x b as a compiler contracts them that may fuse products (GCC's default with -march=native).
inline float fused_dot(glm::vec3 a, glm::vec3 b) { return std::fma(a.z, b.z, std::fma(a.y, b.y, a.x * b.x)); }
inline glm::vec3 fused_cross(glm::vec3 a, glm::vec3 b) {
    return {std::fma(a.y, b.z, -(a.z * b.y)), std::fma(a.z, b.x, -(a.x * b.z)), std::fma(a.x, b.y, -(a.y * b.x))};
}

// Möller & Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection", compiled with fused products. t, or 0 for a miss.
inline float moeller_trumbore_fused(glm::vec3 o, glm::vec3 d, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 e1 = b - a, e2 = c - a, p = fused_cross(d, e2);
    const float det = fused_dot(e1, p);
    if (det == 0.0f) return 0.0f;
    const glm::vec3 s = o - a, q = fused_cross(s, e1);
    const float u = fused_dot(s, p) / det, v = fused_dot(d, q) / det;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f) return 0.0f;
    return std::max(0.0f, fused_dot(e2, q) / det);
}

// The same as printed, with the paper's absolute threshold for the determinant.
inline float moeller_trumbore(glm::vec3 o, glm::vec3 d, glm::vec3 a, glm::vec3 b, glm::vec3 c, float threshold) {
    const glm::vec3 e1 = b - a, e2 = c - a, p = glm::cross(d, e2);
    const float det = glm::dot(e1, p);
    if (std::abs(det) < threshold) return 0.0f;
    const glm::vec3 s = o - a, q = glm::cross(s, e1);
    const float u = glm::dot(s, p) / det, v = glm::dot(d, q) / det;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f) return 0.0f;
    return std::max(0.0f, glm::dot(e2, q) / det);
}

// Rejects by comparison, after a division that nothing guards: NaN passes every one of them.
inline bool hit_by_rejection(glm::vec3 o, glm::vec3 d, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 e1 = b - a, e2 = c - a, s = o - a, p = glm::cross(d, e2), q = glm::cross(s, e1);
    const float denom = glm::dot(e1, p);
    const float beta = glm::dot(s, p) / denom, gamma = glm::dot(d, q) / denom, t = glm::dot(e2, q) / denom;
    if (beta < 0.0f) return false;
    if (gamma < 0.0f) return false;
    if (beta + gamma > 1.0f) return false;
    if (t < kEpsilon) return false;
    return true;
}

// b^2 - 4ac in float. t, or 0 for a miss.
inline float quadratic_sphere(glm::vec3 o, glm::vec3 d, glm::vec3 center, float radius) {
    const glm::vec3 f = o - center;
    const float a = glm::dot(d, d), b = 2.0f * glm::dot(f, d), c = glm::dot(f, f) - radius * radius;
    const float discriminant = b * b - 4.0f * a * c;
    if (discriminant < 0.0f) return 0.0f;
    const float t0 = (-b - std::sqrt(discriminant)) / (2.0f * a), t1 = (-b + std::sqrt(discriminant)) / (2.0f * a);
    return t0 > 0.0f ? t0 : t1 > 0.0f ? t1 : 0.0f;
}

// Fresnel's equations with `etat` where `etai` belongs in the second line.
inline double slipped_fresnel(double cos_i, double etai, double etat) {
    const double sin_t = etai / etat * std::sqrt(std::max(0.0, 1.0 - cos_i * cos_i));
    if (sin_t >= 1.0) return 1.0;
    const double cos_t = std::sqrt(1.0 - sin_t * sin_t);
    const double rs = (etai * cos_i - etat * cos_t) / (etai * cos_i + etat * cos_t);
    const double rp = (etat * cos_i - etat * cos_t) / (etat * cos_i + etat * cos_t);
    return 0.5 * (rs * rs + rp * rp);
}

}  // namespace glint::textbook
