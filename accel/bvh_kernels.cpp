#include "accel/bvh_kernels.h"

#include "accel/bvh_flight.h"
#include "accel/bvh_frustum.h"

// Compiled once per instruction set (CMakeLists.txt says with which flags).
namespace glint::GLINT_ISA {
namespace {

void closest(const BvhView& bvh, const Ray& ray, Hit& best) noexcept {
    traverse<false>(bvh, ray, best, [](BvhRef) {});
}

bool occluded(const BvhView& bvh, const Ray& ray) noexcept {
    Hit best;
    best.t = ray.t_max;
    traverse<true>(bvh, ray, best, [](BvhRef) {});
    return best.primitive != kNoPrimitive;
}

// Unusable rays keep what they had.
void load(const RayBatch& rays, int i, Ray& ray) noexcept {
    for (int k = 0; k < 3; ++k) {
        (&ray.origin.x)[k] = rays.origin[k][i];
        (&ray.direction.x)[k] = rays.direction[k][i];
    }
    ray.t_max = rays.t_max[i];
}

void closest_in_flight(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    const auto begin = [&](Flight& f) {
        f.best.t = hits.t[f.index];
        f.best.u = hits.u[f.index];
        f.best.v = hits.v[f.index];
        f.best.primitive = hits.primitive[f.index];
    };
    traverse_in_flight<false>(
        bvh, rays, [](int) { return true; }, begin,
        [&](const Flight& f) {
            hits.t[f.index] = f.best.t;
            hits.u[f.index] = f.best.u;
            hits.v[f.index] = f.best.v;
            hits.primitive[f.index] = f.best.primitive;
        });
}

void occluded_in_flight(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    const auto begin = [&](Flight& f) {
        f.best.t = rays.t_max[f.index];
        f.best.primitive = kNoPrimitive;
    };
    traverse_in_flight<true>(
        bvh, rays, [&](int i) { return !result[i]; }, begin,
        [&](const Flight& f) { result[f.index] = f.best.primitive != kNoPrimitive; });
}

unsigned octant_of(const RayBatch& rays, int i) noexcept {
    return (rays.direction[0][i] >= 0.0f ? 1u : 0u) | (rays.direction[1][i] >= 0.0f ? 2u : 0u) |
           (rays.direction[2][i] >= 0.0f ? 4u : 0u);
}

void closest_of(const BvhView& bvh, const RayBatch& rays, int i, HitBatch& hits) noexcept {
    Ray ray;
    load(rays, i, ray);
    Hit best;
    best.t = hits.t[i];
    best.u = hits.u[i];
    best.v = hits.v[i];
    best.primitive = hits.primitive[i];
    closest(bvh, ray, best);
    hits.t[i] = best.t;
    hits.u[i] = best.u;
    hits.v[i] = best.v;
    hits.primitive[i] = best.primitive;
}

// The lanes' distances to beat and what is hit there, from the batch and back.
void begin(const HitBatch& hits, int count, Group& g) noexcept {
    g.active = (1u << count) - 1u;
    g.found = 0;
    const auto lanes = Float16::Mask::from_bits(g.active);
    min(select(lanes, Float16::load(hits.t + g.first), Float16::set(hits.t[g.first])), Float16::set(kLargestT)).store(g.t);
    copy_where(Float16::Mask::from_bits(0xffffu), hits.primitive + g.first, g.id);
}
void end(const Group& g, HitBatch& hits) noexcept {
    const auto lanes = Float16::Mask::from_bits(g.found);
    copy_where(lanes, g.t, hits.t + g.first);
    copy_where(lanes, g.u, hits.u + g.first);
    copy_where(lanes, g.v, hits.v + g.first);
    copy_where(lanes, g.id, hits.primitive + g.first);
}

// Whether the span is narrow against the leaves.
bool narrow_beside_leaves(const BvhView& bvh, const Span& s) noexcept {
    const float x = (s.x.hi_a - s.x.lo_a) + (s.x.hi_b - s.x.lo_b), y = (s.y.hi_a - s.y.lo_a) + (s.y.hi_b - s.y.lo_b);
    return 0.5f * (x < y ? y : x) <= kFrustumWidth * bvh.leaf_extent;
}

void closest_coherent(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    constexpr int kRays = kFrustumGroups * kGroup;
    Group groups[kFrustumGroups];
    Span spans[kFrustumGroups], all;
    for (int first = 0; first < rays.count; first += kRays) {
        bool gathered[kFrustumGroups] = {};
        Float16 padding[kFrustumGroups];
        bool together = rays.order == RayOrder::common_origin && rays.count - first >= kRays;
        for (int i = 0; i < kFrustumGroups; ++i) {
            const int at = first + i * kGroup, left = rays.count - at;
            if (left <= 0) break;
            gathered[i] = gather(bvh, rays, at, left < kGroup ? left : kGroup, groups[i], spans[i], padding[i]);
            if (gathered[i]) begin(hits, left < kGroup ? left : kGroup, groups[i]);
            together = together && gathered[i] && spans[i].common;
            for (int axis = 0; axis < 3; ++axis) together = together && rays.origin[axis][at] == rays.origin[axis][first];
        }
        together = together && join(spans, kFrustumGroups, all) && narrow_beside_leaves(bvh, all);
        if (together) traverse_frustum(bvh, groups, spans, all, octant_of(rays, first));
        for (int i = 0; i < kFrustumGroups; ++i) {
            const int at = first + i * kGroup;
            if (!gathered[i]) {
                for (int k = at; k < at + kGroup && k < rays.count; ++k) closest_of(bvh, rays, k, hits);
                continue;
            }
            if (!together)
                traverse_group<false>(bvh, groups[i], spans[i], GroupSlabs(groups[i], padding[i]), octant_of(rays, at));
            end(groups[i], hits);
        }
    }
}

void occluded_coherent(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    for (int first = 0; first < rays.count; first += kGroup) {
        const int count = rays.count - first < kGroup ? rays.count - first : kGroup;
        Group g;
        Span span;
        Float16 padding;
        if (!gather(bvh, rays, first, count, g, span, padding)) {
            Ray ray;
            for (int i = first; i < first + count; ++i) {
                if (result[i]) continue;
                load(rays, i, ray);
                result[i] = occluded(bvh, ray);
            }
            continue;
        }
        for (int l = 0; l < kGroup; ++l) {
            const int i = first + (l < count ? l : 0);
            g.t[l] = rays.t_max[i] < kLargestT ? rays.t_max[i] : kLargestT;
            g.id[l] = kNoPrimitive;
            if (l < count && !result[i]) g.active |= 1u << l;
        }
        if (g.active != 0) traverse_group<true>(bvh, g, span, GroupSlabs(g, padding), octant_of(rays, first));
        for (unsigned m = g.found; m != 0; m &= m - 1) result[first + __builtin_ctz(m)] = true;
    }
}

void closest_batch(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    rays.order == RayOrder::divergent ? closest_in_flight(bvh, rays, hits) : closest_coherent(bvh, rays, hits);
}

void occluded_batch(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    rays.order == RayOrder::divergent ? occluded_in_flight(bvh, rays, result) : occluded_coherent(bvh, rays, result);
}

void count_closest(const BvhView& bvh, const Ray& ray, TraversalCounts& counts) noexcept {
    Hit best;
    best.t = ray.t_max;
    ++counts.rays;
    traverse<false>(bvh, ray, best, [&](BvhRef ref) {
        if ((ref & kLeafBit) == 0) {
            ++counts.nodes;
            return;
        }
        ++counts.leaves;
    });
}

}  // namespace

const BvhKernels kernels{closest, occluded, closest_batch, occluded_batch, count_closest};

}  // namespace glint::GLINT_ISA
