#include "accel/bvh_kernels.h"

#include "accel/bvh_flight.h"
#include "accel/bvh_frustum.h"
#include "accel/bvh_leftovers.h"
#include "accel/bvh_single.h"

// Compiled once per instruction set (CMakeLists.txt says with which flags).
namespace glint::GLINT_ISA {
namespace {

RayScalars scalars_of(const BvhView& bvh, const Ray& ray) noexcept {
    return prepare(&ray.origin.x, &ray.direction.x, bvh.magnitude, ray.t_max);
}

void closest(const BvhView& bvh, const Ray& ray, Hit& best) noexcept {
    traverse_closest(bvh, ray, scalars_of(bvh, ray), best, [](BvhRef) {});
}

// The leaf that blocked this thread's last ray, if it was blocked, and the number of its tree: what blocks a ray often blocks
// the next one too (Haines & Greenberg 1986, "The Light Buffer"). Any hit gives the same verdict, so the bits do not change.
struct LastBlocker {
    std::uint64_t tree = 0;
    BvhRef leaf = 0;
};
constinit thread_local LastBlocker last_blocker;

bool occluded(const BvhView& bvh, const Ray& ray) noexcept {
    Hit best;
    best.t = ray.t_max;
    LastBlocker& last = last_blocker;
    BvhRef blocker = last.tree == bvh.tree ? last.leaf : 0;
    traverse<true>(bvh, ray, scalars_of(bvh, ray), best, blocker, [](BvhRef) {});
    last = {bvh.tree, blocker};
    return best.primitive != kNoPrimitive;
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

// Trees that the caches hold leave no waits to overlap.
constexpr std::size_t kCached = std::size_t{3} << 20;

// The lanes' distances to beat and what is hit there, from the batch and back.
void begin(const HitBatch& hits, int count, Group& g) noexcept {
    g.active = (1u << count) - 1u;
    g.found = 0;
    const auto lanes = Float16::Mask::from_bits(g.active);
    min(select(lanes, Float16::load(hits.t + g.first), Float16::set(hits.t[g.first])), Float16::set(kLargestT)).store(g.t);
    copy_where(Float16::Mask::from_bits(0xffffu), hits.primitive + g.first, g.id);
}
void end(const Group& g, HitBatch& hits) noexcept {
    if (g.found == 0) return;
    const auto lanes = Float16::Mask::from_bits(g.found);
    copy_where(lanes, g.t, hits.t + g.first);
    copy_where(lanes, g.u, hits.u + g.first);
    copy_where(lanes, g.v, hits.v + g.first);
    copy_where(lanes, g.id, hits.primitive + g.first);
}

// Whether the span is narrow against the leaves.
bool narrow_beside_leaves(const BvhView& bvh, const Span& s) noexcept {
    const float x = (s.x.hi_a - s.x.lo_a) + (s.x.hi_b - s.x.lo_b), y = (s.y.hi_a - s.y.lo_a) + (s.y.hi_b - s.y.lo_b);
    return 0.5f * (x < y ? y : x) <= bvh.frustum_extent;
}

// Groups that cannot be gathered go to `leftovers`, or ray by ray where there are none.
void closest_in_groups(const BvhView& bvh, const RayBatch& rays, HitBatch& hits, Leftovers* leftovers) noexcept {
    constexpr int kRays = kFrustumGroups * kGroup;
    Group groups[kFrustumGroups];
    Span spans[kFrustumGroups], all;
    fetch_rays(rays, 0, kRays);
    for (int first = 0; first < rays.count; first += kRays) {
        bool gathered[kFrustumGroups] = {};
        Float16 padding[kFrustumGroups];
        bool together = rays.order == RayOrder::common_origin && rays.count - first >= kRays;
        for (int i = 0; i < kFrustumGroups; ++i) {
            const int at = first + i * kGroup, left = rays.count - at;
            if (left <= 0) break;
            gathered[i] = gather(bvh, rays, at, left < kGroup ? left : kGroup, groups[i], spans[i], padding[i]);
            fetch_rays(rays, at + kRays, kGroup);
            if (gathered[i]) begin(hits, left < kGroup ? left : kGroup, groups[i]);
            together = together && gathered[i] && spans[i].common;
            for (int axis = 0; axis < 3; ++axis) together = together && rays.origin[axis][at] == rays.origin[axis][first];
        }
        together = together && join(spans, kFrustumGroups, all) && narrow_beside_leaves(bvh, all);
        // The parts' own planes serve primitives without edges.
        for (int i = 0; i < kFrustumGroups; ++i) {
            if (gathered[i] && !(together && bvh.only_triangles)) gathered[i] = bound_by_planes(spans[i]);
            together = together && gathered[i];
        }
        if (together) traverse_frustum(bvh, groups, spans, all, octant_of(rays, first));
        for (int i = 0; i < kFrustumGroups; ++i) {
            const int at = first + i * kGroup;
            if (!gathered[i]) {
                const int last = at + kGroup < rays.count ? at + kGroup : rays.count;
                if (leftovers != nullptr && at < last) leftovers->add(rays, at, last - at);
                for (int k = at; leftovers == nullptr && k < last; ++k) closest_of(bvh, rays, k, hits);
                continue;
            }
            if (!together)
                traverse_group<false, ChildOrder::near_first>(bvh, groups[i], spans[i], GroupSlabs(groups[i], padding[i]),
                                                              octant_of(rays, at));
            end(groups[i], hits);
        }
    }
}

void closest_coherent(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    Leftovers leftovers;
    closest_in_groups(bvh, rays, hits, &leftovers);
    leftovers.hand_out(rays, [&](const RayBatch& batch, const std::uint16_t* index, int count) {
        HitBatch part;
        for (int k = 0; k < count; ++k) {
            part.t[k] = hits.t[index[k]];
            part.u[k] = hits.u[index[k]];
            part.v[k] = hits.v[index[k]];
            part.primitive[k] = hits.primitive[index[k]];
        }
        // Closest hits of rays that scatter that much gain nothing from another try together, where there are waits to overlap.
        bvh.bytes > kCached ? closest_in_flight(bvh, batch, part) : closest_in_groups(bvh, batch, part, nullptr);
        for (int k = 0; k < count; ++k) {
            hits.t[index[k]] = part.t[k];
            hits.u[index[k]] = part.u[k];
            hits.v[index[k]] = part.v[k];
            hits.primitive[index[k]] = part.primitive[k];
        }
    });
}

// Bits of the entries of sixteen that are false.
unsigned unset(const bool* p) noexcept {
    const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
    return static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_setzero_si128())));
}

