// Sixteen coherent rays through the tree together: at each node the span of the rays rejects what none can meet, then the rays
// are tested against each child left; in a leaf a primitive meets all rays at once, or a lone ray meets all primitives (in the
// manner of Wald, Boulos & Shirley 2007 and Overbeck, Ramamoorthi & Mark 2008). Invariant: the answers are those of traverse()
// for each ray.
#pragma once

#include <type_traits>

#include "accel/bvh_children.h"
#include "accel/bvh_edges.h"

namespace glint::GLINT_ISA {

// Slabs of sixteen rays against one box.
class GroupSlabs {
public:
    GroupSlabs() noexcept = default;
    GroupSlabs(const Group& g, Float16 padding) noexcept {
        const Float16 zero = Float16::set(0.0f);
        Float16 largest = max(abs(g.d[0]), max(abs(g.d[1]), abs(g.d[2])));
        const Float16 smallest = largest * Float16::set(0x1p-40f);
        for (int i = 0; i < 3; ++i) {
            const Float16 r = Float16::set(1.0f) / copy_sign(max(abs(g.d[i]), smallest), g.d[i]);
            const Float16 slack = padding * abs(r), shift = g.o[i] * r;
            reciprocal_[i] = r;
            near_offset_[i] = shift + slack;
            far_offset_[i] = shift - slack;
            const unsigned negative = lt(r, zero).bits();
            near_row_[i] = 2 * i + (negative != 0 ? 1 : 0);
            mixed_ |= negative != 0 && negative != 0xffffu;
        }
    }
    // Lanes that may meet child k before `limit`.
    [[nodiscard]] unsigned operator()(const BvhNode& node, int k, Float16 limit) const noexcept {
        Float16 near[3], far[3];
        for (int i = 0; i < 3; ++i) {
            const Float16 first = Float16::set(node.bounds[near_row_[i]][k]),
                          last = Float16::set(node.bounds[near_row_[i] ^ 1][k]);
            near[i] = mul_sub(first, reciprocal_[i], near_offset_[i]);
            far[i] = mul_sub(last, reciprocal_[i], far_offset_[i]);
            if (__builtin_expect(mixed_, 0)) {
                near[i] = min(near[i], mul_sub(last, reciprocal_[i], near_offset_[i]));
                far[i] = max(far[i], mul_sub(first, reciprocal_[i], far_offset_[i]));
            }
        }
        const Float16 entry = max(max(near[0], near[1]), max(near[2], Float16::set(0.0f)));
        return le(entry, min(min(far[0], far[1]), min(far[2], limit))).bits();
    }

private:
    Float16 reciprocal_[3], near_offset_[3], far_offset_[3];
    int near_row_[3];
    bool mixed_ = false;
};

struct PacketStack {
    BvhRef ref[kStackSize];
    float depth[kStackSize];  // of closest hits
    std::uint16_t lanes[kStackSize];
    int top = 0;

