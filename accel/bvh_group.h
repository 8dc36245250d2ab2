// Sixteen neighbouring rays with a common dominant axis: the space that they span, and their tests against one primitive.
// Knows no tree. Invariants: a box that the span rejects holds no hit of any of the rays; primitive tests give the bits of
// primitive.h's intersect().
#pragma once

#include "accel/bvh_leaves.h"
#include "accel/bvh_prepare.h"

namespace glint::GLINT_ISA {

// The rays of a group lie, along the axis k between two depths, between planes through the other two axes x and y:
// lo.slope z + lo.offset <= x <= hi.slope z + hi.offset. Padded by what a computed hit may stray (accel/README.md).
struct SpanPlane {
    float slope, offset;
};
// Least and largest position of the rays along x or y at the two depths.
struct Extent {
    float lo_a, hi_a, lo_b, hi_b;
};
// Least and largest shears of a group's rays.
struct ShearRange {
    float lo_x, hi_x, lo_y, hi_y;

    void grow(const ShearRange& r) noexcept {
        lo_x = r.lo_x < lo_x ? r.lo_x : lo_x;
        hi_x = r.hi_x > hi_x ? r.hi_x : hi_x;
        lo_y = r.lo_y < lo_y ? r.lo_y : lo_y;
        hi_y = r.hi_y > hi_y ? r.hi_y : hi_y;
    }
    [[nodiscard]] float middle_x() const noexcept { return 0.5f * (lo_x + hi_x); }
    [[nodiscard]] float middle_y() const noexcept { return 0.5f * (lo_y + hi_y); }
    // The largest shear relative to the middle.
    [[nodiscard]] float spread() const noexcept {
        const float x = hi_x - lo_x, y = hi_y - lo_y;
        return 0.5000002f * (x < y ? y : x);
    }
};
struct Span {
    int kx, ky, kz;
    bool forward;  // whether the rays go up the axis
    bool common;   // whether they start at one point
    float za, zb;  // the two depths, as coordinates
    Extent x, y;
    ShearRange shears;  // where common
    SpanPlane lo_x, hi_x, lo_y, hi_y;
    float z_start;  // depth (z, or -z where not forward) before which no ray starts
    float padding;

    [[nodiscard]] float depth(float z) const noexcept { return forward ? z : -z; }
};

// Eight boxes against a span, made ready once.
class SpanTest {
public:
    SpanTest() noexcept = default;
    explicit SpanTest(const Span& s) noexcept
        : rows_{2 * s.kx, 2 * s.ky, 2 * s.kz},
          slope_{Float8::set(s.hi_x.slope), Float8::set(s.lo_x.slope), Float8::set(s.hi_y.slope), Float8::set(s.lo_y.slope)},
          offset_{Float8::set(s.hi_x.offset), Float8::set(s.lo_x.offset), Float8::set(s.hi_y.offset), Float8::set(s.lo_y.offset)},
          // What the planes leave of a box is largest at one of its ends along z.
          z_row_{rows_[2] + (s.hi_x.slope > 0.0f), rows_[2] + (s.lo_x.slope <= 0.0f), rows_[2] + (s.hi_y.slope > 0.0f),
                 rows_[2] + (s.lo_y.slope <= 0.0f)},
          near_row_(rows_[2] + !s.forward),
          far_row_(rows_[2] + s.forward),
          length_{length(s.hi_x), length(s.lo_x), length(s.hi_y), length(s.lo_y)},
          sign_(Float8::set(s.forward ? 1.0f : -1.0f)),
          start_(Float8::set(s.z_start)) {}

