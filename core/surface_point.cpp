#include "core/surface_point.h"

#include <cmath>

#include "core/surface_formulas.h"

namespace glint {
namespace {

using namespace surface;

inline Exact on_triangle_of(const Geometry& g, const std::vector<glm::vec3>& normals, std::uint32_t i, const Hit& hit,
                            const glm::dvec3& d) {
    const auto& index = g.triangles[i];
    const auto corner = [&](const std::vector<glm::vec3>& of, std::size_t k) { return glm::dvec3(of[index[k]]); };
    const double u = static_cast<double>(hit.u), v = static_cast<double>(hit.v);
    const glm::dvec3 a = corner(g.vertices, 0), b = corner(g.vertices, 1), c = corner(g.vertices, 2);
    Exact e = on_triangle(a, b, c, u, v);
    if (normals.empty()) return e;
    const glm::dvec3 na = corner(normals, 0), nb = corner(normals, 1), nc = corner(normals, 2);
    e.ns = shading_normal(e.ng, na, nb, nc, u, v);
    e.lift = tangent_lift(e, d, u, v, a, b, c, na, nb, nc);
    e.bend = bend(e.ng, na, nb, nc);
    return e;
}

inline Exact on_sphere_of(const Sphere& s, glm::dvec3 near) {
    return on_sphere(glm::dvec3(s.center), static_cast<double>(s.radius), near);
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

[[gnu::always_inline]] inline void finish(const Exact& e, const Errors& errors, const glm::dvec3& d, SurfacePoint& s) {
    const Rounded r = finished(e, errors, d);
    s.p = r.p;
    s.ng = r.ng;
    s.ns = r.ns;
    s.lift = r.lift;
    s.bend = r.bend;
    s.outside = r.outside;
    s.error = r.error;
    s.error_from_afar = r.error_from_afar;
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
    e.lift = world_from_object.vector(e.lift);  // planes stay planes, so it leads to the moved smooth surface
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
        case PrimitiveKind::triangle: e = on_triangle_of(g, surfaces.normals, i, hit, glm::dvec3(own.direction)); break;
        case PrimitiveKind::sphere: e = on_sphere_of(g.spheres[i], near); break;
        case PrimitiveKind::box: e = on_box(g.boxes[i], near, static_cast<int>(hit.u)); break;
        case PrimitiveKind::cone: e = on_cone(g.cones[i], near); break;
        case PrimitiveKind::plane: break;  // no prototype holds any
    }
    s.material = surfaces.material(at.id);
    // The identity rounds nothing: the answer is that of the same primitive in the world.
    const bool moved = !map.is_identity();
    const Errors errors = moved ? move_to_world(map, g.bounds(at.id), e) : errors_in_world(e);
    if (moved && e.bend > 0.0) {
        const auto normal = [&](std::size_t k) { return map.normal_before(glm::dvec3(surfaces.normals[g.triangles[i][k]])); };
        e.bend = bend(e.ng, normal(0), normal(1), normal(2));
    }
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
        case PrimitiveKind::triangle: return finish(on_triangle_of(g, scene.normals, i, hit, d), d, s);
        case PrimitiveKind::sphere: return finish(on_sphere_of(g.spheres[i], near), d, s);
        case PrimitiveKind::box: return finish(on_box(g.boxes[i], near, static_cast<int>(hit.u)), d, s);
        case PrimitiveKind::cone: return finish(on_cone(g.cones[i], near), d, s);
        case PrimitiveKind::plane: return finish(on_plane(g.planes[i], near), d, s);
    }
}

}  // namespace glint
