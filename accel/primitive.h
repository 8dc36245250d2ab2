// Ray against one primitive: the only arithmetic that decides a hit. Every accelerator ends here, so all agree to the bit.
// Knows no accelerator. Invariant: a reported t lies in (0, t_max] and inside the ray's interval through the primitive's
// padded bounds (prepared_ray.h), so that a box test by the same arithmetic can never cull a hit.
// Triangles are tested in float, watertight, by operations that every instruction set rounds alike; the others in double.
#pragma once

#include "accel/prepared_ray.h"

namespace glint {

// The scaled barycentric coordinates of the sheared triangle (its projection along the ray), in float or double.
template <class Real>
struct EdgeFunctions {
    Real u, v, w;
    [[nodiscard]] bool mixed_signs() const { return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0); }
};

struct TriangleHit {
    float t, u, v;
};

// a*b - c*d to 1.5 units in the last place, so its sign is exact (Kahan's algorithm; Jeannerod, Louvet & Muller 2013, "Further
// analysis of Kahan's algorithm for the accurate computation of 2x2 determinants"). Without a fused instruction libm emulates it.
inline float difference_of_products(float a, float b, float c, float d) noexcept {
    return std::fma(a, b, -(c * d)) + std::fma(-c, d, c * d);
}

// Edge functions from the one to a determinant up to the other are as exact as said above, and what is derived from them is a
// normal float, or too small against the triangle to matter (an edge of 2^-80 belongs to a side of 2^-40, and what is lost
// below the least float comes to 2^-71 of length).
constexpr float kLeastEdge = 0x1p-80f, kLargestDeterminant = 0x1p100f;

// A triangle relative to the ray: x and y sheared so that the ray runs along z through (0, 0).
struct ShearedTriangle {
    float ax, ay, az, bx, by, bz, cx, cy, cz;
};

// Writes t and weights from edge functions of one sign; false where they are too small or large to be trusted.
inline bool weigh(const PreparedRay& ray, const ShearedTriangle& s, TriangleHit& hit) noexcept {
    const float u = difference_of_products(s.cx, s.by, s.cy, s.bx), v = difference_of_products(s.ax, s.cy, s.ay, s.cx),
                w = difference_of_products(s.bx, s.ay, s.by, s.ax);
    const float lowest = std::min(std::min(u, v), w), highest = std::max(std::max(u, v), w);
    const float det = (u + v) + w;
    // From the first corner, so that what the weights lack counts for the triangle's own depth alone: t strays half as often as a
    // mean of the corners' distances. Summed before it is divided: the sum and the reciprocal are computed side by side.
    const float beyond = v * (s.bz - s.az) + w * (s.cz - s.az);
    if (!(std::max(lowest, -highest) >= kLeastEdge && std::abs(det) <= kLargestDeterminant &&
          std::abs(beyond) <= kLargestDeterminant)) {
        return false;
    }
    const float scale = 1.0f / det;
    hit.u = v * scale;
    hit.v = w * scale;
    hit.t = (s.az + beyond * scale) * ray.inverse_z;
    return true;
}

// The rare cases that float cannot decide as it stands: a ray through an edge or a vertex, a tiny triangle, a huge one.
inline bool intersect_uncertain(const PreparedRay& ray, ShearedTriangle s, float t_limit, TriangleHit& hit) noexcept {
    // In double the products of two floats are exact.
    const EdgeFunctions<double> e{static_cast<double>(s.cx) * s.by - static_cast<double>(s.cy) * s.bx,
                                  static_cast<double>(s.ax) * s.cy - static_cast<double>(s.ay) * s.cx,
                                  static_cast<double>(s.bx) * s.ay - static_cast<double>(s.by) * s.ax};
    if (e.mixed_signs()) return false;
    const double det = e.u + e.v + e.w;
    if (!(std::abs(det) > 0.0)) return false;  // the ray lies in the plane, or NaN
    // At size 1 the usual arithmetic, so that a scene scaled by a power of two keeps its bits.
    const auto bigger = [](float a, float b) { return std::abs(a) < std::abs(b); };
    const int exponent = std::ilogb(std::max({s.ax, s.ay, s.bx, s.by, s.cx, s.cy}, bigger));
    for (float* x : {&s.ax, &s.ay, &s.bx, &s.by, &s.cx, &s.cy}) *x = std::ldexp(*x, -exponent);
    if (!weigh(ray, s, hit)) {
        hit.t = static_cast<float>((e.u * s.az + e.v * s.bz + e.w * s.cz) / (det * ray.direction[ray.kz]));
        hit.u = static_cast<float>(e.v / det);
        hit.v = static_cast<float>(e.w / det);
    }
    return reportable(hit.t, t_limit);
}