    // bounds: six rows of eight as in BvhNode. Returns the bits of boxes that may be met before depth z_end; depth: where.
    [[nodiscard]] unsigned operator()(const float (*bounds)[kBvhWidth], Float8 z_end, Float8& depth) const noexcept {
        const auto row = [bounds](int i) { return Float8::load(bounds[i]); };
        depth = row(near_row_) * sign_;
        const auto x = le(neg_mul_add(slope_[0], row(z_row_[0]), row(rows_[0])), offset_[0]) &
                       le(offset_[1], neg_mul_add(slope_[1], row(z_row_[1]), row(rows_[0] + 1)));
        const auto y = le(neg_mul_add(slope_[2], row(z_row_[2]), row(rows_[1])), offset_[2]) &
                       le(offset_[3], neg_mul_add(slope_[3], row(z_row_[3]), row(rows_[1] + 1)));
        return (x & y & le(depth, z_end) & le(start_, row(far_row_) * sign_)).bits();
    }
    // The same for eight spheres, against the planes themselves.
    [[nodiscard]] unsigned spheres(const SphereBlock& b, Float8 z_end) const noexcept {
        const auto row = [&b](int i) { return Float8::load(b.center[i / 2]); };
        const Float8 x = row(rows_[0]), y = row(rows_[1]), z = row(rows_[2]), r = Float8::load(b.radius), depth = z * sign_;
        const Float8 minus_r = Float8::set(0.0f) - r;
        const auto least = [&](int i, Float8 p) { return neg_mul_add(length_[i], r, neg_mul_add(slope_[i], z, p)); };
        const auto most = [&](int i, Float8 p) { return neg_mul_add(length_[i], minus_r, neg_mul_add(slope_[i], z, p)); };
        return (le(least(0, x), offset_[0]) & le(offset_[1], most(1, x)) & le(least(2, y), offset_[2]) &
                le(offset_[3], most(3, y)) & le(depth - r, z_end) & le(start_, depth + r))
            .bits();
    }
    // The same for eight triangles, all of whose corners must lie beyond one plane to be rejected.
    [[nodiscard]] unsigned triangles(const TriangleBlock& b, Float8 z_end) const noexcept {
        Float8 side[4], near, far;
        for (int corner = 0; corner < 3; ++corner) {
            const float(*v)[kBvhWidth] = b.v + 3 * corner;
            const Float8 x = Float8::load(v[rows_[0] / 2]), y = Float8::load(v[rows_[1] / 2]), z = Float8::load(v[rows_[2] / 2]);
            const Float8 d[4] = {neg_mul_add(slope_[0], z, x), neg_mul_add(slope_[1], z, x), neg_mul_add(slope_[2], z, y),
                                 neg_mul_add(slope_[3], z, y)};
            const Float8 depth = z * sign_;
            for (int i = 0; i < 4; ++i) side[i] = corner == 0 ? d[i] : (i & 1) == 0 ? min(side[i], d[i]) : max(side[i], d[i]);
            near = corner == 0 ? depth : min(near, depth);
            far = corner == 0 ? depth : max(far, depth);
        }
        return (le(side[0], offset_[0]) & le(offset_[1], side[1]) & le(side[2], offset_[2]) & le(offset_[3], side[3]) &
                le(near, z_end) & le(start_, far))
            .bits();
    }

private:
    // At least the length of (slope, 1): how far along the axis a unit perpendicular to the plane reaches.
    static Float8 length(const SpanPlane& p) noexcept { return Float8::set(1.000001f * (1.0f + 0.5f * p.slope * p.slope)); }

    int rows_[3];
    Float8 slope_[4], offset_[4];
    int z_row_[4];
    int near_row_, far_row_;
    Float8 length_[4];
    Float8 sign_, start_;
};

// Up to sixteen rays of a batch. Lanes beyond the count repeat the first ray and are not active.
struct Group {
    Float16 o[3], d[3];  // along x, y, z
    Float16 shear_x, shear_y, inverse_z;
    Float16 inverse_length2;      // of (shear_x, shear_y, 1); conservative tests only
    alignas(64) float t[kGroup];  // distance to beat, at most the largest float
    alignas(64) float u[kGroup], v[kGroup];
    alignas(64) PrimitiveId id[kGroup];
    unsigned active = 0;  // lanes still looking
    unsigned found = 0;   // lanes whose t, u, v and id are new
    const RayBatch* batch;
    int first;
    const BvhView* bvh;

