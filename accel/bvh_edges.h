// Eight triangles against groups of rays from one point: those that all rays of a group miss, by the triangles' own edges.
// Knows no tree. Invariant: what is rejected, the test of each ray rejects too.
//
// A ray's edge function is linear in its shear (s, t), because the product of the two shears cancels. So a triangle is sheared
// once along a middle direction, and a rectangle of shears costs two multiply-adds for an edge function's centre and two for its
// reach. Errors, in units of u = 2^-24: with depths up to Z, and sheared coordinates up to S for any of the rays, a ray's own
// sheared corners are good to 3 (Z + S), so its edge functions to 12 (Z + S) S; the middle ones as well; their slopes times the
// shear to 10 (Z + S) S for each axis, sums and products to 12 S^2. The margin of 64 (Z + S) S holds the sum, 56.
#pragma once

#include "accel/bvh_group.h"

namespace glint::GLINT_ISA {

// The corners of a leaf's triangles as seen from the common origin of a group.
struct Corners {
    alignas(32) float v[9][kBvhWidth];

    Corners(const TriangleBlock& b, const float (&o)[3]) noexcept {
        for (int i = 0; i < 9; ++i) (Float8::load(b.v[i]) - Float8::set(o[i % 3])).store(v[i]);
    }
};

// A range beside a middle direction, made ready once.
class EdgeTest {
public:
    EdgeTest() noexcept = default;
    EdgeTest(const ShearRange& r, float x, float y, bool forward) noexcept
        : x_(r.lo_x - x, r.hi_x - x, forward), y_(r.lo_y - y, r.hi_y - y, forward) {}

private:
    friend class LeafEdges;
    // One axis: shears relative to the middle direction.
    struct Axis {
        Float8 lo, hi;        // of positions at depth 1, where depths grow along the rays
        bool lo_far, hi_far;  // which end of a depth range pushes the bound outwards
        Float8 minus_at, reach, minus_reach;

        Axis() noexcept = default;
        Axis(float least, float most, bool forward) noexcept {
            const float at = 0.5f * (least + most), half = (most - least) * 0.5000002f, a = forward ? least : -most,
                        b = forward ? most : -least;
            lo = Float8::set(a), hi = Float8::set(b);
            lo_far = a < 0.0f;
            hi_far = b > 0.0f;
            minus_at = Float8::set(-at), reach = Float8::set(half), minus_reach = Float8::set(-half);
        }
    };
    Axis x_, y_;
};

// The triangles of a leaf along the middle direction (x, y); spread: largest shear of any ray relative to it.
class LeafEdges {
public:
    LeafEdges(const Corners& corners, const Span& span, float x, float y, float spread) noexcept {
        const Float8 sx = Float8::set(x), sy = Float8::set(y), zero = Float8::set(0.0f);
        Float8 px[3], py[3], pz[3];
        for (int i = 0; i < 3; ++i) {
            pz[i] = Float8::load(corners.v[3 * i + span.kz]);
            px[i] = neg_mul_add(sx, pz[i], Float8::load(corners.v[3 * i + span.kx]));
            py[i] = neg_mul_add(sy, pz[i], Float8::load(corners.v[3 * i + span.ky]));
        }
        const auto least = [](const Float8(&p)[3]) { return min(min(p[0], p[1]), p[2]); };
        const auto most = [](const Float8(&p)[3]) { return max(max(p[0], p[1]), p[2]); };
        const Float8 x0 = least(px), x1 = most(px), y0 = least(py), y1 = most(py), z0 = least(pz), z1 = most(pz);
        const Float8 depth = max(z1, zero - z0);
        const Float8 size = max(max(x1, zero - x0), max(y1, zero - y0)) + depth * Float8::set(spread);
        const Float8 slack = (depth + size) * Float8::set(16.0f * 0x1p-24f);
        lo_x_ = x0 - slack, hi_x_ = x1 + slack, lo_y_ = y0 - slack, hi_y_ = y1 + slack;
        z_[0] = span.forward ? z0 : zero - z1;
        z_[1] = span.forward ? z1 : zero - z0;
        front_ = le(zero, z_[1] + slack);
        // Numbers too large make the margin infinite and reject nothing; subnormal ones lie within the least float.
        margin_ = (((depth + size) * Float8::set(8.0f)) * size) * Float8::set(8.0f * 0x1p-24f) + Float8::set(kLeastT);
        for (int i = 0; i < 3; ++i) {
            const int b = (i + 1) % 3, c = (i + 2) % 3;
            edge_[i] = mul_sub(px[c], py[b], py[c] * px[b]);
            slope_x_[i] = mul_sub(py[c], pz[b], pz[c] * py[b]);
            slope_y_[i] = mul_sub(pz[c], px[b], px[c] * pz[b]);
        }
    }
    // Bits of the triangles that a ray of the range may hit before depth `end`, counted from the origin.
    [[nodiscard]] unsigned operator()(const EdgeTest& t, Float8 end) const noexcept {
        const auto in = le(t.x_.lo * z_[t.x_.lo_far], hi_x_) & le(lo_x_, t.x_.hi * z_[t.x_.hi_far]) &
                        le(t.y_.lo * z_[t.y_.lo_far], hi_y_) & le(lo_y_, t.y_.hi * z_[t.y_.hi_far]) & front_ & le(z_[0], end);
        Float8 most, least;  // of the least, and of the largest edge function
        for (int i = 0; i < 3; ++i) {
            const Float8 at = neg_mul_add(t.x_.minus_at, slope_x_[i], neg_mul_add(t.y_.minus_at, slope_y_[i], edge_[i]));
            const Float8 x = abs(slope_x_[i]), y = abs(slope_y_[i]);
            const Float8 hi = neg_mul_add(t.x_.minus_reach, x, neg_mul_add(t.y_.minus_reach, y, at));
            const Float8 lo = neg_mul_add(t.x_.reach, x, neg_mul_add(t.y_.reach, y, at));
            most = i == 0 ? hi : min(most, hi);
            least = i == 0 ? lo : max(least, lo);
        }
        return (in - (lt(most, Float8::set(0.0f) - margin_) & lt(margin_, least))).bits();
    }

private:
    Float8 lo_x_, hi_x_, lo_y_, hi_y_, z_[2];
    Float8::Mask front_;
    Float8 margin_, edge_[3], slope_x_[3], slope_y_[3];
};

}  // namespace glint::GLINT_ISA
