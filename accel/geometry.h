// Flat arrays of primitives: what the accelerators index. Built once, then immutable and shared.
// Knows only shapes; what a primitive is made of is looked up by its id elsewhere.
// Invariant: every primitive passed `valid()`, so its coordinates are finite and its bounds are not empty. Instances come from
// place(); their prototypes hold neither planes nor instances.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "accel/instance.h"
#include "accel/ray.h"

namespace glint {

struct Sphere {
    glm::vec3 center;
    float radius;  // > 0
};

struct Box {
    glm::vec3 lo, hi;  // lo <= hi on each axis; a flat box is allowed
};

// Truncated cone or cylinder without caps, from `base` to `apex`.
struct Cone {
    glm::vec3 base;
    float base_radius;
    glm::vec3 apex;
    float apex_radius;
};

// Points x with dot(normal, x) + offset = 0; infinite, so it lives beside the accelerators, never in them.
struct Plane {
    glm::dvec3 normal;  // unit
    double offset;
};

struct Geometry;

// Where a hit primitive is stored.
struct Located {
    const Geometry* geometry;  // the world or a prototype
    const Instance* instance;  // null in the world
    PrimitiveId id;            // in that geometry: kind and index
};

// A mesh that instances share.
struct Prototype {
    std::shared_ptr<const Geometry> geometry;
    Aabb bounds;
    std::uint32_t count = 0;  // its primitives

    explicit Prototype(std::shared_ptr<const Geometry> shared);
};

struct Geometry {
    std::vector<glm::vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into vertices
    std::vector<Sphere> spheres;
    std::vector<Box> boxes;
    std::vector<Cone> cones;
    std::vector<Plane> planes;
    // Meshes that are stored once and placed any number of times.
    std::vector<Prototype> prototypes;
    std::vector<Instance> instances;  // in ascending order of first_id

    // Places a prototype. False where the map cannot be relied on (object_from_world()) or the result would reach beyond 1e18.
    // Throws std::length_error when the ids run out.
    bool place(std::uint32_t prototype, const AffineMap& world_from_object);
    [[nodiscard]] Located locate(PrimitiveId id) const;
    // Where a primitive of a prototype stands among its ids in an instance, which are counted without gaps.
    [[nodiscard]] std::uint32_t rank(PrimitiveId id) const;
    // Primitives with bounds of the world and of all instances, each counted as often as it is seen.
    [[nodiscard]] std::size_t seen_count() const;
    // Conservative bounds of an instance: of its prototype's box.
    [[nodiscard]] Aabb instance_bounds(const Instance& instance) const;

    // The others know the world's own primitives, not those of instances.
    // Number of primitives that have bounds (all but planes).
    [[nodiscard]] std::size_t bounded_count() const { return triangles.size() + spheres.size() + boxes.size() + cones.size(); }
    [[nodiscard]] std::size_t count(PrimitiveKind kind) const;
    // Conservative bounds: no point of the primitive lies outside. Not for planes.
    [[nodiscard]] Aabb bounds(PrimitiveId id) const;
    // Bounds of everything but planes and instances; empty when there is nothing else.
    [[nodiscard]] Aabb own_bounds() const;
    // Bounds of everything but planes.
    [[nodiscard]] Aabb bounds() const;
    // Ids of all bounded primitives in ascending order.
    [[nodiscard]] std::vector<PrimitiveId> bounded_ids() const;
};

// False for a primitive that no query can answer for: non-finite or beyond 1e18 (squares overflow), radius <= 0,
// a triangle of zero area, an inverted box, a cone without length. Readers drop such primitives with a warning.
[[nodiscard]] bool valid(const Sphere& s);
[[nodiscard]] bool valid(const Box& b);
[[nodiscard]] bool valid(const Cone& c);
[[nodiscard]] bool valid(const Plane& p);
[[nodiscard]] bool valid_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c);
[[nodiscard]] bool valid_vertex(glm::vec3 v);

// The plane through three points, front where they run counter-clockwise. An invalid plane if they are collinear.
[[nodiscard]] Plane plane_through(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c);

}  // namespace glint
