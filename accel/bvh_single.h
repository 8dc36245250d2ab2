// One ray through the tree at a time.
// Invariant: children are taken near to far, and a child is left out only when the best hit lies before its padded entry.
#pragma once

#include "accel/bvh_children.h"
#include "accel/bvh_leaves.h"
#include "accel/bvh_successors.h"

namespace glint::GLINT_ISA {

// A ray's numbers are spread over vectors where a step uses them: sixteen registers are too few to hold them, and the compiler
// would do it beforehand and keep the vectors in memory.
inline const RayScalars& unspread(const RayScalars& scalars) noexcept {
#if defined(__AVX512VL__)
    return scalars;
#else
    const RayScalars* p = &scalars;
    asm volatile("" : "+r"(p));
    return *p;
#endif
}

// Improves `best`. With `any`, ends at the first hit; `blocker` is then the leaf to look at first (0: none, the root is no leaf)
// and becomes the one that was hit. `visit(ref)` hears of every node and leaf.
template <bool any, class Visit>
[[gnu::always_inline]] inline void traverse(const BvhView& bvh, const Ray& ray, const RayScalars& scalars, Hit& best,
                                            BvhRef& blocker, Visit visit) noexcept {
    if (!scalars.usable) return;
    const PrimitiveId before = best.primitive;
    if constexpr (any) {
        if (blocker != 0) {
            meet_leaf<any>(blocker, LeafRay(ray, unspread(scalars), bvh), best);
            if (best.primitive != before) return;
            blocker = 0;
        }
    }
    TraversalStack stack;
    int top = 0;
    Float8 limit = Float8::set(best.t);
    BvhRef at = 0;
    // Goes on to the last child left behind that may still count; false where there is none.
    const auto pop = [&] {
        do {
            if (top == 0) return false;
            --top;
        } while (!any && stack.near[top] > best.t);
        at = follow<any>(at, stack.ref[top]);
        return true;
    };
    for (;;) {
        while ((at & kLeafBit) == 0) {
            visit(at);
            const BvhNode& node = bvh.node(at);
            const SlabRay slab_ray(unspread(scalars));
            if constexpr (any) {
                Float8 near;
                const unsigned mask = enter(node, slab_ray, limit, near).bits();
                if (mask != 0) {
                    at = follow<any>(at, push_unsorted(stack, top, node, mask));
                } else if (!pop()) {
                    return;
                }
            } else {
                const ChildrenInOrder children(node, slab_ray, limit);
                if (!children.none()) {
                    at = follow<any>(at, children.push_others(stack, top));
                } else if (!pop()) {
                    return;
                }
            }
        }
        visit(at);
        meet_leaf<any>(at, LeafRay(ray, unspread(scalars), bvh), best);
        if (any && best.primitive != before) {
            blocker = at;
            return;
        }
        limit = Float8::set(best.t);
        if (!pop()) return;
    }
}

// The closest hit: no leaf is worth asking first.
template <class Visit>
[[gnu::always_inline]] inline void traverse_closest(const BvhView& bvh, const Ray& ray, const RayScalars& scalars, Hit& best,
                                                    Visit visit) noexcept {
    BvhRef none = 0;
    traverse<false>(bvh, ray, scalars, best, none, visit);
}

}  // namespace glint::GLINT_ISA
