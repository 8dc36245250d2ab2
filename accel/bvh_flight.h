// Many rays in flight on one thread: each step takes one node or one leaf of one ray, asks memory for what that ray needs next
// and goes on to the next ray, so that the waits of incoherent rays overlap (coroutine-like interleaving; Kocberber, Falsafi &
// Grot 2015, "Asynchronous Memory Access Chaining"). Invariant: each ray goes the way that traverse() would take it.
#pragma once

#include "accel/bvh_single.h"

namespace glint::GLINT_ISA {

// Of 8, 12, 16, 24 and 32, sixteen gives the most rays a second on meshes that do not fit the caches.
constexpr int kInFlight = 16;

struct Flight {
    RayScalars scalars;
    Ray ray;
    Hit best;
    BvhRef at;
    int index;  // of the ray in its batch
    TraversalStack stack;
};

inline void fetch(const BvhView& bvh, BvhRef ref) noexcept {
    const auto* p = reinterpret_cast<const char*>(&bvh.at<BvhNode>(ref));
    _mm_prefetch(p, _MM_HINT_T0);
    _mm_prefetch(p + 64, _MM_HINT_T0);
    _mm_prefetch(p + 128, _MM_HINT_T0);
    _mm_prefetch(p + 192, _MM_HINT_T0);
    if ((ref & kLeafBit) != 0) _mm_prefetch(p + 256, _MM_HINT_T0);
}

// Returns true when the ray is done.
template <bool any>
inline bool step(const BvhView& bvh, Flight& f) noexcept {
    if ((f.at & kLeafBit) == 0) {
        const BvhNode& node = bvh.at<BvhNode>(f.at);
        Float8 near;
        const unsigned mask = enter(node, SlabRay(f.scalars), Float8::set(f.best.t), near);
        if (mask != 0) {
            if ((mask & (mask - 1)) == 0) {
                f.at = node.child[__builtin_ctz(mask)];
            } else if constexpr (any) {
                f.at = push_unsorted(f.stack, node, mask);
            } else {
                f.at = push_children(f.stack, node, mask, 3 * f.scalars.octant, near);
            }
            fetch(bvh, f.at);
            return false;
        }
    } else {
        const PrimitiveId before = f.best.primitive;
        meet_leaf<any>(f.at, LeafRay(f.ray, f.scalars, bvh), f.best);
        if (any && f.best.primitive != before) return true;
    }
    do {
        if (f.stack.top == 0) return true;
        --f.stack.top;
    } while (!any && f.stack.near[f.stack.top] > f.best.t);
    f.at = f.stack.ref[f.stack.top];
    fetch(bvh, f.at);
    return false;
}

// next(Flight&) starts the next ray (ray, best and index) or returns false when there is none; done(const Flight&) takes one
// back.
template <bool any, class Next, class Done>
inline void traverse_in_flight(const BvhView& bvh, Next next, Done done) noexcept {
    Flight flights[kInFlight];
    Flight* live[kInFlight];
    int count = 0;
    const auto start = [&](Flight& f) {
        while (next(f)) {
            f.scalars = prepare(&f.ray.origin.x, &f.ray.direction.x, bvh.magnitude, f.ray.t_max);
            f.at = 0;
            f.stack.top = 0;
            if (f.scalars.usable) return true;
        }
        return false;
    };
    while (count < kInFlight && start(flights[count])) {
        live[count] = &flights[count];
        ++count;
    }
    while (count > 0) {
        for (int i = 0; i < count; ++i) {
            if (!step<any>(bvh, *live[i])) continue;
            done(*live[i]);
            if (!start(*live[i])) live[i--] = live[--count];
        }
    }
}

}  // namespace glint::GLINT_ISA
