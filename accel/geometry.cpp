#include "accel/geometry.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace glint {
namespace {

// Beyond this squares of lengths overflow float (Embree's FLT_LARGE, 1.844e18).
constexpr float kLargestCoordinate = 1.0e18f;

bool usable(float x) { return std::abs(x) <= kLargestCoordinate; }  // false for NaN

// A box in float around an exact ball of double arithmetic: one float step outwards on each side.
Aabb rounded_outwards(glm::dvec3 lo, glm::dvec3 hi) {
    Aabb box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = std::nextafter(static_cast<float>(lo[i]), -kInfinity);
        box.hi[i] = std::nextafter(static_cast<float>(hi[i]), kInfinity);
    }
    return box;
}

Aabb ball_bounds(glm::vec3 center, float radius) {
    const glm::dvec3 c(center);
    const glm::dvec3 r(static_cast<double>(radius));
    return rounded_outwards(c - r, c + r);
}

}  // namespace

Prototype::Prototype(std::shared_ptr<const Geometry> shared)
    : geometry(std::move(shared)), bounds(geometry->own_bounds()), count(static_cast<std::uint32_t>(geometry->bounded_count())) {}

std::size_t Geometry::count(PrimitiveKind kind) const {
    switch (kind) {
        case PrimitiveKind::triangle: return triangles.size();
        case PrimitiveKind::sphere: return spheres.size();
        case PrimitiveKind::box: return boxes.size();
        case PrimitiveKind::cone: return cones.size();
        case PrimitiveKind::plane: return planes.size();
    }
    return 0;
}

Aabb Geometry::bounds(PrimitiveId id) const {
    const std::uint32_t i = index_of(id);
    Aabb box;
    switch (kind_of(id)) {
        case PrimitiveKind::triangle:
            for (const std::uint32_t v : triangles[i]) box.grow(vertices[v]);
            break;
        case PrimitiveKind::sphere: box = ball_bounds(spheres[i].center, spheres[i].radius); break;
        case PrimitiveKind::box: box = Aabb{boxes[i].lo, boxes[i].hi}; break;
        case PrimitiveKind::cone:
            // The ball around each end disk contains it; exact enough for a primitive without caps.
            box = ball_bounds(cones[i].base, cones[i].base_radius);
            box.grow(ball_bounds(cones[i].apex, cones[i].apex_radius));
            break;
        case PrimitiveKind::plane: break;
    }
    return box;
}

Aabb Geometry::own_bounds() const {
    Aabb box;
    for (const PrimitiveId id : bounded_ids()) box.grow(bounds(id));
    return box;
}

Aabb Geometry::bounds() const {
    Aabb box = own_bounds();
    for (const Instance& instance : instances) box.grow(instance_bounds(instance));
    return box;
}

bool Geometry::place(std::uint32_t prototype, const AffineMap& world_from_object) {
    const std::uint32_t count = prototypes[prototype].count;
    const std::optional<AffineMap> map = object_from_world(world_from_object);
    if (!map || count == 0) return false;
    PrimitiveId first = kFirstInstancedId;
    if (!instances.empty()) first = instances.back().first_id + prototypes[instances.back().prototype].count;
    const Instance instance{*map, prototype, first};
    if (!(instance_bounds(instance).magnitude() <= kLargestCoordinate)) return false;
    if (count > kNoPrimitive - first) throw std::length_error("too many primitives in instances");
    instances.push_back(instance);
    return true;
}

Located Geometry::locate(PrimitiveId id) const {
    if (!is_instanced(id)) return {this, nullptr, id};
    const auto behind = std::upper_bound(instances.begin(), instances.end(), id,
                                         [](PrimitiveId value, const Instance& i) { return value < i.first_id; });
    const Instance& instance = *(behind - 1);
    const Geometry& prototype = *prototypes[instance.prototype].geometry;
    std::uint32_t index = id - instance.first_id;
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box}) {
        const auto n = static_cast<std::uint32_t>(prototype.count(kind));
        if (index < n) return {&prototype, &instance, make_id(kind, index)};
        index -= n;
    }
    return {&prototype, &instance, make_id(PrimitiveKind::cone, index)};
}

std::uint32_t Geometry::rank(PrimitiveId id) const {
    std::uint32_t before = 0;
    for (std::uint32_t kind = 0; kind < static_cast<std::uint32_t>(kind_of(id)); ++kind)
        before += static_cast<std::uint32_t>(count(static_cast<PrimitiveKind>(kind)));
    return before + index_of(id);
}

std::size_t Geometry::seen_count() const {
    std::size_t n = bounded_count();
    for (const Instance& instance : instances) n += prototypes[instance.prototype].count;
    return n;
}

Aabb Geometry::instance_bounds(const Instance& instance) const {
    const Aabb& box = prototypes[instance.prototype].bounds;
    const AffineMap map = inverse(instance.object_from_world);
    const glm::dvec3 lo(box.lo), hi(box.hi);
    const glm::dvec3 centre = map.point(0.5 * lo + 0.5 * hi), half = 0.5 * hi - 0.5 * lo;
    // What the inverse may be wrong by: see object_from_world() for its linear part; its shift is a sum of products.
    const double slack =
        map.growth() * (0x1p-28 * static_cast<double>(box.magnitude()) + 0x1p-50 * instance.object_from_world.shift());
    glm::dvec3 reach;
    for (int i = 0; i < 3; ++i) {
        const auto& r = map.row[i];
        reach[i] = std::abs(r[0]) * half.x + std::abs(r[1]) * half.y + std::abs(r[2]) * half.z + slack;
    }
    return rounded_outwards(centre - reach, centre + reach);
}

std::vector<PrimitiveId> Geometry::bounded_ids() const {
    std::vector<PrimitiveId> ids;
    ids.reserve(bounded_count());
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone}) {
        const auto n = static_cast<std::uint32_t>(count(kind));
        for (std::uint32_t i = 0; i < n; ++i) ids.push_back(make_id(kind, i));
    }
    return ids;
}

bool valid_vertex(glm::vec3 v) { return usable(v.x) && usable(v.y) && usable(v.z); }

bool valid(const Sphere& s) { return valid_vertex(s.center) && usable(s.radius) && s.radius > 0.0f; }

bool valid(const Box& b) {
    return valid_vertex(b.lo) && valid_vertex(b.hi) && b.lo.x <= b.hi.x && b.lo.y <= b.hi.y && b.lo.z <= b.hi.z;
}

bool valid(const Cone& c) {
    return valid_vertex(c.base) && valid_vertex(c.apex) && usable(c.base_radius) && usable(c.apex_radius) &&
           c.base_radius >= 0.0f && c.apex_radius >= 0.0f && c.base_radius + c.apex_radius > 0.0f && c.base != c.apex;
}

bool valid(const Plane& p) {
    const double length2 = glm::dot(p.normal, p.normal);
    return length2 > 0.99 && length2 < 1.01 && std::isfinite(p.offset);
}

bool valid_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    if (!valid_vertex(a) || !valid_vertex(b) || !valid_vertex(c)) return false;
    const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    return n != glm::dvec3(0.0);
}

Plane plane_through(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length = std::sqrt(glm::dot(n, n));
    if (!(length > 0.0)) return Plane{glm::dvec3(0.0), 0.0};
    const glm::dvec3 unit = n / length;
    return Plane{unit, -glm::dot(unit, a)};
}

}  // namespace glint