void occluded_in_groups(const BvhView& bvh, const RayBatch& rays, bool* result, Leftovers* leftovers) noexcept {
    // Finding an order costs more than it saves, unless what it saves comes from memory. Spheres' nodes are few and large.
    const bool near_first = bvh.only_triangles && bvh.bytes > kCached;
    for (int first = 0; first < rays.count; first += kGroup) {
        const int count = rays.count - first < kGroup ? rays.count - first : kGroup;
        fetch_rays(rays, first + 2 * kGroup, kGroup);
        Group g;
        Span span;
        Float16 padding;
        if (!gather(bvh, rays, first, count, g, span, padding) || !bound_by_planes(span)) {
            if (leftovers != nullptr) leftovers->add(rays, first, count);
            Ray ray;
            for (int i = first; leftovers == nullptr && i < first + count; ++i) {
                if (result[i]) continue;
                load(rays, i, ray);
                result[i] = occluded(bvh, ray);
            }
            continue;
        }
        const auto lanes = Float16::Mask::from_bits((1u << count) - 1u);
        min(select(lanes, Float16::load(rays.t_max + first), Float16::set(rays.t_max[first])), Float16::set(kLargestT))
            .store(g.t);
        store_where(Float16::Mask::from_bits(0xffffu), kNoPrimitive, g.id);
        g.active = unset(result + first) & ((1u << count) - 1u);
        if (g.active != 0) {
            const GroupSlabs slabs(g, padding);
            near_first ? traverse_group<true, ChildOrder::near_first>(bvh, g, span, slabs, octant_of(rays, first))
                       : traverse_group<true, ChildOrder::as_stored>(bvh, g, span, slabs, 0);
        }
        for (unsigned m = g.found; m != 0; m &= m - 1) result[first + __builtin_ctz(m)] = true;
    }
}

void occluded_coherent(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    Leftovers leftovers;
    occluded_in_groups(bvh, rays, result, &leftovers);
    leftovers.hand_out(rays, [&](const RayBatch& batch, const std::uint16_t* index, int count) {
        bool part[kRayBatch];
        for (int k = 0; k < count; ++k) part[k] = result[index[k]];
        occluded_in_groups(bvh, batch, part, nullptr);
        for (int k = 0; k < count; ++k) result[index[k]] = part[k];
    });
}

void closest_batch(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    if (rays.order != RayOrder::divergent) return closest_coherent(bvh, rays, hits);
    closest_in_flight(bvh, rays, hits);
}

void occluded_batch(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    if (rays.order != RayOrder::divergent) return occluded_coherent(bvh, rays, result);
    occluded_in_flight(bvh, rays, result);
}

void count_closest(const BvhView& bvh, const Ray& ray, TraversalCounts& counts) noexcept {
    Hit best;
    best.t = ray.t_max;
    ++counts.rays;
    traverse_closest(bvh, ray, scalars_of(bvh, ray), best, [&](BvhRef ref) {
        if ((ref & kLeafBit) == 0) {
            ++counts.nodes;
            return;
        }
        ++counts.leaves;
        if (static_cast<PrimitiveKind>(leaf_kind(ref)) == PrimitiveKind::triangle) {
            counts.primitives += static_cast<unsigned>(__builtin_popcount(distinct(bvh.at<TriangleBlock>(ref).id)));
        } else if (static_cast<PrimitiveKind>(leaf_kind(ref)) == PrimitiveKind::sphere) {
            counts.primitives += static_cast<unsigned>(__builtin_popcount(distinct(bvh.at<SphereBlock>(ref).id)));
        } else if (static_cast<PrimitiveKind>(leaf_kind(ref)) == PrimitiveKind::box) {
            counts.primitives += static_cast<unsigned>(__builtin_popcount(distinct(bvh.at<BoxBlock>(ref).id)));
        } else {
            counts.primitives += kBvhWidth;
        }
    });
}

}  // namespace

const BvhKernels kernels{closest, occluded, closest_batch, occluded_batch, count_closest};

}  // namespace glint::GLINT_ISA
