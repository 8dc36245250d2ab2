// The published ways to intersect a ray with a primitive, for any type of number. t of the nearest hit in front, or 0 for a miss.
// Knows nothing of glint's own tests. Invariant: each rounds as printed; with long double they are the truth to compare with.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "accel/geometry.h"

namespace glint::numeric {

template <class R>
using Vec = glm::vec<3, R, glm::defaultp>;

template <class R>
inline R nearest_of(R t0, R t1) {
    if (t0 > t1) std::swap(t0, t1);
    return t0 > R(0) ? t0 : t1 > R(0) ? t1 : R(0);
}

// Möller & Trumbore 1997.
template <class R>
inline R moeller_trumbore(const Ray& ray, const glm::vec3 (&v)[3]) {
    const Vec<R> o(ray.origin), d(ray.direction), a(v[0]), e1 = Vec<R>(v[1]) - a, e2 = Vec<R>(v[2]) - a;
    const Vec<R> p = glm::cross(d, e2);
    const R det = glm::dot(e1, p);
    if (det == R(0)) return R(0);
    const R inverse = R(1) / det;
    const Vec<R> s = o - a;
    const R u = glm::dot(s, p) * inverse;
    if (u < R(0) || u > R(1)) return R(0);
    const Vec<R> q = glm::cross(s, e1);
    const R w = glm::dot(d, q) * inverse;
    if (w < R(0) || u + w > R(1)) return R(0);
    return std::max(R(0), glm::dot(e2, q) * inverse);
}

// Woop, Benthin & Wald 2013, with the recomputation in double where an edge function is 0.
inline float woop(const Ray& ray, const glm::vec3 (&v)[3]) {
    const glm::vec3 size = glm::abs(ray.direction);
    const int kz = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2), kx = (kz + 1) % 3,
              ky = (kx + 1) % 3;
    const float sz = 1.0f / ray.direction[kz], sx = ray.direction[kx] * sz, sy = ray.direction[ky] * sz;
    const glm::vec3 a = v[0] - ray.origin, b = v[1] - ray.origin, c = v[2] - ray.origin;
    const float ax = a[kx] - sx * a[kz], ay = a[ky] - sy * a[kz], bx = b[kx] - sx * b[kz], by = b[ky] - sy * b[kz];
    const float cx = c[kx] - sx * c[kz], cy = c[ky] - sy * c[kz];
    const auto exact = [](float p, float q, float r, float s) {
        return static_cast<float>(static_cast<double>(p) * q - static_cast<double>(r) * s);
    };
    float u = cx * by - cy * bx, w = ax * cy - ay * cx, z = bx * ay - by * ax;
    if (u == 0.0f || w == 0.0f || z == 0.0f) u = exact(cx, by, cy, bx), w = exact(ax, cy, ay, cx), z = exact(bx, ay, by, ax);
    if ((u < 0.0f || w < 0.0f || z < 0.0f) && (u > 0.0f || w > 0.0f || z > 0.0f)) return 0.0f;
    const float det = u + w + z;
    if (det == 0.0f) return 0.0f;
    return std::max(0.0f, (u * (sz * a[kz]) + w * (sz * b[kz]) + z * (sz * c[kz])) / det);
}

// b^2 - 4ac.
template <class R>
inline R quadratic_sphere(const Ray& ray, const Sphere& sphere) {
    const Vec<R> f = Vec<R>(ray.origin) - Vec<R>(sphere.center), d(ray.direction);
    const R a = glm::dot(d, d), b = R(2) * glm::dot(f, d), r(sphere.radius), c = glm::dot(f, f) - r * r;
    const R discriminant = b * b - R(4) * a * c;
    if (!(discriminant >= R(0))) return R(0);
    const R root = std::sqrt(discriminant);
    return nearest_of((-b - root) / (R(2) * a), (-b + root) / (R(2) * a));
}

// The perpendicular form without cancellation (Haines, Günther & Akenine-Möller 2019, Ray Tracing Gems ch. 7).
template <class R>
inline R perpendicular_sphere(const Ray& ray, const Sphere& sphere) {
    const Vec<R> f = Vec<R>(ray.origin) - Vec<R>(sphere.center), d(ray.direction);
    const R a = glm::dot(d, d), b = -glm::dot(f, d), r(sphere.radius);
    const Vec<R> foot = f + (b / a) * d;
    const R discriminant = r * r - glm::dot(foot, foot);
    if (!(discriminant >= R(0))) return R(0);
    const R q = b + std::copysign(std::sqrt(a * discriminant), b);
    return nearest_of((glm::dot(f, f) - r * r) / q, q / a);
}

// Slabs (Kay & Kajiya 1986).
template <class R>
inline R slabs(const Ray& ray, const Box& box) {
    R near = -std::numeric_limits<R>::infinity(), far = std::numeric_limits<R>::infinity();
    for (int i = 0; i < 3; ++i) {
        const R o(ray.origin[i]), inverse = R(1) / R(ray.direction[i]);
        const R lo = (R(box.lo[i]) - o) * inverse, hi = (R(box.hi[i]) - o) * inverse;
        near = std::max(near, std::min(lo, hi));
        far = std::min(far, std::max(lo, hi));
    }
    return near <= far ? nearest_of(near, far) : R(0);
}

template <class R>
inline R plane(const Ray& ray, const Plane& plane) {
    const Vec<R> n(plane.normal);
    const R slope = glm::dot(n, Vec<R>(ray.direction));
    if (slope == R(0)) return R(0);
    return std::max(R(0), -(glm::dot(n, Vec<R>(ray.origin)) + R(plane.offset)) / slope);
}

// The lateral surface of a truncated cone, as a quadratic in t from the ray's origin.
template <class R>
inline R cone(const Ray& ray, const Cone& cone) {
    const Vec<R> d(ray.direction), base(cone.base), axis = Vec<R>(cone.apex) - base, f = Vec<R>(ray.origin) - base;
    const R h2 = glm::dot(axis, axis), s0 = glm::dot(f, axis) / h2, s1 = glm::dot(d, axis) / h2;
    const R slope = R(cone.apex_radius) - R(cone.base_radius), r0 = R(cone.base_radius) + slope * s0, r1 = slope * s1;
    const Vec<R> p0 = f - s0 * axis, p1 = d - s1 * axis;
    const R a = glm::dot(p1, p1) - r1 * r1, b = glm::dot(p0, p1) - r0 * r1, c = glm::dot(p0, p0) - r0 * r0;
    const R discriminant = b * b - a * c;
    if (!(discriminant >= R(0))) return R(0);
    const R root = std::sqrt(discriminant);
    R t[2] = {(-b - root) / a, (-b + root) / a};
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    for (const R x : t) {
        const R height = s0 + s1 * x;
        if (x > R(0) && height >= R(0) && height <= R(1) && r0 + r1 * x >= R(0)) return x;
    }
    return R(0);
}

}  // namespace glint::numeric