// Watertight: a ray that meets a shared edge or vertex hits one of its triangles at least, as the sign of an edge function
// depends on the edge alone (Woop, Benthin & Wald 2013, "Watertight Ray/Triangle Intersection"). Both faces are hit; a ray in
// the plane misses. t is a mean of the vertices' distances with weights good to a few roundings, so it lies in the interval of
// the triangle's own padded bounds (accel/README.md has the sum). Returns false for a miss.
inline bool intersect_triangle(const PreparedRay& ray, const glm::vec3& v0, const glm::vec3& v1, const glm::vec3& v2,
                               float t_limit, TriangleHit& hit) noexcept {
    const float ox = ray.origin[ray.kx], oy = ray.origin[ray.ky], oz = ray.origin[ray.kz];
    const float az = v0[ray.kz] - oz, bz = v1[ray.kz] - oz, cz = v2[ray.kz] - oz;
    const float ax = (v0[ray.kx] - ox) - ray.shear_x * az, ay = (v0[ray.ky] - oy) - ray.shear_y * az;
    const float bx = (v1[ray.kx] - ox) - ray.shear_x * bz, by = (v1[ray.ky] - oy) - ray.shear_y * bz;
    const float cx = (v2[ray.kx] - ox) - ray.shear_x * cz, cy = (v2[ray.ky] - oy) - ray.shear_y * cz;
    // Most misses are certain at once: rounding is monotone, so a difference of rounded products that is not 0 has the exact
    // sign.
    const EdgeFunctions<float> rough{cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax};
    if (rough.mixed_signs()) return false;
    const ShearedTriangle s{ax, ay, az, bx, by, bz, cx, cy, cz};
    return weigh(ray, s, hit) ? reportable(hit.t, t_limit) : intersect_uncertain(ray, s, t_limit, hit);
}

// The first root of a pair that is reportable once rounded to float; 0 when neither is.
inline float first_root(double t0, double t1, float limit) noexcept {
    const float near = static_cast<float>(t0), far = static_cast<float>(t1);
    if (reportable(near, limit)) return near;
    return reportable(far, limit) ? far : 0.0f;
}

// Roots in double by the perpendicular form of the discriminant and without cancellation (Haines, Günther &
// Akenine-Möller 2019, "Precision Improvements for Ray/Sphere Intersection"). Returns t, or 0 for a miss.
inline float intersect_sphere(const PreparedRay& ray, const Sphere& sphere, float t_limit) noexcept {
    const glm::dvec3 f = glm::dvec3(ray.origin) - glm::dvec3(sphere.center);
    const glm::dvec3 d(ray.direction);
    const double r = sphere.radius;
    const double a = glm::dot(d, d);
    const double b = -glm::dot(f, d);
    const glm::dvec3 nearest = f + (b / a) * d;
    const double discriminant = r * r - glm::dot(nearest, nearest);
    if (!(discriminant >= 0.0)) return 0.0f;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    const double c = glm::dot(f, f) - r * r;
    // q = 0 only where the ray starts on the sphere and touches it there: no hit.
    if (q == 0.0) return 0.0f;
    const double t0 = c / q, t1 = q / a;
    return first_root(std::min(t0, t1), std::max(t0, t1), t_limit);
}

// Slabs in double (Kay & Kajiya 1986); the boundary counts as inside. face: 0..5 = -x +x -y +y -z +z. t, or 0 for a miss.
inline float intersect_box(const PreparedRay& ray, const Box& box, float t_limit, int& face) noexcept {
    double near = -static_cast<double>(kInfinity), far = static_cast<double>(kInfinity);
    int near_face = 0, far_face = 0;
    for (int i = 0; i < 3; ++i) {
        const double o = ray.origin[i], d = ray.direction[i], lo = box.lo[i], hi = box.hi[i];
        if (d == 0.0) {
            if (o < lo || o > hi) return 0.0f;
            continue;
        }
        const double t_lo = (lo - o) / d, t_hi = (hi - o) / d;
        const int enter = d > 0.0 ? 2 * i : 2 * i + 1;
        if (std::min(t_lo, t_hi) > near) near = std::min(t_lo, t_hi), near_face = enter;
        if (std::max(t_lo, t_hi) < far) far = std::max(t_lo, t_hi), far_face = enter ^ 1;
    }
    if (!(near <= far)) return 0.0f;
    const float t = first_root(near, far, t_limit);
    face = t == static_cast<float>(near) ? near_face : far_face;
    return t;
}

