// Rays against spheres in float: what is certain, so that double decides only what lies close to a silhouette or an end.
// Knows no tree. Invariant: lanes that the arithmetic of primitive.h hits are among `maybe`, and it hits all of `surely`.
#pragma once

#include "accel/simd.h"

namespace glint::GLINT_ISA {

constexpr float kLeastT = 1.17549435e-38f, kLargestT = 3.402823466e38f;

// Rays as (shear_x, shear_y, 1) have no length that could overflow.
template <class V>
struct ShearedRays {
    V shear_x, shear_y;
    V inverse_length2;  // of (shear_x, shear_y, 1); only good to some units of 2^-24
    V d_z;              // along the dominant axis
    V t;                // distance to beat

    static V inverse_of(V shear_x, V shear_y) noexcept {
        return V::set(1.0f) / ((shear_x * shear_x + shear_y * shear_y) + V::set(1.0f));
    }
};

template <class V>
struct SphereLanes {
    typename V::Mask maybe;   // may hit
    typename V::Mask surely;  // of them, must; none where t is to be known
};

// fx, fy, minus_fz: centre - origin, the last one negative. By the distance between the centre and the ray up to t: a hit lies on
// that part, at distance r; and a ray that starts outside and comes nearer than r enters on it. Positions are wrong by at most
// 32 units of 2^-24 of f (f good to 1, the direction to 3, the place of least distance to 15, its end to 2, the sum to 4, the
// squares to 4, double's own arithmetic, at most a root of 2^-48, to 1). Squares stray by a few of the least float.
template <bool any, class V>
inline SphereLanes<V> near_spheres(V fx, V fy, V minus_fz, V r, const ShearedRays<V>& rays) noexcept {
    const V zero = V::set(0.0f), below = V::set(-4.0f * kLeastT);
    const V middle = mul_sub(fx, rays.shear_x, neg_mul_add(fy, rays.shear_y, minus_fz)) * rays.inverse_length2;
    const V end = rays.t * rays.d_z, z = min(max(middle, min(end, zero)), max(end, zero));
    const auto minus_square = [](V x, V y, V w) {
        return neg_mul_add(x, x, neg_mul_add(y, y, neg_mul_add(w, w, V::set(-kLeastT))));
    };
    const V minus_distance2 = minus_square(mul_sub(z, rays.shear_x, fx), mul_sub(z, rays.shear_y, fy), z + minus_fz);
    // The second term keeps what surely hits at a t that is not subnormal.
    const V margin = mul_sub(abs(fx) + abs(fy) + abs(minus_fz), V::set(40.0f * 0x1p-24f), abs(rays.d_z) * V::set(-0x1p-120f));
    const V outer = r + margin, inner = r - margin, outer2 = outer * outer;
    const auto all = V::Mask::from_bits((1u << V::kLanes) - 1), none = V::Mask::from_bits(0);
    const auto maybe = all - lt(outer2 + minus_distance2, below);
    if constexpr (!any) return {maybe, none};
    const auto enters = lt(zero, inner) & lt(zero, inner * inner + minus_distance2);
    return {maybe, maybe & enters & lt(outer2 + minus_square(fx, fy, minus_fz), below)};
}

}  // namespace glint::GLINT_ISA
