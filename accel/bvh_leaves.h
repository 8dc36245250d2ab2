// Vectors of primitive tests: one ray against a leaf, or many rays against one primitive; the arithmetic is the same.
// Knows no tree. Invariant: the bits of primitive.h's intersect(), by the same operations in the same order or, for triangles
// that float cannot decide, by calling it.
#pragma once

#include "accel/bvh_near_sphere.h"
#include "accel/bvh_rays.h"

namespace glint::GLINT_ISA {

// Keeps the nearer hit, at equal t the lower id.
inline void keep(float t, float u, float v, PrimitiveId id, Hit& best) noexcept {
    if (t < best.t || (t == best.t && id < best.primitive)) {
        best.t = t;
        best.u = u;
        best.v = v;
        best.primitive = id;
    }
}

template <class V>
inline V difference_of_products(V a, V b, V c, V d) noexcept {
    const V cd = c * d;
    return mul_sub(a, b, cd) + neg_mul_add(c, d, cd);
}

// Lanes of triangles relative to their rays, as in ShearedTriangle, and what comes of them.
template <class V>
struct Triangles {
    V ax, ay, az, bx, by, bz, cx, cy, cz;

    void shear(V shear_x, V shear_y) noexcept {
        ax = ax - shear_x * az, ay = ay - shear_y * az;
        bx = bx - shear_x * bz, by = by - shear_y * bz;
        cx = cx - shear_x * cz, cy = cy - shear_y * cz;
    }
};

// Lanes that plain products rule out: rounding is monotone, so a difference of rounded products that is not 0 has the exact sign.
template <class V>
inline typename V::Mask certain_misses(const Triangles<V>& s) noexcept {
    const V u = s.cx * s.by - s.cy * s.bx, v = s.ax * s.cy - s.ay * s.cx, w = s.bx * s.ay - s.by * s.ax, zero = V::set(0.0f);
    return lt(min(min(u, v), w), zero) & lt(zero, max(max(u, v), w));
}

template <class V>
struct TriangleLanes {
    V t, u, v;
    typename V::Mask hit;     // lanes that hit, except for the bounds of t
    typename V::Mask unsure;  // lanes that only intersect_alone() can decide
};

// `s` is sheared. Where no instruction fuses, every lane that plain products do not rule out is unsure.
template <class V>
[[gnu::always_inline]] inline TriangleLanes<V> meet_triangles(const Triangles<V>& s, V inverse_z) noexcept {
    const auto all = V::Mask::from_bits((1u << V::kLanes) - 1);
    const V zero = V::set(0.0f);
    TriangleLanes<V> r;
    if constexpr (kFused) {
        const V u = difference_of_products(s.cx, s.by, s.cy, s.bx), v = difference_of_products(s.ax, s.cy, s.ay, s.cx),
                w = difference_of_products(s.bx, s.ay, s.by, s.ax);
        const V lowest = min(min(u, v), w), highest = max(max(u, v), w), det = (u + v) + w;
        const V beyond = v * (s.bz - s.az) + w * (s.cz - s.az);
        const auto mixed = lt(lowest, V::set(-kLeastEdge)) & lt(V::set(kLeastEdge), highest);
        r.hit = le(V::set(kLeastEdge), max(lowest, zero - highest)) & le(max(abs(det), abs(beyond)), V::set(kLargestDeterminant));
        r.unsure = (all - mixed) - r.hit;
        const V scale = V::set(1.0f) / det;
        r.u = v * scale;
        r.v = w * scale;
        r.t = (s.az + beyond * scale) * inverse_z;
    } else {
        r.hit = V::Mask::from_bits(0);
        r.unsure = all - certain_misses(s);
        r.t = r.u = r.v = zero;
    }
    return r;
}

struct DoubleVector {
    Double8 x, y, z;
};
inline DoubleVector spread(const float* p) noexcept {
    return {Double8::set(static_cast<double>(p[0])), Double8::set(static_cast<double>(p[1])),
            Double8::set(static_cast<double>(p[2]))};
}
inline Double8 dot(const DoubleVector& a, const DoubleVector& b) noexcept { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

// The first of two roots that is reportable once rounded to float; lanes without are 0.
inline Float8 first_root(Double8 t0, Double8 t1, Float8 limit) noexcept {
    const Float8 near = narrow(t0), far = narrow(t1), least = Float8::set(kLeastT);
    return select(le(least, near) & le(near, limit), near, select(le(least, far) & le(far, limit), far, Float8::set(0.0f)));
}

// f: origin - centre, d: direction. Operation for operation intersect_sphere(). limit <= the largest float.
inline Float8 meet_spheres(const DoubleVector& f, const DoubleVector& d, Double8 r, Float8 limit) noexcept {
    const Double8 zero = Double8::set(0.0), a = dot(d, d), b = zero - dot(f, d), shift = b / a;
    const DoubleVector nearest{f.x + shift * d.x, f.y + shift * d.y, f.z + shift * d.z};
    const Double8 discriminant = r * r - dot(nearest, nearest);
    const auto meets = le(zero, discriminant);
    if (meets.bits() == 0) return Float8::set(0.0f);
    const Double8 q = b + copy_sign(sqrt(a * discriminant), b), c = dot(f, f) - r * r;
    const Double8 t0 = c / q, t1 = q / a;
    // The order of min and max is that of std::min and std::max, where a NaN or equal zeros would tell them apart.
    const Float8 t = first_root(min(t1, t0), max(t1, t0), limit);
    return select(narrow(meets - (le(q, zero) & le(zero, q))), t, Float8::set(0.0f));
}

// Operation for operation intersect_box(); `face` counts as there.
inline Float8 meet_boxes(const DoubleVector& o, const DoubleVector& d, const DoubleVector& lo, const DoubleVector& hi,
                         Float8 limit, Float8& face) noexcept {
    const Double8 zero = Double8::set(0.0);
    Double8 near = Double8::set(-HUGE_VAL), far = Double8::set(HUGE_VAL), near_face = zero, far_face = zero;
    auto outside = lt(zero, zero);
    const Double8 os[3] = {o.x, o.y, o.z}, ds[3] = {d.x, d.y, d.z}, los[3] = {lo.x, lo.y, lo.z}, his[3] = {hi.x, hi.y, hi.z};
    for (int i = 0; i < 3; ++i) {
        const auto parallel = le(ds[i], zero) & le(zero, ds[i]);
        outside = outside | (parallel & (lt(os[i], los[i]) | lt(his[i], os[i])));
        const Double8 t_lo = (los[i] - os[i]) / ds[i], t_hi = (his[i] - os[i]) / ds[i];
        const Double8 first = min(t_hi, t_lo), last = max(t_hi, t_lo);
        const auto forward = lt(zero, ds[i]);
        const Double8 even = Double8::set(2 * i), odd = Double8::set(2 * i + 1);
        const auto enters = lt(near, first) - parallel, leaves = lt(last, far) - parallel;
        near = select(enters, first, near);
        near_face = select(enters, select(forward, even, odd), near_face);
        far = select(leaves, last, far);
        far_face = select(leaves, select(forward, odd, even), far_face);
    }
    const Float8 t = first_root(near, far, limit), none = Float8::set(0.0f);
    const Float8 entry = narrow(near);
    face = select(le(t, entry) & le(entry, t), narrow(near_face), narrow(far_face));
    return select(narrow(le(near, far) - outside), t, none);
}

// One ray against the leaves that it comes to.
struct LeafRay {
    const Ray& ray;
    const BvhView& bvh;
    Float8 o[3], shear_x, shear_y, inverse_z;  // o along kx, ky, kz
    int kx, ky, kz;

    LeafRay(const Ray& r, const RayScalars& s, const BvhView& b) noexcept
        : ray(r),
          bvh(b),
          o{Float8::set(s.o[0]), Float8::set(s.o[1]), Float8::set(s.o[2])},
          shear_x(Float8::set(s.shear_x)),
          shear_y(Float8::set(s.shear_y)),
          inverse_z(Float8::set(s.inverse_z)),
          kx(s.kx),
          ky(s.ky),
          kz(s.kz) {}
};

// Takes over what the lanes of `hits` found. With `any` the first will do.
template <bool any>
inline void keep_lanes(unsigned hits, Float8 t, Float8 u, Float8 v, const PrimitiveId* ids, Hit& best) noexcept {
    if (hits == 0) return;
    if constexpr (any) {
        best.primitive = ids[__builtin_ctz(hits)];
        return;
    }
    alignas(32) float ts[8], us[8], vs[8];
    t.store(ts);
    u.store(us);
    v.store(vs);
    for (; hits != 0; hits &= hits - 1) {
        const int l = __builtin_ctz(hits);
        keep(ts[l], us[l], vs[l], ids[l], best);
    }
}

// early_out: whether to ask first if all lanes miss. That branch is hard to guess: camera rays gain 2 % by it, shadow rays and
// rays in flight, which wait for nothing else, lose 2 and 8 %.
template <bool any, bool early_out = !any>
[[gnu::always_inline]] inline void meet_leaf(const TriangleBlock& b, const LeafRay& ray, Hit& best) noexcept {
    const float *x = b.v[ray.kx], *y = b.v[ray.ky], *z = b.v[ray.kz];
    constexpr int kVertex = 3 * kBvhWidth;
    Triangles<Float8> s;
    s.ax = Float8::load(x) - ray.o[0], s.bx = Float8::load(x + kVertex) - ray.o[0],
    s.cx = Float8::load(x + 2 * kVertex) - ray.o[0];
    s.ay = Float8::load(y) - ray.o[1], s.by = Float8::load(y + kVertex) - ray.o[1],
    s.cy = Float8::load(y + 2 * kVertex) - ray.o[1];
    s.az = Float8::load(z) - ray.o[2], s.bz = Float8::load(z + kVertex) - ray.o[2],
    s.cz = Float8::load(z + 2 * kVertex) - ray.o[2];
    s.shear(ray.shear_x, ray.shear_y);
    if (early_out && certain_misses(s).bits() == (1u << kBvhWidth) - 1) return;
    const TriangleLanes<Float8> r = meet_triangles(s, ray.inverse_z);
    const float limit = best.t < kLargestT ? best.t : kLargestT;
    const unsigned hits = (r.hit & le(Float8::set(kLeastT), r.t) & le(r.t, Float8::set(limit))).bits();
    keep_lanes<any>(hits, r.t, r.u, r.v, b.id, best);
    for (unsigned unsure = r.unsure.bits(); __builtin_expect(unsure != 0, !kFused); unsure &= unsure - 1) {
        intersect_alone(ray.ray, ray.bvh.magnitude, *ray.bvh.geometry, b.id[__builtin_ctz(unsure)], best);
    }
}

template <bool any>
[[gnu::always_inline]] inline void meet_spheres(const SphereBlock& b, const Ray& ray, Hit& best) noexcept {
    const DoubleVector o = spread(&ray.origin.x);
    const DoubleVector f{o.x - widen(Float8::load(b.center[0])), o.y - widen(Float8::load(b.center[1])),
                         o.z - widen(Float8::load(b.center[2]))};
    const Float8 zero = Float8::set(0.0f);
    const Float8 t = meet_spheres(f, spread(&ray.direction.x), widen(Float8::load(b.radius)),
                                  Float8::set(best.t < kLargestT ? best.t : kLargestT));
    keep_lanes<any>(lt(zero, t).bits(), t, zero, zero, b.id, best);
}
template <bool any>
inline void meet_boxes(const BoxBlock& b, const Ray& ray, Hit& best) noexcept {
    const auto corner = [](const float(&p)[3][kBvhWidth]) {
        return DoubleVector{widen(Float8::load(p[0])), widen(Float8::load(p[1])), widen(Float8::load(p[2]))};
    };
    Float8 face;
    const Float8 zero = Float8::set(0.0f);
    const Float8 t = meet_boxes(spread(&ray.origin.x), spread(&ray.direction.x), corner(b.lo), corner(b.hi),
                                Float8::set(best.t < kLargestT ? best.t : kLargestT), face);
    keep_lanes<any>(lt(zero, t).bits(), t, face, zero, b.id, best);
}

// Rare kinds. Out of line, so that they leave registers alone where there are none.
template <bool any>
[[gnu::noinline]] void meet_rare_leaf(BvhRef leaf, const BvhView& bvh, const Ray& ray, Hit& best) noexcept {
    if (static_cast<PrimitiveKind>(leaf_kind(leaf)) == PrimitiveKind::box) {
        meet_boxes<any>(bvh.at<BoxBlock>(leaf), ray, best);
        return;
    }
    const auto& b = bvh.at<ConeBlock>(leaf);
    for (int i = 0; i < kBvhWidth && (i == 0 || b.id[i] != b.id[i - 1]); ++i) {
        intersect_alone(ray, bvh.magnitude, *bvh.geometry, b.id[i], best);
    }
}

// Inline wherever it is used: the compiler's own choice cost single rays up to 10 %.
template <bool any, bool early_out = !any>
[[gnu::always_inline]] inline void meet_leaf(BvhRef leaf, const LeafRay& ray, Hit& best) noexcept {
    switch (static_cast<PrimitiveKind>(leaf_kind(leaf))) {
        case PrimitiveKind::triangle: return meet_leaf<any, early_out>(ray.bvh.at<TriangleBlock>(leaf), ray, best);
        case PrimitiveKind::sphere: return meet_spheres<any>(ray.bvh.at<SphereBlock>(leaf), ray.ray, best);
        default: return meet_rare_leaf<any>(leaf, ray.bvh, ray.ray, best);
    }
}

}  // namespace glint::GLINT_ISA
