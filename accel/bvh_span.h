// Gathers sixteen rays of a batch into a group and finds the space that they span.
// Invariant: gather() says no where the group's arithmetic would not hold for every ray: other dominant axes or signs, unusable
// rays, numbers beyond float. Such rays go one by one.
#pragma once

#include "accel/bvh_group.h"

namespace glint::GLINT_ISA {

// Whether all lanes are usable rays (as prepare() says) whose direction is longest along axis k, with one sign.
inline bool share_axis(const Group& g, int k, bool forward, Float16 largest_origin, Float16 t_max) noexcept {
    const Float16 a[3] = {abs(g.d[0]), abs(g.d[1]), abs(g.d[2])}, zero = Float16::set(0.0f), most = Float16::set(kLargestT);
    const auto x_y = le(a[1], a[0]), x_z = le(a[2], a[0]), y_z = le(a[2], a[1]);
    const auto all = Float16::Mask::from_bits(0xffffu);
    const auto mine = k == 0 ? x_y & x_z : k == 1 ? y_z - x_y : all - ((x_y & x_z) | (y_z - x_y));
    const auto sign = forward ? lt(zero, g.d[k]) : lt(g.d[k], zero);
    const auto finite = le(abs(g.o[0] + g.d[0]), most) & le(abs(g.o[1] + g.d[1]), most) & le(abs(g.o[2] + g.d[2]), most);
    const auto sized = le(Float16::set(0x1p-86f), a[k]) & le(largest_origin, Float16::set(0x1p87f) * a[k]);
    return (mine & sign & finite & sized & lt(zero, t_max)).bits() == 0xffffu;
}

// The planes through the rays' extreme positions at two depths; between these no ray leaves them, because it runs straight.
inline bool bound_by_planes(const Extent& e, float za, float zb, float padding, SpanPlane& lo, SpanPlane& hi) noexcept {
    const float size = std::fabs(za) < std::fabs(zb) ? std::fabs(zb) : std::fabs(za), scale = 1.0f / (zb - za);
    const auto plane = [&](float a, float b, float side) {
        SpanPlane p;
        p.slope = (b - a) * scale;
        p.offset = (a - p.slope * za) + side * (padding + kPadding * std::fabs(p.slope) * size);
        return p;
    };
    lo = plane(e.lo_a, e.lo_b, -1.0f);
    hi = plane(e.hi_a, e.hi_b, 1.0f);
    return std::fabs(lo.offset) <= kLargestT && std::fabs(hi.offset) <= kLargestT;
}

inline bool bound_by_planes(Span& s) noexcept {
    return bound_by_planes(s.x, s.za, s.zb, s.padding, s.lo_x, s.hi_x) &&
           bound_by_planes(s.y, s.za, s.zb, s.padding, s.lo_y, s.hi_y);
}

// The span of all `count` groups together; false where they do not lie side by side or do not share axis and depths.
inline bool join(const Span* parts, int count, Span& all) noexcept {
    all = parts[0];
    const auto width = [](const Extent& e) { return e.hi_b - e.lo_b; };
    float sum_x = width(all.x), sum_y = width(all.y);
    const auto grow = [](Extent& e, const Extent& by) {
        e.lo_a = by.lo_a < e.lo_a ? by.lo_a : e.lo_a;
        e.hi_a = by.hi_a > e.hi_a ? by.hi_a : e.hi_a;
        e.lo_b = by.lo_b < e.lo_b ? by.lo_b : e.lo_b;
        e.hi_b = by.hi_b > e.hi_b ? by.hi_b : e.hi_b;
    };
    for (int i = 1; i < count; ++i) {
        const Span& p = parts[i];
        if (p.kz != all.kz || p.forward != all.forward || p.za != all.za || p.zb != all.zb) return false;
        grow(all.x, p.x);
        grow(all.y, p.y);
        sum_x += width(p.x);
        sum_y += width(p.y);
        all.shears.grow(p.shears);
        all.z_start = p.z_start < all.z_start ? p.z_start : all.z_start;
        all.padding = p.padding > all.padding ? p.padding : all.padding;
    }
    // Jittered samples leave gaps between pixels, hence the half.
    return width(all.x) <= 1.5f * sum_x && width(all.y) <= 1.5f * sum_y && bound_by_planes(all);
}

// Rays first to first + count - 1 (1 to 16) with limits `t_max`; lanes beyond the count repeat the first. Leaves the span's
// planes to bound_by_planes().
inline bool gather(const BvhView& bvh, const RayBatch& rays, int first, int count, Group& g, Span& span,
                   Float16& padding) noexcept {
    const auto lanes = Float16::Mask::from_bits((1u << count) - 1u);
    const auto load = [&](const float* p) {
        return count == kGroup ? Float16::load(p + first) : select(lanes, Float16::load(p + first), Float16::set(p[first]));
    };
    for (int i = 0; i < 3; ++i) {
        g.o[i] = load(rays.origin[i]);
        g.d[i] = load(rays.direction[i]);
    }
    g.batch = &rays;
    g.first = first;
    g.bvh = &bvh;
    const float x = std::fabs(rays.direction[0][first]), y = std::fabs(rays.direction[1][first]),
                z = std::fabs(rays.direction[2][first]);
    const int k = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
    const bool forward = rays.direction[k][first] > 0.0f;
    const Float16 size = max(max(abs(g.o[0]), abs(g.o[1])), abs(g.o[2])) + Float16::set(bvh.magnitude);
    if (!share_axis(g, k, forward, size, load(rays.t_max))) return false;
    span.kz = k;
    span.kx = k == 2 ? 0 : k + 1;
    span.ky = span.kx == 2 ? 0 : span.kx + 1;
    span.forward = forward;
    g.inverse_z = Float16::set(1.0f) / g.d[k];
    g.shear_x = g.d[span.kx] * g.inverse_z;
    g.shear_y = g.d[span.ky] * g.inverse_z;
    if (!bvh.only_triangles) g.inverse_length2 = ShearedRays<Float16>::inverse_of(g.shear_x, g.shear_y);
    padding = Float16::set(kPadding) * size;
    const auto same = [&](Float16 o, float first_one) { return le(o, Float16::set(first_one)) & le(Float16::set(first_one), o); };
    float start[3];
    for (int i = 0; i < 3; ++i) start[i] = rays.origin[i][first];
    span.common = (same(g.o[0], start[0]) & same(g.o[1], start[1]) & same(g.o[2], start[2])).bits() == 0xffffu;
    span.padding = span.common ? first_lane(padding) : reduce_max(padding);
    const float depth = span.common ? span.depth(start[k]) : forward ? reduce_min(g.o[k]) : -reduce_max(g.o[k]);
    span.z_start = depth - span.padding;
    const float scene_near = (forward ? bvh.lo[k] : -bvh.hi[k]) - span.padding;
    const float scene_far = (forward ? bvh.hi[k] : -bvh.lo[k]) + span.padding;
    const float near = span.z_start < scene_near ? scene_near : span.z_start;
    if (!(near < scene_far)) return false;
    span.za = span.depth(near);
    span.zb = span.depth(scene_far);
    const auto extent = [&](int axis, Float16 shear) {
        const auto at = [&](float depth_z) { return g.o[axis] + shear * (Float16::set(depth_z) - g.o[k]); };
        const Float16 a = at(span.za), b = at(span.zb);
        return Extent{reduce_min(a), reduce_max(a), reduce_min(b), reduce_max(b)};
    };
    // From one point the extreme shears give the extreme positions, the same to the bit: each operation rounds monotonically.
    const auto extent_of = [&](int axis, float lo, float hi) {
        const float to_a = span.za - start[k], to_b = span.zb - start[k];
        const float a0 = start[axis] + lo * to_a, a1 = start[axis] + hi * to_a, b0 = start[axis] + lo * to_b,
                    b1 = start[axis] + hi * to_b;
        return Extent{a0 < a1 ? a0 : a1, a0 < a1 ? a1 : a0, b0 < b1 ? b0 : b1, b0 < b1 ? b1 : b0};
    };
    if (span.common) {
        span.shears = {reduce_min(g.shear_x), reduce_max(g.shear_x), reduce_min(g.shear_y), reduce_max(g.shear_y)};
        span.x = extent_of(span.kx, span.shears.lo_x, span.shears.hi_x);
        span.y = extent_of(span.ky, span.shears.lo_y, span.shears.hi_y);
    } else {
        span.x = extent(span.kx, g.shear_x);
        span.y = extent(span.ky, g.shear_y);
    }
    return true;
}

}  // namespace glint::GLINT_ISA
