#include <xmmintrin.h>

#include <bit>
#include <utility>

#include "accel/bvh.h"

namespace glint {
namespace {

struct StackEntry {
    float near;
    std::uint32_t index;
    std::uint32_t count;  // 0 = node, else leaf
};

// Each level leaves at most seven siblings behind.
constexpr int kStackSize = kMaxBvhDepth * (kBvhWidth - 1) + 1;

// What slab_interval() reads of a ray, spread over four lanes once per query, with the rows of a node's bounds (0-2 lo,
// 3-5 hi) that the ray meets first and last. SSE belongs to every x86-64.
struct SlabLanes {
    __m128 reciprocal[3], near_offset[3], far_offset[3];
    int near_row[3], far_row[3];

    explicit SlabLanes(const PreparedRay& ray) noexcept {
        for (int i = 0; i < 3; ++i) {
            reciprocal[i] = _mm_set1_ps(ray.reciprocal[i]);
            near_offset[i] = _mm_set1_ps(ray.near_offset[i]);
            far_offset[i] = _mm_set1_ps(ray.far_offset[i]);
            const bool forward = ray.reciprocal[i] >= 0.0f;
            near_row[i] = forward ? i : 3 + i;
            far_row[i] = forward ? 3 + i : i;
        }
    }
};

// The same arithmetic as slab_interval() for all children. A bit of the result is set for each child that the ray may
// enter before `limit`; the near distances are stored.
inline unsigned entered_children(const SlabLanes& ray, const BvhNode& node, float limit, float (&near)[kBvhWidth]) noexcept {
    unsigned mask = 0;
    for (int half = 0; half < kBvhWidth; half += 4) {
        __m128 n = _mm_set1_ps(-kInfinity), f = _mm_set1_ps(kInfinity);
        for (int i = 0; i < 3; ++i) {
            const __m128 first = _mm_load_ps(node.bounds[ray.near_row[i]] + half);
            const __m128 last = _mm_load_ps(node.bounds[ray.far_row[i]] + half);
            n = _mm_max_ps(_mm_sub_ps(_mm_mul_ps(first, ray.reciprocal[i]), ray.near_offset[i]), n);
            f = _mm_min_ps(_mm_sub_ps(_mm_mul_ps(last, ray.reciprocal[i]), ray.far_offset[i]), f);
        }
        _mm_storeu_ps(near + half, n);
        const __m128 ahead = _mm_and_ps(_mm_cmpge_ps(f, _mm_setzero_ps()), _mm_cmple_ps(n, _mm_set1_ps(limit)));
        mask |= static_cast<unsigned>(_mm_movemask_ps(_mm_and_ps(_mm_cmple_ps(n, f), ahead))) << half;
    }
    return mask;
}

}  // namespace

Bvh::Bvh(std::shared_ptr<const Geometry> geometry) : geometry_(std::move(geometry)), tree_(build_bvh(*geometry_)) {
    magnitude_ = geometry_->bounds().magnitude();
}

template <bool any>
Hit Bvh::traverse(const Ray& ray) const noexcept {
    const PreparedRay prepared(ray, magnitude_);
    Hit best = begin_query(prepared, *geometry_);
    if (!prepared.usable || tree_.nodes.empty() || (any && best.found())) return best;
    const SlabLanes lanes(prepared);
    StackEntry stack[kStackSize];
    int top = 0;
    stack[top++] = {0.0f, 0, 0};
    while (top > 0) {
        const StackEntry entry = stack[--top];
        if (entry.near > best.t) continue;
        if (entry.count > 0) {
            for (std::uint32_t i = 0; i < entry.count; ++i) {
                intersect(prepared, *geometry_, tree_.ids[entry.index + i], best);
                if (any && best.found()) return best;
            }
            continue;
        }
        const BvhNode& node = tree_.nodes[entry.index];
        float near[kBvhWidth];
        // Children are pushed far to near, so that the nearest is popped first.
        const int bottom = top;
        for (unsigned mask = entered_children(lanes, node, best.t, near); mask != 0; mask &= mask - 1) {
            const int k = std::countr_zero(mask);
            int at = top++;
            if (!any) {
                for (; at > bottom && stack[at - 1].near < near[k]; --at) stack[at] = stack[at - 1];
            }
            stack[at] = {near[k], node.child[k], node.count[k]};
        }
    }
    return best;
}

Hit Bvh::closest_hit(const Ray& ray) const noexcept { return traverse<false>(ray); }
bool Bvh::occluded(const Ray& ray) const noexcept { return traverse<true>(ray).found(); }

std::size_t Bvh::memory_bytes() const {
    return tree_.nodes.capacity() * sizeof(BvhNode) + tree_.ids.capacity() * sizeof(PrimitiveId);
}

}  // namespace glint
