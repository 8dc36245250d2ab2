// Sixty-four rays from one point through the tree together, judged by their common span alone until a leaf is reached: the cost
// of a node does not depend on the number of rays. Pays where the span is no wider than a leaf: the samples of a few pixels.
// Closest hits only. Invariant: the answers are those of traverse() for each ray.
#pragma once

#include "accel/bvh_packet.h"
#include "accel/bvh_span.h"

namespace glint::GLINT_ISA {

constexpr int kFrustumGroups = 4;
// The span's width in leaves up to which it pays.
constexpr float kFrustumWidth = 2.5f;

inline void traverse_frustum(const BvhView& bvh, Group* groups, const Span* spans, const Span& all, unsigned octant) noexcept {
    const SpanTest test(all);
    const SpanTest tests[kFrustumGroups] = {SpanTest(spans[0]), SpanTest(spans[1]), SpanTest(spans[2]), SpanTest(spans[3])};
    float ends[kFrustumGroups];
    const auto update = [&](int i) { ends[i] = end_of(groups[i], spans[i]); };
    for (int i = 0; i < kFrustumGroups; ++i) update(i);
    const auto farthest = [&] {
        const float a = ends[0] < ends[1] ? ends[1] : ends[0], b = ends[2] < ends[3] ? ends[3] : ends[2];
        return a < b ? b : a;
    };
    float end = farthest();
    TraversalStack stack;
    BvhRef at = 0;
    for (;;) {
        if ((at & kLeafBit) == 0) {
            const BvhNode& node = bvh.at<BvhNode>(at);
            Float8 depth;
            const unsigned mask = test(node.bounds, Float8::set(end), depth);
            if (mask != 0) {
                at = (mask & (mask - 1)) == 0 ? node.child[__builtin_ctz(mask)]
                                              : push_children(stack, node, mask, 3 * octant, depth);
                continue;
            }
        } else if (static_cast<PrimitiveKind>(leaf_kind(at)) == PrimitiveKind::triangle) {
            const auto& b = bvh.at<TriangleBlock>(at);
            const Corners corners(b, groups[0].ray(0));
            const unsigned once = distinct(b.id);
            for (int i = 0; i < kFrustumGroups; ++i) {
                unsigned m = tests[i].triangles(b, Float8::set(ends[i])) & once;
                if (m == 0) continue;
                for (; m != 0; m &= m - 1) {
                    const int k = __builtin_ctz(m);
                    groups[i].meet<false, true>(corners.v, b.id[k], k, spans[i], groups[i].active);
                }
                if (groups[i].found != 0) update(i);
            }
            end = farthest();
        } else {
            for (int i = 0; i < kFrustumGroups; ++i) {
                meet_leaf<false>(at, bvh, spans[i], tests[i], Float8::set(ends[i]), groups[i].active, groups[i]);
                if (groups[i].found != 0) update(i);
            }
            end = farthest();
        }
        do {
            if (stack.top == 0) return;
            --stack.top;
        } while (stack.near[stack.top] > end);
        at = stack.ref[stack.top];
    }
}

}  // namespace glint::GLINT_ISA
