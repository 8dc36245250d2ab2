// Many rays in flight on one thread: each step takes one node or one leaf of one ray, asks memory for what that ray needs next
// and goes on to the next ray, so that the waits of incoherent rays overlap (coroutine-like interleaving; Kocberber, Falsafi &
// Grot 2015, "Asynchronous Memory Access Chaining"). Invariant: each ray goes the way that traverse() would take it.
#pragma once

#include "accel/bvh_children.h"
#include "accel/bvh_leaves.h"
#include "accel/bvh_prepare.h"

namespace glint::GLINT_ISA {

// 16 to 48 are within 4 % of each other on meshes that do not fit the caches.
constexpr int kInFlight = 24;

// At the bottom of each stack: a leaf where the root is, so none.
constexpr BvhRef kDone = kLeafBit;

struct Flight {
    RayScalars scalars;
    Ray ray;
    Hit best;
    BvhRef at;
    int index;  // of the ray in its batch
    int top;    // of the stack
    TraversalStack stack;

    void start() noexcept {
        at = 0;
        stack.ref[0] = kDone;
        top = 1;
    }
    void pop() noexcept { at = stack.ref[--top]; }
};

// Pushes all children entered, none or many alike: no branch hangs on how many. What is next is popped when all rays have taken
// their step, as it would come back late from what was just stored.
template <bool any>
inline void step_node(const BvhView& bvh, Flight& f) noexcept {
    const BvhNode& node = bvh.node(f.at);
    const SlabRay ray(f.scalars);
    const Float8 limit = Float8::set(f.best.t);
    int top = f.top;
    if constexpr (any) {
        Float8 near;
        push_all_unsorted(f.stack, top, node, enter(node, ray, limit, near).bits());
    } else {
        ChildrenInOrder(node, ray, limit).push_all(f.stack, top);
    }
    f.top = top;
}

// wanted(i): whether ray i is to be traced; begin(Flight&) sets what it has to beat; done(const Flight&) takes it back.
template <bool any, class Wanted, class Begin, class Done>
inline void traverse_in_flight(const BvhView& bvh, const RayBatch& rays, Wanted wanted, Begin begin, Done done) noexcept {
    Flight flights[kInFlight];
    // Rays that are to take a node next and rays that are to take a leaf, apart: what a step does is known beforehand.
    Flight *nodes[kInFlight], *leaves[kInFlight];
    int node_count = 0, leaf_count = 0;
    PreparedRays prepared;
    int i = 0;
    const auto start = [&](Flight& f) {
        for (; i < rays.count; ++i) {
            if (i % kGroup == 0) {
                fetch_rays(rays, i + kGroup, kGroup);
                prepared.prepare(rays, i, bvh.magnitude);
            }
            if (!prepared.usable(i % kGroup) || !wanted(i)) continue;
            prepared.share(i % kGroup, f.scalars);
            for (int k = 0; k < 3; ++k) {
                (&f.ray.origin.x)[k] = rays.origin[k][i];
                (&f.ray.direction.x)[k] = rays.direction[k][i];
            }
            f.ray.t_max = rays.t_max[i];
            f.index = i++;
            f.start();
            begin(f);
            nodes[node_count++] = &f;
            return;
        }
    };
    const auto go_on = [&](Flight* f) {
        fetch(bvh, f->at);
        // By arithmetic: a branch on it would be guessed wrong at every fourth step.
        const auto leaf = static_cast<int>(f->at >> 31);
        leaves[leaf_count] = f;
        nodes[node_count] = f;
        leaf_count += leaf;
        node_count += 1 - leaf;
    };
    for (Flight& f : flights) start(f);
    while (node_count + leaf_count > 0) {
        const int at_nodes = node_count;
        node_count = 0;
        for (int k = 0; k < at_nodes; ++k) step_node<any>(bvh, *nodes[k]);
        for (int k = 0; k < at_nodes; ++k) {
            Flight* f = nodes[k];
            f->pop();
            go_on(f);
        }
        const int at_leaves = leaf_count;
        leaf_count = 0;
        for (int k = 0; k < at_leaves; ++k) {
            Flight* f = leaves[k];
            const PrimitiveId before = f->best.primitive;
            const float t = f->best.t;
            if (f->at != kDone) meet_leaf<any, false>(f->at, LeafRay(f->ray, f->scalars, bvh), f->best);
            if (f->at == kDone || (any && f->best.primitive != before)) {
                done(*f);
                start(*f);
                continue;
            }
            // Culled when hit, not compared when popped: that would be a branch guessed wrong at the end of each step's chain.
            if (!any && f->best.t != t) f->top = f->stack.cull(f->top, f->best.t);
            f->pop();
            go_on(f);
        }
    }
}

}  // namespace glint::GLINT_ISA