    [[nodiscard]] Ray ray(int lane) const noexcept {
        const int i = first + lane;
        return {{batch->origin[0][i], batch->origin[1][i], batch->origin[2][i]},
                {batch->direction[0][i], batch->direction[1][i], batch->direction[2][i]},
                batch->t_max[i]};
    }
    // Lanes that hit at `t` within the bounds and before what they have; ties go to the lower id.
    template <bool any>
    [[nodiscard]] unsigned nearer(Float16::Mask hit, Float16 at, unsigned lanes, PrimitiveId primitive) const noexcept {
        const Float16 best = Float16::load(t);
        const auto within = hit & le(Float16::set(kLeastT), at) & le(at, best);
        unsigned bits = within.bits() & lanes;
        if (any) return bits;
        for (unsigned tie = bits & ~lt(at, best).bits(); __builtin_expect(tie != 0, 0); tie &= tie - 1) {
            const int lane = __builtin_ctz(tie);
            if (!(primitive < id[lane])) bits &= ~(1u << lane);
        }
        return bits;
    }
    template <bool any>
    void take(unsigned lanes, Float16 at, Float16 at_u, Float16 at_v, PrimitiveId primitive) noexcept {
        if constexpr (any) {
            active &= ~lanes;
            found |= lanes;
            return;
        }
        // Without a branch on whether there is any: it would be mispredicted too often.
        const auto mask = Float16::Mask::from_bits(lanes);
        store_where(mask, at, t);
        store_where(mask, at_u, u);
        store_where(mask, at_v, v);
        store_where(mask, primitive, id);
        found |= lanes;
    }
    // One lane alone: `test(ray, best)` improves what it has.
    template <bool any, class Test>
    void decide_alone(int lane, Test test) noexcept {
        Hit best;
        best.t = t[lane];
        best.primitive = id[lane];
        test(ray(lane), best);
        if (best.primitive == id[lane]) return;
        t[lane] = best.t;
        u[lane] = best.u;
        v[lane] = best.v;
        id[lane] = best.primitive;
        found |= 1u << lane;
        if (any) active &= ~(1u << lane);
    }
    [[nodiscard]] LeafRay leaf_ray(int lane, const Ray& r, const Span& span) const noexcept {
        RayScalars s;
        s.kx = span.kx, s.ky = span.ky, s.kz = span.kz;
        s.o[0] = (&r.origin.x)[span.kx], s.o[1] = (&r.origin.x)[span.ky], s.o[2] = (&r.origin.x)[span.kz];
        s.shear_x = lane_of(shear_x, lane), s.shear_y = lane_of(shear_y, lane), s.inverse_z = lane_of(inverse_z, lane);
        return {r, s, *bvh};
    }
    // By the scalar code.
    template <bool any>
    void decide_alone(int lane, PrimitiveId primitive) noexcept {
        decide_alone<any>(lane,
                          [&](const Ray& r, Hit& best) { intersect_alone(r, bvh->magnitude, *bvh->geometry, primitive, best); });
    }

    // `corners`: of a block, relative to the origin where `common`.
    template <bool any, bool common>
    void meet(const float (*corners)[kBvhWidth], PrimitiveId primitive, int k, const Span& span, unsigned lanes) noexcept {
        const auto corner = [&](int c, int axis) {
            const Float16 x = Float16::set(corners[3 * c + axis][k]);
            return common ? x : x - o[axis];
        };
        Triangles<Float16> s;
        s.ax = corner(0, span.kx), s.ay = corner(0, span.ky), s.az = corner(0, span.kz);
        s.bx = corner(1, span.kx), s.by = corner(1, span.ky), s.bz = corner(1, span.kz);
        s.cx = corner(2, span.kx), s.cy = corner(2, span.ky), s.cz = corner(2, span.kz);
        s.shear(shear_x, shear_y);
        const TriangleLanes<Float16> r = meet_triangles(s, inverse_z);
        take<any>(nearer<any>(r.hit, r.t, lanes, primitive), r.t, r.u, r.v, primitive);
        for (unsigned unsure = r.unsure.bits() & lanes; __builtin_expect(unsure != 0, !kFused); unsure &= unsure - 1) {
            decide_alone<any>(__builtin_ctz(unsure), primitive);
        }
    }

