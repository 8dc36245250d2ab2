// A ray made ready for the traversal in the instruction set of this compilation, and its test against the children of a node.
// Knows one ray at a time and no primitive. Invariant: the test is conservative, with the padding of primitive.h.
#pragma once

#include <cmath>

#include "accel/bvh_kernels.h"
#include "accel/primitive.h"
#include "accel/simd.h"

namespace glint::GLINT_ISA {

// Scalars of one ray; the same values as in PreparedRay.
struct RayScalars {
    float reciprocal[3], near_offset[3], far_offset[3];
    float shear_x, shear_y, inverse_z;
    int kx, ky, kz;
    unsigned octant;  // bit k set where direction[k] is not negative
    bool usable;
};

inline RayScalars prepare(const float* o, const float* d, float magnitude, float t_max) noexcept {
    RayScalars s;
    const float ax = std::fabs(d[0]), ay = std::fabs(d[1]), az = std::fabs(d[2]);
    // The dominant axis from a table: a branch would be mispredicted for incoherent rays.
    static constexpr unsigned char kAxis[8] = {2, 2, 2, 0, 1, 2, 1, 0};
    s.kz = kAxis[static_cast<unsigned>(ax >= ay) | static_cast<unsigned>(ax >= az) << 1 | static_cast<unsigned>(ay >= az) << 2];
    static constexpr unsigned char kNext[4] = {1, 2, 0, 1};
    s.kx = kNext[s.kz];
    s.ky = kNext[s.kz + 1];
    const float largest = std::fabs(d[s.kz]);
    const float ox = std::fabs(o[0]), oy = std::fabs(o[1]), oz = std::fabs(o[2]);
    const float oxy = ox < oy ? oy : ox;
    const float size = (oxy < oz ? oz : oxy) + magnitude;
    const float sum = (o[0] + d[0]) + (o[1] + d[1]) + (o[2] + d[2]);
    s.usable = std::fabs(sum) <= 3.402823466e38f && t_max > 0.0f && largest >= 0x1p-86f && size <= 0x1p87f * largest;
    s.inverse_z = 1.0f / d[s.kz];
    s.shear_x = d[s.kx] * s.inverse_z;
    s.shear_y = d[s.ky] * s.inverse_z;
    const float smallest = largest * 0x1p-40f, padding = kPadding * size;
    s.octant = 0;
    for (int i = 0; i < 3; ++i) {
        const float a = std::fabs(d[i]);
        const float r = 1.0f / __builtin_copysignf(a >= smallest ? a : smallest, d[i]);
        const float slack = padding * std::fabs(r), shift = o[i] * r;
        s.reciprocal[i] = r;
        s.near_offset[i] = shift + slack;
        s.far_offset[i] = shift - slack;
        s.octant |= (r >= 0.0f ? 1u : 0u) << i;
    }
    return s;
}

// Where each octant finds, in BvhNode::bounds, the rows that a ray meets first; last = first ^ 1.
inline int near_row(unsigned octant, int axis) noexcept { return 2 * axis + ((octant >> axis & 1u) != 0 ? 0 : 1); }

struct SlabRay {
    Float8 reciprocal[3], near_offset[3], far_offset[3];
    int near_row[3];
    unsigned shift;  // into BvhNode::order

    explicit SlabRay(const RayScalars& s) noexcept : shift(3 * s.octant) {
        for (int i = 0; i < 3; ++i) {
            reciprocal[i] = Float8::set(s.reciprocal[i]);
            near_offset[i] = Float8::set(s.near_offset[i]);
            far_offset[i] = Float8::set(s.far_offset[i]);
            near_row[i] = GLINT_ISA::near_row(s.octant, i);
        }
    }
};

// Bits of the children that the ray may enter before `limit`, and where.
inline unsigned enter(const BvhNode& node, const SlabRay& ray, Float8 limit, Float8& near) noexcept {
    Float8 n[3], f[3];
    for (int i = 0; i < 3; ++i) {
        n[i] = mul_sub(Float8::load(node.bounds[ray.near_row[i]]), ray.reciprocal[i], ray.near_offset[i]);
        f[i] = mul_sub(Float8::load(node.bounds[ray.near_row[i] ^ 1]), ray.reciprocal[i], ray.far_offset[i]);
    }
    near = max(max(n[0], n[1]), max(n[2], Float8::set(0.0f)));
    return le(near, min(min(f[0], f[1]), min(f[2], limit))).bits();
}

}  // namespace glint::GLINT_ISA
