// Sixty-four rays from one point through the tree together, judged by their common span alone until a leaf is reached: the cost
// of a node does not depend on the number of rays. Pays where the span is no wider than a leaf: the samples of a few pixels.
// Closest hits only. Invariant: the answers are those of traverse() for each ray.
#pragma once

#include "accel/bvh_packet.h"
#include "accel/bvh_span.h"

namespace glint::GLINT_ISA {

constexpr int kFrustumGroups = 4;

inline void traverse_frustum(const BvhView& bvh, Group* groups, const Span* spans, const Span& all, unsigned octant) noexcept {
    const SpanTest test(all);
    const float x = all.shears.middle_x(), y = all.shears.middle_y(), spread = all.shears.spread();
    SpanTest parts[kFrustumGroups];  // for primitives without edges
    for (int i = 0; i < kFrustumGroups && !bvh.only_triangles; ++i) parts[i] = SpanTest(spans[i]);
    EdgeTest tests[kFrustumGroups];
    for (int i = 0; i < kFrustumGroups; ++i) tests[i] = EdgeTest(spans[i].shears, x, y, all.forward);
    // Depths count from the common origin here, but for those of nodes.
    float origin[3];
    for (int axis = 0; axis < 3; ++axis) origin[axis] = groups[0].batch->origin[axis][groups[0].first];
    const float start = all.depth(origin[all.kz]);
    // Depth beyond which no ray looks.
    const auto farthest = [&] {
        Float16 depth = Float16::load(groups[0].t) * abs(groups[0].d[all.kz]);
        for (int i = 1; i < kFrustumGroups; ++i) depth = max(depth, Float16::load(groups[i].t) * abs(groups[i].d[all.kz]));
        const float end = reduce_max(depth);
        return end + 2.0f * all.padding + 0x1p-20f * end;
    };
    float end = farthest();
    TraversalStack stack;
    int top = 0;
    BvhRef at = 0;
    for (;;) {
        if ((at & kLeafBit) == 0) {
            const BvhNode& node = bvh.at<BvhNode>(at);
            Float8 depth;
            const unsigned mask = test(node.bounds, Float8::set(start + end), depth);
            for (unsigned m = mask; m != 0; m &= m - 1) fetch(bvh, node.child[__builtin_ctz(m)]);
            if (mask != 0) {
                at = (mask & (mask - 1)) == 0 ? node.child[__builtin_ctz(mask)]
                                              : push_children(stack, top, node, Float8::Mask::from_bits(mask), 3 * octant, depth);
                continue;
            }
        } else if (static_cast<PrimitiveKind>(leaf_kind(at)) == PrimitiveKind::triangle) {
            const auto& b = bvh.at<TriangleBlock>(at);
            const Corners corners(b, origin);
            const LeafEdges edges(corners, all, x, y, spread);
            const Float8 before = Float8::set(end);
            unsigned m = 0;
            for (int i = 0; i < kFrustumGroups; ++i) m |= edges(tests[i], before) << (kBvhWidth * i);
            m &= 0x01010101u * distinct(b.id);
            if (m != 0) {
                // One loop over groups and triangles, so that one branch only is hard to foresee.
                for (; m != 0; m &= m - 1) {
                    const int bit = __builtin_ctz(m), i = bit / kBvhWidth, k = bit % kBvhWidth;
                    groups[i].meet<false, true>(corners.v, b.id[k], k, all, groups[i].active);
                }
                end = farthest();
            }
        } else if (static_cast<PrimitiveKind>(leaf_kind(at)) == PrimitiveKind::sphere) {
            const auto& b = bvh.at<SphereBlock>(at);
            const Float8 before = Float8::set(start + end);
            const unsigned entered = test.spheres(b, before) & distinct(b.id);
            if (entered != 0) {
                unsigned m = 0;
                for (int i = 0; i < kFrustumGroups; ++i) m |= (parts[i].spheres(b, before) & entered) << (kBvhWidth * i);
                for (; m != 0; m &= m - 1) {
                    const int bit = __builtin_ctz(m), i = bit / kBvhWidth, k = bit % kBvhWidth;
                    groups[i].meet<false, true>(b, k, spans[i], groups[i].active);
                }
                end = farthest();
            }
        } else {
            for (int i = 0; i < kFrustumGroups; ++i) {
                meet_leaf<false>(at, bvh, spans[i], parts[i], Float8::set(start + end), groups[i].active, groups[i]);
            }
            end = farthest();
        }
        do {
            if (top == 0) return;
            --top;
        } while (stack.near[top] > start + end);
        at = stack.ref[top];
    }
}

}  // namespace glint::GLINT_ISA