    static DoubleVector spread_corner(const float (&p)[3][kBvhWidth], int k) noexcept {
        const float xyz[3] = {p[0][k], p[1][k], p[2][k]};
        return spread(xyz);
    }
    // In double, eight lanes at a time; halves without a lane of `lanes` miss.
    template <class Half>
    void halves(unsigned lanes, Half meet_half, Float16& at, Float16& face) const noexcept {
        Float8 ts[2] = {Float8::set(0.0f), Float8::set(0.0f)}, faces[2] = {ts[0], ts[0]};
        for (int h = 0; h < 2; ++h) {
            if ((lanes >> (8 * h) & 0xffu) == 0) continue;
            const auto part = [h](Float16 x) { return widen(h == 0 ? lower(x) : upper(x)); };
            ts[h] = meet_half(DoubleVector{part(o[0]), part(o[1]), part(o[2])}, DoubleVector{part(d[0]), part(d[1]), part(d[2])},
                              Float8::load(t + 8 * h), faces[h]);
        }
        at = join(ts[0], ts[1]);
        face = join(faces[0], faces[1]);
    }
    // `common`: all rays start at one point.
    template <bool any, bool common>
    void meet(const SphereBlock& b, int k, const Span& span, unsigned lanes) noexcept {
        const auto center = [&](int axis) { return b.center[axis][k]; };
        const auto start = [&](int axis) { return batch->origin[axis][first]; };
        const auto from_origin = [&](int axis) {
            return common ? Float16::set(center(axis) - start(axis)) : Float16::set(center(axis)) - o[axis];
        };
        const auto [maybe, surely] = near_spheres<any, Float16>(
            from_origin(span.kx), from_origin(span.ky), Float16::set(0.0f) - from_origin(span.kz), Float16::set(b.radius[k]),
            {shear_x, shear_y, inverse_length2, d[span.kz], Float16::load(t)});
        lanes &= maybe.bits();
        if constexpr (any) {
            const unsigned enter = lanes & surely.bits();
            active &= ~enter;
            found |= enter;
            lanes &= ~enter;
        }
        if (lanes == 0) return;
        const auto wide = [](float x) { return static_cast<double>(x); };
        const auto to_origin = [&](int axis) { return Double8::set(wide(start(axis)) - wide(center(axis))); };
        const DoubleVector c = spread_corner(b.center, k);
        const Double8 r = Double8::set(wide(b.radius[k]));
        Float16 at, none;
        halves(
            lanes,
            [&](const DoubleVector& from, const DoubleVector& along, Float8 limit, Float8&) {
                const DoubleVector f = common ? DoubleVector{to_origin(0), to_origin(1), to_origin(2)}
                                              : DoubleVector{from.x - c.x, from.y - c.y, from.z - c.z};
                return meet_spheres(f, along, r, limit);
            },
            at, none);
        take<any>(nearer<any>(lt(none, at), at, lanes, b.id[k]), at, none, none, b.id[k]);
    }
    template <bool any>
    void meet(const BoxBlock& b, int k, unsigned lanes) noexcept {
        const DoubleVector lo = spread_corner(b.lo, k), hi = spread_corner(b.hi, k);
        const Float16 zero = Float16::set(0.0f);
        Float16 at, face;
        halves(
            lanes,
            [&](const DoubleVector& from, const DoubleVector& along, Float8 limit, Float8& f) {
                return meet_boxes(from, along, lo, hi, limit, f);
            },
            at, face);
        take<any>(nearer<any>(lt(zero, at), at, lanes, b.id[k]), at, face, zero, b.id[k]);
    }
};

}  // namespace glint::GLINT_ISA
