// A ray made ready for the traversal in the instruction set of this compilation, and its test against the children of a node.
// Knows one ray at a time and no primitive. Invariant: the test is conservative, with the padding of primitive.h.
#pragma once

#include <cmath>

#include "accel/bvh_kernels.h"
#include "accel/primitive.h"
#include "accel/simd.h"

namespace glint::GLINT_ISA {

// Bytes of a row of BvhNode::bounds.
constexpr std::uint32_t kRow = sizeof(BvhNode{}.bounds[0]);

// What the tests derive from one ray; the same values as in PreparedRay. Three lanes of four are used.
struct alignas(16) RayScalars {
    float reciprocal[4], near_offset[4], far_offset[4];
    std::uint32_t near_row[4];  // of BvhNode::bounds, in bytes, those that the ray meets first; last = first ^ kRow
    float shear_x, shear_y, inverse_z;
    float o[3];  // the origin along kx, ky, kz
    int kx, ky, kz;
    unsigned octant;  // bit k set where direction[k] is not negative
    unsigned shift;   // into BvhNode::order, 3 * octant
    bool usable;
};

// o and d are read as four floats each, which Ray has behind both.
inline RayScalars prepare(const float* o, const float* d, float magnitude, float t_max) noexcept {
    RayScalars s;
    const __m128 sign = _mm_set1_ps(-0.0f), origin = _mm_loadu_ps(o), direction = _mm_loadu_ps(d);
    const __m128 a = _mm_andnot_ps(sign, direction), b = _mm_andnot_ps(sign, origin);
    // The dominant axis from a table of x >= y, y >= z, x >= z: a branch would be mispredicted for incoherent rays.
    static constexpr unsigned char kAxis[8] = {2, 2, 1, 1, 2, 0, 1, 0};
    const __m128 ge = _mm_cmpge_ps(_mm_shuffle_ps(a, a, _MM_SHUFFLE(0, 0, 1, 0)), _mm_shuffle_ps(a, a, _MM_SHUFFLE(0, 2, 2, 1)));
    s.kz = kAxis[static_cast<unsigned>(_mm_movemask_ps(ge)) & 7u];
    static constexpr unsigned char kNext[4] = {1, 2, 0, 1};
    s.kx = kNext[s.kz];
    s.ky = kNext[s.kz + 1];
    const auto largest_of_three = [](__m128 v) {
        const __m128 xy = _mm_max_ss(v, _mm_shuffle_ps(v, v, _MM_SHUFFLE(1, 1, 1, 1)));
        return _mm_max_ss(xy, _mm_shuffle_ps(v, v, _MM_SHUFFLE(2, 2, 2, 2)));
    };
    const float largest = _mm_cvtss_f32(largest_of_three(a));
    const float size = _mm_cvtss_f32(largest_of_three(b)) + magnitude;
    const __m128 sum = _mm_andnot_ps(sign, _mm_add_ps(origin, direction));
    const bool finite = (_mm_movemask_ps(_mm_cmple_ps(sum, _mm_set1_ps(3.402823466e38f))) & 7) == 7;
    s.usable = finite && t_max > 0.0f && largest >= 0x1p-86f && size <= 0x1p87f * largest;
    s.inverse_z = 1.0f / d[s.kz];
    s.shear_x = d[s.kx] * s.inverse_z;
    s.shear_y = d[s.ky] * s.inverse_z;
    const __m128 divisor = _mm_or_ps(_mm_max_ps(a, _mm_set1_ps(largest * 0x1p-40f)), _mm_and_ps(sign, direction));
    const __m128 r = _mm_div_ps(_mm_set1_ps(1.0f), divisor);
    const __m128 slack = _mm_mul_ps(_mm_set1_ps(kPadding * size), _mm_andnot_ps(sign, r)), shift = _mm_mul_ps(origin, r);
    _mm_store_ps(s.reciprocal, r);
    _mm_store_ps(s.near_offset, _mm_add_ps(shift, slack));
    _mm_store_ps(s.far_offset, _mm_sub_ps(shift, slack));
    s.octant = ~static_cast<unsigned>(_mm_movemask_ps(direction)) & 7u;
    s.shift = 3 * s.octant;
    _mm_store_si128(reinterpret_cast<__m128i*>(s.near_row),
                    _mm_or_si128(_mm_setr_epi32(0, 2 * kRow, 4 * kRow, 0),
                                 _mm_and_si128(_mm_srai_epi32(_mm_castps_si128(direction), 31), _mm_set1_epi32(kRow))));
    s.o[0] = o[s.kx];
    s.o[1] = o[s.ky];
    s.o[2] = o[s.kz];
    return s;
}

struct SlabRay {
    Float8 reciprocal[3], near_offset[3], far_offset[3];
    std::uint32_t near_row[3];
    unsigned shift;  // into BvhNode::order

    explicit SlabRay(const RayScalars& s) noexcept : shift(s.shift) {
        for (int i = 0; i < 3; ++i) {
            reciprocal[i] = Float8::set(s.reciprocal[i]);
            near_offset[i] = Float8::set(s.near_offset[i]);
            far_offset[i] = Float8::set(s.far_offset[i]);
            near_row[i] = s.near_row[i];
        }
    }
};

// Where the ray comes into each child and leaves it, or reaches `limit` within: it meets those with near <= far.
inline void slabs(const BvhNode& node, const SlabRay& ray, Float8 limit, Float8& near, Float8& far) noexcept {
    const auto row = [&](std::uint32_t at) {
        return Float8::load(reinterpret_cast<const float*>(reinterpret_cast<const char*>(node.bounds) + at));
    };
    Float8 n[3], f[3];
    for (int i = 0; i < 3; ++i) {
        n[i] = mul_sub(row(ray.near_row[i]), ray.reciprocal[i], ray.near_offset[i]);
        f[i] = mul_sub(row(ray.near_row[i] ^ kRow), ray.reciprocal[i], ray.far_offset[i]);
    }
    // 0 and limit are not negative, so whichever of several negative distances is taken, it decides alike.
    near = max_as_integers(max_as_integers(n[0], n[1]), max_as_integers(n[2], Float8::set(0.0f)));
    far = min_as_integers(min_as_integers(f[0], f[1]), min_as_integers(f[2], limit));
}
inline Float8::Mask enter(const BvhNode& node, const SlabRay& ray, Float8 limit, Float8& near) noexcept {
    Float8 far;
    slabs(node, ray, limit, near, far);
    return le(near, far);
}

// Asks memory for a whole node or leaf.
inline void fetch(const BvhView& bvh, BvhRef ref) noexcept {
    const auto* p = reinterpret_cast<const char*>(&bvh.at<BvhNode>(ref));
    _mm_prefetch(p, _MM_HINT_T0);
    _mm_prefetch(p + 64, _MM_HINT_T0);
    _mm_prefetch(p + 128, _MM_HINT_T0);
    _mm_prefetch(p + 192, _MM_HINT_T0);
    _mm_prefetch(p + 256, _MM_HINT_T0);
}

}  // namespace glint::GLINT_ISA
