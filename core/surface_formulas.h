// From a primitive and a ray to an exact point: the formulas, for one hit or for a loop over several, of which compilers make
// vector instructions. Everything is inlined: data that went through memory would be most of the time.
// Knows no scene. Invariant: computed in double, rounded to float once, at the end; the same bits in a loop and alone.
#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace glint::surface {

constexpr double kUlp = 0x1p-24;  // relative rounding error of one float operation

inline double largest(glm::dvec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }
inline glm::dvec3 unit(glm::dvec3 v) { return v / std::sqrt(glm::dot(v, v)); }

// Raw surface data in double before it is rounded and turned towards the viewer.
struct Exact {
    glm::dvec3 p{0.0}, ng{0.0, 0.0, 1.0}, ns{0.0, 0.0, 1.0};
    glm::dvec3 lift{0.0};  // see tangent_lift() and bend()
    double bend = 0.0;
    double reach = 0.0;  // size of the numbers that a later float intersection subtracts; 0 when that is done in double
};

// The same, rounded and turned.
struct Rounded {
    glm::vec3 p, ng, ns, lift;
    bool outside;
    float error, error_from_afar, bend;
};

// From the barycentric weights in double: on the plane exactly, however wrong t is.
[[gnu::always_inline]] inline glm::dvec3 weighted(double u, double v, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    return (1.0 - u - v) * a + u * b + v * c;
}

[[gnu::always_inline]] inline Exact on_triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, double u, double v) {
    Exact e;
    e.p = weighted(u, v, a, b, c);
    e.ng = e.ns = unit(glm::cross(b - a, c - a));
    // Later rays are tested in float on vertex - origin: the worst axis counts for all (the shear mixes them).
    e.reach = std::max(largest(a - e.p), std::max(largest(b - e.p), largest(c - e.p)));
    return e;
}

// The interpolated normal, or `ng` where the corners' normals cancel out.
[[gnu::always_inline]] inline glm::dvec3 shading_normal(glm::dvec3 ng, glm::dvec3 na, glm::dvec3 nb, glm::dvec3 nc, double u,
                                                        double v) {
    const glm::dvec3 n = weighted(u, v, na, nb, nc), smooth = unit(n);
    const bool any = glm::dot(n, n) > 0.0;
    return {any ? smooth.x : ng.x, any ? smooth.y : ng.y, any ? smooth.z : ng.z};
}

// The part of a tangent plane in tangent_lift(): from `p` to its foot on the plane through `corner`, as far as `p` lies behind.
[[gnu::always_inline]] inline glm::dvec3 up_to_plane(glm::dvec3 p, glm::dvec3 corner, glm::dvec3 n) {
    const double height = glm::dot(p - corner, n), share = height / glm::dot(n, n);
    const bool behind = (height < 0.0) & (share < 0.0);  // the latter is not so where the corner has no normal
    const double by = behind ? -share : 0.0;
    return {by * n.x, by * n.y, by * n.z};
}

// From a point of a facet to where the surface would be that the corners' normals belong to, seen from the side `d` comes from:
// the mean of the point's feet on the corners' tangent planes, by its weights; nothing where it lies before them all, since the
// facet bridges a hollow there (Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II ch. 4).
[[gnu::always_inline]] inline glm::dvec3 tangent_lift(const Exact& e, glm::dvec3 d, double u, double v, glm::dvec3 a,
                                                      glm::dvec3 b, glm::dvec3 c, glm::dvec3 na, glm::dvec3 nb, glm::dvec3 nc) {
    const double side = glm::dot(e.ng, d) < 0.0 ? 1.0 : -1.0;
    return weighted(u, v, up_to_plane(e.p, a, side * na), up_to_plane(e.p, b, side * nb), up_to_plane(e.p, c, side * nc));
}

// The sine of the largest angle between a facet and the surface that its corners' normals belong to.
[[gnu::always_inline]] inline double bend(glm::dvec3 ng, glm::dvec3 na, glm::dvec3 nb, glm::dvec3 nc) {
    const auto sine2 = [&ng](glm::dvec3 n) {
        const double along = glm::dot(n, ng), s = 1.0 - along * along / glm::dot(n, n);
        return s > 0.0 ? s : 0.0;  // also where there is no normal
    };
    return std::sqrt(std::max(sine2(na), std::max(sine2(nb), sine2(nc))));
}

[[gnu::always_inline]] inline Exact on_sphere(glm::dvec3 center, double radius, glm::dvec3 near) {
    Exact e;
    e.ng = e.ns = unit(near - center);
    e.p = center + radius * e.ng;
    return e;
}

// Units of 2^-24: what later intersections may misjudge, see SurfacePoint.
struct Errors {
    double near, from_afar;
};

// p and the spawned origin are each rounded once per coordinate (2 units in the 1-norm of n, at most 2 * 1.75);
// a float triangle test errs by about 8 units of the distances it subtracts.
// A ray that comes from a distance D (largest coordinate) and ends at t = 1: its direction is rounded twice in
// direction_to() and the hit's t once, each by a unit of the direction's length, so by at most sqrt(3) D along n: 6 units
// of D. A triangle test now subtracts distances up to reach + D, with the same 8 units as above.
[[gnu::always_inline]] inline Errors errors_in_world(const Exact& e) {
    return {4.0 * largest(e.p) + 8.0 * e.reach, e.reach > 0.0 ? 14.0 : 6.0};
}

// Rounds, turned towards the viewer, who looks along d.
[[gnu::always_inline]] inline Rounded finished(const Exact& e, const Errors& errors, glm::dvec3 d) {
    Rounded s;
    s.p = glm::vec3(e.p);
    s.outside = glm::dot(e.ng, d) < 0.0;
    const glm::dvec3 back_g = -e.ng, back_s = -e.ns;
    const glm::dvec3 ng(s.outside ? e.ng.x : back_g.x, s.outside ? e.ng.y : back_g.y, s.outside ? e.ng.z : back_g.z);
    const glm::dvec3 ns(s.outside ? e.ns.x : back_s.x, s.outside ? e.ns.y : back_s.y, s.outside ? e.ns.z : back_s.z);
    // An interpolated normal may lean past the silhouette; then only the geometric one is of use.
    const bool past = (glm::dot(ns, ng) <= 0.0) | (glm::dot(ns, d) >= 0.0);
    s.ng = glm::vec3(ng);
    s.ns = glm::vec3(glm::dvec3(past ? ng.x : ns.x, past ? ng.y : ns.y, past ? ng.z : ns.z));
    s.lift = glm::vec3(glm::dvec3(past ? 0.0 : e.lift.x, past ? 0.0 : e.lift.y, past ? 0.0 : e.lift.z));
    // Without a lift it means nothing.
    const bool lifted = (s.lift.x != 0.0f) | (s.lift.y != 0.0f) | (s.lift.z != 0.0f);
    s.bend = static_cast<float>(lifted ? e.bend : 0.0);
    s.error = static_cast<float>(kUlp * errors.near);
    s.error_from_afar = static_cast<float>(kUlp * errors.from_afar);
    return s;
}

[[gnu::always_inline]] inline Rounded finished(const Exact& e, glm::dvec3 d) { return finished(e, errors_in_world(e), d); }

}  // namespace glint::surface
