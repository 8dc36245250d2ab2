// A ray with what every test derives from it, and its interval through padded bounds.
// Knows no primitive. Invariant: whatever primitive.h reports lies in that interval, so that a box test by the same arithmetic
// can never cull a hit.
#pragma once

#include "accel/geometry.h"
#include "accel/ray.h"

namespace glint {

// Computed once per query.
struct PreparedRay {
    glm::vec3 origin, direction;
    float t_max;
    // Slab tests: t = plane * reciprocal - offset; the offsets push the interval outwards by the rounding error (below).
    glm::vec3 reciprocal, near_offset, far_offset;
    // Watertight triangles: the axes, permuted so that |direction[kz]| is largest, and the shear that maps the ray to +z.
    int kx, ky, kz;
    float shear_x, shear_y, inverse_z;
    bool usable;  // false for a non-finite or (nearly) zero direction: such a ray hits nothing

    // magnitude: the largest absolute coordinate of the geometry the ray will meet.
    PreparedRay(const Ray& ray, float magnitude) noexcept;
};

// How far a computed hit may stray from the exact ray, in units of origin and geometry: the rounding errors of all tests,
// summed in accel/README.md.
constexpr float kPadding = 40.0f * 0x1p-24f;

struct Interval {
    float near, far;
    [[nodiscard]] bool empty() const { return !(near <= far); }
};

inline PreparedRay::PreparedRay(const Ray& ray, float magnitude) noexcept
    : origin(ray.origin), direction(ray.direction), t_max(ray.t_max) {
    const glm::vec3 a = glm::abs(direction);
    kz = a.x >= a.y ? (a.x >= a.z ? 0 : 2) : (a.y >= a.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    const float largest = a[kz];
    const glm::vec3 sum = origin + direction;
    const float size = std::max(std::max(std::abs(origin.x), std::abs(origin.y)), std::abs(origin.z)) + magnitude;
    // A direction so short that a slab's arithmetic overflows counts as zero. With what is left no slab is ever NaN.
    usable = std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z) && t_max > 0.0f && largest >= 0x1p-86f &&
             size <= 0x1p87f * largest;
    if (!usable) {
        reciprocal = near_offset = far_offset = glm::vec3(0.0f);
        shear_x = shear_y = inverse_z = 0.0f;
        return;
    }
    inverse_z = 1.0f / direction[kz];
    shear_x = direction[kx] * inverse_z;
    shear_y = direction[ky] * inverse_z;
    // A zero component would give 0 * inf = NaN. 2^-40 of the largest moves the ray by less than 2^-40 of the scene
    // inside its bounds, far below the padding.
    const float smallest = largest * 0x1p-40f;
    const float padding = kPadding * size;
    for (int i = 0; i < 3; ++i) {
        const float d = a[i] >= smallest ? direction[i] : std::copysign(smallest, direction[i]);
        reciprocal[i] = 1.0f / d;
        const float slack = padding * std::abs(reciprocal[i]);
        const float shift = origin[i] * reciprocal[i];
        near_offset[i] = shift + slack;
        far_offset[i] = shift - slack;
    }
}

// The ray parameters between which the ray may be inside `box`, pushed outwards. Monotone in the box: a larger box gives
// a larger interval, bit for bit, because every operation rounds monotonically.
inline Interval slab_interval(const PreparedRay& ray, const Aabb& box) noexcept {
    Interval interval{-kInfinity, kInfinity};
    for (int i = 0; i < 3; ++i) {
        const bool forward = ray.reciprocal[i] >= 0.0f;
        const float near = (forward ? box.lo[i] : box.hi[i]) * ray.reciprocal[i] - ray.near_offset[i];
        const float far = (forward ? box.hi[i] : box.lo[i]) * ray.reciprocal[i] - ray.far_offset[i];
        interval.near = near > interval.near ? near : interval.near;
        interval.far = far < interval.far ? far : interval.far;
    }
    return interval;
}

// Whether a hit at t counts. A subnormal t has lost the precision that every error bound relies on.
inline bool reportable(float t, float limit) noexcept {
    return t >= std::numeric_limits<float>::min() && t <= limit && t < kInfinity;
}

}  // namespace glint