    // Without a branch on whether there is any lane: it would be mispredicted too often.
    void push_if_any(BvhRef child, unsigned entering) noexcept {
        ref[top] = child;
        lanes[top] = static_cast<std::uint16_t>(entering);
        top += entering != 0 ? 1 : 0;
    }
};

// Depth beyond which no active ray looks.
inline float end_of(const Group& g, const Span& span) noexcept {
    const Float16 z = g.o[span.kz] + Float16::load(g.t) * g.d[span.kz];
    const Float16 depth = span.forward ? z : Float16::set(0.0f) - z;
    return reduce_max(depth) + span.padding + 0x1p-20f * std::fabs(reduce_max(depth));
}

// The lanes against triangles `m` of a block.
template <bool any>
inline void meet_triangles(const TriangleBlock& b, unsigned m, const Span& span, unsigned lanes, Group& g) noexcept {
    const auto meet_all = [&](auto common, const float(*v)[kBvhWidth]) {
        for (; m != 0; m &= m - 1) {
            const int k = __builtin_ctz(m);
            g.meet<any, decltype(common)::value>(v, b.id[k], k, span, any ? lanes & g.active : lanes);
        }
    };
    m &= distinct(b.id);
    if (m == 0) return;
    // Eight triangles cost a ray what eight rays cost a triangle.
    if (any) lanes &= g.active;
    if (__builtin_popcount(lanes) <= __builtin_popcount(m)) {
        for (; lanes != 0; lanes &= lanes - 1) {
            const int lane = __builtin_ctz(lanes);
            g.decide_alone<any>(lane, [&](const Ray& ray, Hit& best) { meet_leaf<any>(b, g.leaf_ray(lane, ray, span), best); });
        }
        return;
    }
    if (span.common) {
        const float* o[3] = {g.batch->origin[0], g.batch->origin[1], g.batch->origin[2]};
        const Corners corners(b, {o[0][g.first], o[1][g.first], o[2][g.first]});
        meet_all(std::true_type(), corners.v);
    } else {
        meet_all(std::false_type(), b.v);
    }
}

// The lanes against the primitives of a leaf that the span leaves.
template <bool any>
inline void meet_leaf(BvhRef leaf, const BvhView& bvh, const Span& span, const SpanTest& test, Float8 z_end, unsigned lanes,
                      Group& g) noexcept {
    const auto alive = [&] { return any ? lanes & g.active : lanes; };
    switch (static_cast<PrimitiveKind>(leaf_kind(leaf))) {
        case PrimitiveKind::triangle: {
            const auto& b = bvh.at<TriangleBlock>(leaf);
            meet_triangles<any>(b, test.triangles(b, z_end), span, lanes, g);
            return;
        }
        case PrimitiveKind::sphere: {
            const auto& b = bvh.at<SphereBlock>(leaf);
            const unsigned spheres = test.spheres(b, z_end) & distinct(b.id);
            // Eight spheres cost a ray what eight rays cost a sphere.
            if (__builtin_popcount(alive()) <= __builtin_popcount(spheres)) {
                for (unsigned l = alive(); l != 0; l &= l - 1) {
                    g.decide_alone<any>(__builtin_ctz(l), [&](const Ray& ray, Hit& best) { meet_spheres<any>(b, ray, best); });
                }
                return;
            }
            for (unsigned m = spheres; m != 0; m &= m - 1) g.meet<any, false>(b, __builtin_ctz(m), span, alive());
            return;
        }
        case PrimitiveKind::box: {
            const auto& b = bvh.at<BoxBlock>(leaf);
            alignas(32) float bounds[6][kBvhWidth];
            for (int axis = 0; axis < 3; ++axis) {
                Float8::load(b.lo[axis]).store(bounds[2 * axis]);
                Float8::load(b.hi[axis]).store(bounds[2 * axis + 1]);
            }
            Float8 depth;
            for (unsigned m = test(bounds, z_end, depth) & distinct(b.id); m != 0; m &= m - 1) {
                g.meet<any>(b, __builtin_ctz(m), alive());
            }
            return;
        }
        default: {
            const auto& b = bvh.at<ConeBlock>(leaf);
            for (int k = 0; k < kBvhWidth; ++k) {
                if (k > 0 && b.id[k] == b.id[k - 1]) continue;
                for (unsigned m = alive(); m != 0; m &= m - 1) g.decide_alone<any>(__builtin_ctz(m), b.id[k]);
            }
        }
    }
}

// The order of a node's children. Near first finds hits earlier; the order in memory is known earlier.
enum class ChildOrder { near_first, as_stored };

template <bool any, ChildOrder order>
inline void traverse_group(const BvhView& bvh, Group& g, const Span& span, const GroupSlabs& slabs, unsigned octant) noexcept {
    const SpanTest test(span);
    PacketStack stack;
    float end = end_of(g, span);
    BvhRef at = 0;
    unsigned lanes = g.active;
    for (;;) {
        if ((at & kLeafBit) == 0) {
            const BvhNode& node = bvh.at<BvhNode>(at);
            Float8 depth;
            const unsigned mask = test(node.bounds, Float8::set(end), depth);
            const int before = stack.top;
            const Float16 limit = Float16::load(g.t);
            if constexpr (order == ChildOrder::as_stored) {
                for (unsigned m = mask; m != 0; m &= m - 1) {
                    const int k = __builtin_ctz(m);
                    fetch(bvh, node.child[k]);
                    stack.push_if_any(node.child[k], slabs(node, k, limit) & lanes);
                }
            } else if (mask != 0) {
                alignas(32) float depths[kBvhWidth];
                if (!any) depth.store(depths);
                alignas(32) std::uint32_t far_first[kBvhWidth];
                const int count = sort_children(node, mask, 3 * octant, far_first);
                for (int i = 0; i < count; ++i) {
                    const auto k = static_cast<int>(far_first[i]);
                    fetch(bvh, node.child[k]);
                    const unsigned entering = slabs(node, k, limit) & lanes;
                    if (!any && entering == 0) continue;
                    if (!any) stack.depth[stack.top] = depths[k];
                    stack.push_if_any(node.child[k], entering);
                }
            }
            if (stack.top != before) {
                at = stack.ref[--stack.top];
                lanes = stack.lanes[stack.top];
                continue;
            }
        } else {
            meet_leaf<any>(at, bvh, span, test, Float8::set(end), lanes, g);
            if (any && g.active == 0) return;
            if (!any && g.found != 0) end = end_of(g, span);
        }
        do {
            if (stack.top == 0) return;
            --stack.top;
            lanes = any ? stack.lanes[stack.top] & g.active : stack.lanes[stack.top];
        } while (lanes == 0 || (!any && stack.depth[stack.top] > end));
        at = stack.ref[stack.top];
    }
}

}  // namespace glint::GLINT_ISA
