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

// The same arithmetic as slab_interval(), for all children at once in a form that compilers turn into SIMD.
void child_intervals(const PreparedRay& ray, const BvhNode& node, float (&near)[kBvhWidth], float (&far)[kBvhWidth]) noexcept {
    for (int i = 0; i < 3; ++i) {
        const bool forward = ray.reciprocal[i] >= 0.0f;
        const float* lo = forward ? node.lo[i] : node.hi[i];
        const float* hi = forward ? node.hi[i] : node.lo[i];
        const float r = ray.reciprocal[i], near_offset = ray.near_offset[i], far_offset = ray.far_offset[i];
        for (int k = 0; k < kBvhWidth; ++k) {
            const float n = lo[k] * r - near_offset;
            const float f = hi[k] * r - far_offset;
            near[k] = i == 0 ? n : (n > near[k] ? n : near[k]);
            far[k] = i == 0 ? f : (f < far[k] ? f : far[k]);
        }
    }
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
        float near[kBvhWidth], far[kBvhWidth];
        child_intervals(prepared, node, near, far);
        // Children are pushed far to near, so that the nearest is popped first.
        const int bottom = top;
        for (int k = 0; k < kBvhWidth; ++k) {
            if (!(near[k] <= far[k] && far[k] >= 0.0f && near[k] <= best.t)) continue;
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
