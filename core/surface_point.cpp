#include "core/surface_point.h"

#include <cmath>

namespace glint {
namespace {

constexpr double kUlp = 0x1p-24;  // relative rounding error of one float operation

double largest(glm::dvec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }
glm::dvec3 unit(glm::dvec3 v) { return v / std::sqrt(glm::dot(v, v)); }

// Raw surface data in double before it is rounded and turned towards the viewer.
struct Exact {
    glm::dvec3 p{0.0}, ng{0.0, 0.0, 1.0}, ns{0.0, 0.0, 1.0};
    double reach = 0.0;  // size of the numbers that a later float intersection subtracts; 0 when that is done in double
};

inline Exact on_triangle(const Geometry& g, const std::vector<glm::vec3>& normals, std::uint32_t i, const Hit& hit) {
    const auto& index = g.triangles[i];
    const glm::dvec3 a(g.vertices[index[0]]), b(g.vertices[index[1]]), c(g.vertices[index[2]]);
    // From the barycentric weights in double: on the plane exactly, however wrong t is.
    const double u = hit.u, v = hit.v;
    const glm::dvec3 p = (1.0 - u - v) * a + u * b + v * c;
    const glm::dvec3 ng = unit(glm::cross(b - a, c - a));
    // Later rays are tested in float on vertex - origin: the worst axis counts for all (the shear mixes them).
    const double reach = std::max(largest(a - p), std::max(largest(b - p), largest(c - p)));
    glm::dvec3 ns = ng;
    if (!normals.empty()) {
        const glm::dvec3 n =
            (1.0 - u - v) * glm::dvec3(normals[index[0]]) + u * glm::dvec3(normals[index[1]]) + v * glm::dvec3(normals[index[2]]);
        if (glm::dot(n, n) > 0.0) ns = unit(n);
    }
    return {p, ng, ns, reach};
}

Exact on_sphere(const Sphere& s, glm::dvec3 near) {
    Exact e;
    e.ng = e.ns = unit(near - glm::dvec3(s.center));
    e.p = glm::dvec3(s.center) + static_cast<double>(s.radius) * e.ng;
    return e;
}

Exact on_box(const Box& box, glm::dvec3 near, int face) {
    Exact e;
    const int axis = face / 2;
    const bool high = face % 2 == 1;
    e.p = glm::clamp(near, glm::dvec3(box.lo), glm::dvec3(box.hi));
    e.p[axis] = high ? box.hi[axis] : box.lo[axis];
    e.ng = glm::dvec3(0.0);
    e.ng[axis] = high ? 1.0 : -1.0;
    e.ns = e.ng;
    return e;
}

Exact on_cone(const Cone& cone, glm::dvec3 near) {
    const glm::dvec3 base(cone.base), axis = glm::dvec3(cone.apex) - base;
    const double h2 = glm::dot(axis, axis);
    const double s = glm::dot(near - base, axis) / h2;
    const double slope = static_cast<double>(cone.apex_radius) - static_cast<double>(cone.base_radius);
    const double radius = cone.base_radius + slope * s;
    const glm::dvec3 centre = base + s * axis;
    const glm::dvec3 radial = near - centre;
    const double length = std::sqrt(glm::dot(radial, radial));
    Exact e;
    // The tip itself has no radial direction; its normal points along the axis.
    const glm::dvec3 r = length > 0.0 ? radial / length : unit(axis);
    e.p = centre + radius * r;
    e.ng = e.ns = unit(r - axis * (slope / h2));
    return e;
}

Exact on_plane(const Plane& plane, glm::dvec3 near) {
    Exact e;
    e.p = near - plane.normal * (glm::dot(plane.normal, near) + plane.offset);
    e.ng = e.ns = plane.normal;
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
inline Errors errors_in_world(const Exact& e) { return {4.0 * largest(e.p) + 8.0 * e.reach, e.reach > 0.0 ? 14.0 : 6.0}; }

// Rounds, turned towards the viewer. Inlined behind each kind of primitive: an Exact that went through memory would be most of
// the time.
[[gnu::always_inline]] inline void finish(Exact e, const Errors& errors, const glm::dvec3& d, SurfacePoint& s) {
    s.p = glm::vec3(e.p);
    s.outside = glm::dot(e.ng, d) < 0.0;
    if (!s.outside) e.ng = -e.ng, e.ns = -e.ns;
    // An interpolated normal may lean past the silhouette; then only the geometric one is of use.
    if (glm::dot(e.ns, e.ng) <= 0.0 || glm::dot(e.ns, d) >= 0.0) e.ns = e.ng;
    s.ng = glm::vec3(e.ng);
    s.ns = glm::vec3(e.ns);
    s.error = static_cast<float>(kUlp * errors.near);
    s.error_from_afar = static_cast<float>(kUlp * errors.from_afar);
}
[[gnu::always_inline]] inline void finish(const Exact& e, const glm::dvec3& d, SurfacePoint& s) {
    finish(e, errors_in_world(e), d, s);
}

// From the space of an instance into the world, where `e` is the same point afterwards. `box` bounds the primitive there.
// Heights above the surface count `scale` times as much in the world. A later ray's origin and direction are rounded in the
// instance's space, by 2 units of the point's coordinates and of the way within the primitive; the direction may besides lean
// below the normal by the rounding of the latter, 2 units of the way in the world. One more of each for what is left out.
Errors move_to_world(const AffineMap& object_from_world, const Aabb& box, Exact& e) {
    const AffineMap world_from_object = inverse(object_from_world);
    const glm::dvec3 own = e.p, n = object_from_world.normal_before(e.ng);
    const double scale = 1.0 / std::sqrt(glm::dot(n, n)), test = e.reach > 0.0 ? 8.0 : 0.0;
    e.p = world_from_object.point(own);
    // Where the inverse is inexact the rays are right, which use the other map.
    e.p -= world_from_object.vector(object_from_world.point(e.p) - own);
    e.ng = n * scale;
    e.ns = unit(object_from_world.normal_before(e.ns));
    const glm::dvec3 size = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    double way = 0.0;
    for (const auto& r : world_from_object.row)
        way = std::max(way, std::abs(r[0]) * size.x + std::abs(r[1]) * size.y + std::abs(r[2]) * size.z);
    return {4.0 * largest(e.p) + 3.0 * way + scale * (3.0 * largest(own) + 3.0 * largest(size) + test * e.reach),
            6.0 + scale * object_from_world.growth() * (4.0 + test)};
}

// Apart from the rest, which must not pay for it.
[[gnu::noinline]] void find_on_instance(const Scene& scene, const Ray& ray, const Hit& hit, SurfacePoint& s) {
    const Located at = scene.geometry->locate(hit.primitive);
    const AffineMap& map = at.instance->object_from_world;
    const Surfaces& surfaces = scene.surfaces(at);
    const Geometry& g = *at.geometry;
    const Ray own = object_ray(map, ray, hit.t);
    const glm::dvec3 near = glm::dvec3(own.origin) + static_cast<double>(hit.t) * glm::dvec3(own.direction);
    const std::uint32_t i = index_of(at.id);
    Exact e{};
    switch (kind_of(at.id)) {
        case PrimitiveKind::triangle: e = on_triangle(g, surfaces.normals, i, hit); break;
        case PrimitiveKind::sphere: e = on_sphere(g.spheres[i], near); break;
        case PrimitiveKind::box: e = on_box(g.boxes[i], near, static_cast<int>(hit.u)); break;
        case PrimitiveKind::cone: e = on_cone(g.cones[i], near); break;
        case PrimitiveKind::plane: break;  // no prototype holds any
    }
    s.material = surfaces.material(at.id);
    // The identity rounds nothing: the answer is that of the same primitive in the world.
    const Errors errors = map.is_identity() ? errors_in_world(e) : move_to_world(map, g.bounds(at.id), e);
    finish(e, errors, glm::dvec3(ray.direction), s);
}

}  // namespace

void find_surface_point(const Scene& scene, glm::vec3 origin, glm::vec3 direction, const Hit& hit, SurfacePoint& s) noexcept {
    if (is_instanced(hit.primitive)) return find_on_instance(scene, {origin, direction, hit.t}, hit, s);
    const Geometry& g = *scene.geometry;
    const std::uint32_t i = index_of(hit.primitive);
    s.material = scene.material_of[static_cast<std::size_t>(kind_of(hit.primitive))][i];
    const glm::dvec3 d(direction), near = glm::dvec3(origin) + static_cast<double>(hit.t) * d;
    switch (kind_of(hit.primitive)) {
        case PrimitiveKind::triangle: return finish(on_triangle(g, scene.normals, i, hit), d, s);
        case PrimitiveKind::sphere: return finish(on_sphere(g.spheres[i], near), d, s);
        case PrimitiveKind::box: return finish(on_box(g.boxes[i], near, static_cast<int>(hit.u)), d, s);
        case PrimitiveKind::cone: return finish(on_cone(g.cones[i], near), d, s);
        case PrimitiveKind::plane: return finish(on_plane(g.planes[i], near), d, s);
    }
}

}  // namespace glint
