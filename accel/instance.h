// A mesh placed in the world: the affine map that takes rays into its own space, and the arithmetic of that step.
// Knows no accelerator. Invariant: every query goes through object_ray() or, operation for operation, the same in vectors, so
// all of them test the same bits. A ray's parameter t means the same in both spaces, because its direction is not normalised.
#pragma once

#include <optional>

#include "accel/ray.h"

namespace glint {

// p -> linear part * p + shift, by rows; the shift is the fourth column.
struct AffineMap {
    double row[3][4];

    [[nodiscard]] glm::dvec3 point(glm::dvec3 p) const;
    [[nodiscard]] glm::dvec3 vector(glm::dvec3 v) const;
    // Of a plane's normal where the map leads from the plane's space: n^T * linear part, the inverse's inverse transpose.
    [[nodiscard]] glm::dvec3 normal_before(glm::dvec3 n) const;
    // The largest sum of absolute values along a row of the linear part: how much the largest coordinate can grow.
    [[nodiscard]] double growth() const;
    // The largest absolute value of the shift.
    [[nodiscard]] double shift() const;
    [[nodiscard]] bool is_identity() const;
};

[[nodiscard]] AffineMap affine_map(const glm::dmat4& m);
// Adjugate over determinant, refined; of no meaning where there is no inverse.
[[nodiscard]] AffineMap inverse(const AffineMap& map);

// The two maps of an instance bend space by at most this much together, so that the rounding of double stays far below the
// error bounds, which count in units of float. Decides whether a mesh is placed or copied, never a hit.
constexpr double kMaxBend = 0x1p22;

// The inverse of a placement; nothing where it has none, or none to rely on: flat, non-finite, bent beyond kMaxBend.
[[nodiscard]] std::optional<AffineMap> object_from_world(const AffineMap& world_from_object);

struct Instance {
    AffineMap object_from_world;
    std::uint32_t prototype;  // index into Geometry::prototypes
    PrimitiveId first_id;     // its primitives have this and the following ids, in the order of their ids in the prototype
};

// Ids from here on are primitives of instances, so at equal t all others come first.
constexpr PrimitiveId kFirstInstancedId = kPrimitiveKinds << 29;
constexpr bool is_instanced(PrimitiveId id) { return id >= kFirstInstancedId; }

// Each sum from left to right in double, rounded once: an exact ray has no other image.
inline float map_point(const double (&r)[4], glm::vec3 p) noexcept {
    return static_cast<float>(
        ((r[0] * static_cast<double>(p.x) + r[1] * static_cast<double>(p.y)) + r[2] * static_cast<double>(p.z)) + r[3]);
}
inline float map_vector(const double (&r)[4], glm::vec3 v) noexcept {
    return static_cast<float>((r[0] * static_cast<double>(v.x) + r[1] * static_cast<double>(v.y)) +
                              r[2] * static_cast<double>(v.z));
}
inline Ray object_ray(const AffineMap& map, const Ray& ray, float t_max) noexcept {
    Ray r;
    for (int i = 0; i < 3; ++i) {
        r.origin[i] = map_point(map.row[i], ray.origin);
        r.direction[i] = map_vector(map.row[i], ray.direction);
    }
    r.t_max = t_max;
    return r;
}

}  // namespace glint