// Lateral surface of a truncated cone, in double, from the ray's point nearest to the base, so that distance does not cancel.
inline float intersect_cone(const PreparedRay& ray, const Cone& cone, float t_limit) noexcept {
    const glm::dvec3 d(ray.direction), base(cone.base), from = glm::dvec3(ray.origin) - base;
    const glm::dvec3 axis = glm::dvec3(cone.apex) - base;
    const double h2 = glm::dot(axis, axis);
    const double shift = -glm::dot(from, d) / glm::dot(d, d);
    const glm::dvec3 f = from + shift * d;
    // Height along the axis (0 base, 1 apex) and radius there are linear in t, and so is what lies across the axis.
    const double s0 = glm::dot(f, axis) / h2, s1 = glm::dot(d, axis) / h2;
    const double slope = static_cast<double>(cone.apex_radius) - static_cast<double>(cone.base_radius);
    double r0 = cone.base_radius + slope * s0, r1 = slope * s1;
    glm::dvec3 p0 = f - s0 * axis, p1 = d - s1 * axis;
    // Through a flat cone the radius runs much faster than the ray; the height is the unknown then, or all digits would cancel.
    const bool by_height = slope * slope > 0x1p16 * h2 && r1 * r1 > 0x1p8 * glm::dot(p1, p1);
    if (by_height) {
        p0 -= (s0 / s1) * p1, p1 /= s1;
        r0 = cone.base_radius, r1 = slope;
    }
    const double a = glm::dot(p1, p1) - r1 * r1;
    const double b = -(glm::dot(p0, p1) - r0 * r1);
    const double c = glm::dot(p0, p0) - r0 * r0;
    const double discriminant = b * b - a * c;
    if (!(discriminant >= 0.0)) return 0.0f;
    const double q = b + std::copysign(std::sqrt(discriminant), b);
    const double root[2] = {c / q, q / a};  // a = 0 (parallel to the surface) leaves one finite root
    const double along[2] = {(by_height ? (root[0] - s0) / s1 : root[0]) + shift,
                             (by_height ? (root[1] - s0) / s1 : root[1]) + shift};
    // What rounding has put beside the surface by a good part of the bounds' padding is no hit: no box would hold it.
    const glm::dvec3 reach = glm::abs(from);
    const auto radius = static_cast<double>(std::max(cone.base_radius, cone.apex_radius));
    const double slack = 0x1p-21 * (std::max(reach.x, std::max(reach.y, reach.z)) + radius);
    const int first = along[0] <= along[1] ? 0 : 1;
    for (const int k : {first, 1 - first}) {
        if (!std::isfinite(along[k])) continue;
        const auto t = static_cast<float>(along[k]);
        const double height = by_height ? root[k] : s0 + s1 * root[k], r = r0 + r1 * root[k];
        const glm::dvec3 across = p0 + root[k] * p1;
        const bool on_cone = height >= 0.0 && height <= 1.0 && r >= 0.0 && glm::dot(across, across) <= (r + slack) * (r + slack);
        if (on_cone && reportable(t, t_limit)) return t;
    }
    return 0.0f;
}

// Returns t, or 0 for a miss; a parallel ray misses, in the plane or not.
inline float intersect_plane(const PreparedRay& ray, const Plane& plane, float t_limit) noexcept {
    const double slope = glm::dot(plane.normal, glm::dvec3(ray.direction));
    if (slope == 0.0) return 0.0f;
    const auto t = static_cast<float>(-(glm::dot(plane.normal, glm::dvec3(ray.origin)) + plane.offset) / slope);
    return reportable(t, t_limit) ? t : 0.0f;
}

// Tests primitive i of a kind and keeps the nearer hit in `best`; at equal t the lower id stays.
template <PrimitiveKind kind>
inline void intersect(const PreparedRay& ray, const Geometry& g, std::uint32_t i, Hit& best) noexcept {
    Hit hit;
    hit.primitive = make_id(kind, i);
    if constexpr (kind == PrimitiveKind::triangle) {
        const auto& index = g.triangles[i];
        TriangleHit h{};
        if (!intersect_triangle(ray, g.vertices[index[0]], g.vertices[index[1]], g.vertices[index[2]], best.t, h)) return;
        hit.t = h.t;
        hit.u = h.u;
        hit.v = h.v;
    } else if constexpr (kind == PrimitiveKind::sphere) {
        hit.t = intersect_sphere(ray, g.spheres[i], best.t);
    } else if constexpr (kind == PrimitiveKind::box) {
        int face = 0;
        hit.t = intersect_box(ray, g.boxes[i], best.t, face);
        hit.u = static_cast<float>(face);
    } else if constexpr (kind == PrimitiveKind::cone) {
        hit.t = intersect_cone(ray, g.cones[i], best.t);
    } else {
        hit.t = intersect_plane(ray, g.planes[i], best.t);
    }
    if (hit.t > 0.0f && (hit.t < best.t || hit.primitive < best.primitive)) best = hit;
}

inline void intersect(const PreparedRay& ray, const Geometry& g, PrimitiveId id, Hit& best) noexcept {
    const std::uint32_t i = index_of(id);
    switch (kind_of(id)) {
        case PrimitiveKind::triangle: return intersect<PrimitiveKind::triangle>(ray, g, i, best);
        case PrimitiveKind::sphere: return intersect<PrimitiveKind::sphere>(ray, g, i, best);
        case PrimitiveKind::box: return intersect<PrimitiveKind::box>(ray, g, i, best);
        case PrimitiveKind::cone: return intersect<PrimitiveKind::cone>(ray, g, i, best);
        case PrimitiveKind::plane: return intersect<PrimitiveKind::plane>(ray, g, i, best);
    }
}

// Starts a query: the ray's t_max as the distance to beat, and the infinite planes tested.
inline Hit begin_query(const PreparedRay& ray, const Geometry& g) noexcept {
    Hit best;
    best.t = ray.t_max;
    if (!ray.usable) return best;
    for (std::uint32_t i = 0; i < g.planes.size(); ++i) intersect<PrimitiveKind::plane>(ray, g, i, best);
    return best;
}

}  // namespace glint
