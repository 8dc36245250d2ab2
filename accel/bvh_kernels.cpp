#include "accel/bvh_kernels.h"

#include "accel/bvh_flight.h"
#include "accel/bvh_packet.h"
#include "accel/bvh_span.h"

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
    int i = 0;
    const auto next = [&](Flight& f) {
        if (i == rays.count) return false;
        load(rays, i, f.ray);
        f.best.t = hits.t[i];
        f.best.primitive = hits.primitive[i];
        f.best.u = hits.u[i];
        f.best.v = hits.v[i];
        f.index = i++;
        return true;
    };
    traverse_in_flight<false>(bvh, next, [&](const Flight& f) {
        hits.t[f.index] = f.best.t;
        hits.u[f.index] = f.best.u;
        hits.v[f.index] = f.best.v;
        hits.primitive[f.index] = f.best.primitive;
    });
}

void occluded_in_flight(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    int i = 0;
    const auto next = [&](Flight& f) {
        while (i < rays.count && result[i]) ++i;
        if (i == rays.count) return false;
        load(rays, i, f.ray);
        f.best.t = rays.t_max[i];
        f.best.primitive = kNoPrimitive;
        f.index = i++;
        return true;
    };
    traverse_in_flight<true>(bvh, next, [&](const Flight& f) { result[f.index] = f.best.primitive != kNoPrimitive; });
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

void closest_coherent(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    for (int first = 0; first < rays.count; first += kGroup) {
        const int count = rays.count - first < kGroup ? rays.count - first : kGroup;
        Group g;
        Span span;
        Float16 padding;
        if (!gather(bvh, rays, first, count, g, span, padding)) {
            for (int i = first; i < first + count; ++i) closest_of(bvh, rays, i, hits);
            continue;
        }
        g.active = (1u << count) - 1u;
        for (int l = 0; l < kGroup; ++l) {
            const int i = first + (l < count ? l : 0);
            g.t[l] = hits.t[i] < kLargestT ? hits.t[i] : kLargestT;
            g.id[l] = hits.primitive[i];
        }
        traverse_group<false>(bvh, g, span, GroupSlabs(g, padding), octant_of(rays, first));
        for (unsigned m = g.found; m != 0; m &= m - 1) {
            const int l = __builtin_ctz(m);
            hits.t[first + l] = g.t[l];
            hits.u[first + l] = g.u[l];
            hits.v[first + l] = g.v[l];
            hits.primitive[first + l] = g.id[l];
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
