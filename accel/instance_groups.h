// The walk over the boxes of instances for coherent rays: sixteen at a time by the space that they span, and the whole batch by
// its common span where its groups lie side by side. Rays are told apart at the boxes of instances only.
// Invariant: a box that the span of a group rejects holds no hit of any of its rays.
#pragma once

#include "accel/bvh_packet.h"
#include "accel/bvh_span.h"
#include "accel/instance_kernels.h"

namespace glint::GLINT_ISA {

constexpr std::uint32_t kInstanceMask = (1u << 29) - 1;  // of a box's id, which is the instance's number

class GroupWalk {
public:
    // Puts the places of rays that share no span into `rest` and returns their number.
    int gather_all(const BvhView& boxes, const RayBatch& rays, const float* limit, std::uint16_t* rest) noexcept {
        boxes_ = &boxes;
        limit_ = limit;
        int left = 0, together = 0;
        for (int i = 0; i * kGroup < rays.count; ++i) {
            const int first = i * kGroup, n = rays.count - first < kGroup ? rays.count - first : kGroup;
            Float16 padding;
            if (gather(boxes, rays, first, n, groups_[i], spans_[i], padding) && bound_by_planes(spans_[i])) {
                groups_[i].active = (1u << n) - 1u;
                tests_[i] = SpanTest(spans_[i]);
                slabs_[i] = GroupSlabs(groups_[i], padding);
                alive_ |= 1u << i;
                update(i);
                together += together == i ? 1 : 0;
                continue;
            }
            for (int l = 0; l < n; ++l) rest[left++] = static_cast<std::uint16_t>(first + l);
        }
        const bool all = together * kGroup >= rays.count && together > 1;
        joined_ = all && join(spans_, together, span_);
        if (joined_) test_ = SpanTest(span_);
        octant_ = (rays.direction[0][0] >= 0.0f ? 1u : 0u) | (rays.direction[1][0] >= 0.0f ? 2u : 0u) |
                  (rays.direction[2][0] >= 0.0f ? 4u : 0u);
        return left;
    }

    void run(const InstanceVisitor& visitor) noexcept {
        int top = 0;
        refs_[top] = 0;
        masks_[top++] = static_cast<std::uint16_t>(alive_);
        while (top > 0) {
            --top;
            const BvhRef at = refs_[top];
            const unsigned groups = masks_[top] & alive_;
            if (groups == 0) continue;
            if ((at & kLeafBit) != 0) {
                visit_leaf(boxes_->at<BoxBlock>(at), groups, visitor);
                continue;
            }
            const BvhNode& node = boxes_->at<BvhNode>(at);
            unsigned entered[kBvhWidth] = {};
            if (joined_) {
                Float8 depth;
                for (unsigned m = test_(node.bounds, Float8::set(farthest()), depth); m != 0; m &= m - 1)
                    entered[__builtin_ctz(m)] = groups;
            } else {
                divide(node.bounds, groups, entered);
            }
            for (int i = 0; i < kBvhWidth; ++i) {
                const unsigned k = node.order[i] >> (3 * octant_) & 7u;
                refs_[top] = node.child[k];
                masks_[top] = static_cast<std::uint16_t>(entered[k]);
                top += entered[k] != 0 ? 1 : 0;
            }
        }
    }

private:
    static constexpr int kMostGroups = kRayBatch / kGroup;

    // What the rays of group i have to beat; without any that looks on it is done.
    void update(int i) noexcept {
        Group& g = groups_[i];
        const auto lanes = Float16::Mask::from_bits(g.active);
        const Float16 t = select(lanes, Float16::load(limit_ + g.first), Float16::set(-1.0f));
        min(t, Float16::set(kLargestT)).store(g.t);
        ends_[i] = end_of(g, spans_[i]);
        if (!(reduce_max(t) >= 0.0f)) alive_ &= ~(1u << i);
    }
    [[nodiscard]] float farthest() const noexcept {
        float end = -HUGE_VALF;
        for (unsigned m = alive_; m != 0; m &= m - 1) {
            const float e = ends_[__builtin_ctz(m)];
            end = e > end ? e : end;
        }
        return end;
    }
    // The groups that may meet each of eight boxes.
    void divide(const float (*bounds)[kBvhWidth], unsigned groups, unsigned* entered) const noexcept {
        Float8 depth;
        for (; groups != 0; groups &= groups - 1) {
            const int i = __builtin_ctz(groups);
            for (unsigned m = tests_[i](bounds, Float8::set(ends_[i]), depth); m != 0; m &= m - 1)
                entered[__builtin_ctz(m)] |= 1u << i;
        }
    }

    // Nearer boxes first, by the first group's axis.
    void visit_leaf(const BoxBlock& block, unsigned groups, const InstanceVisitor& visitor) noexcept {
        BvhNode boxes;  // of which the bounds are used
        alignas(32) float depth[kBvhWidth];
        for (int i = 0; i < 3; ++i) {
            Float8::load(block.lo[i]).store(boxes.bounds[2 * i]);
            Float8::load(block.hi[i]).store(boxes.bounds[2 * i + 1]);
        }
        unsigned left = distinct(block.id), entered[kBvhWidth] = {};
        divide(boxes.bounds, groups, entered);
        Float8 nearest;
        (void)tests_[__builtin_ctz(groups)](boxes.bounds, Float8::set(kLargestT), nearest);
        nearest.store(depth);
        while (left != 0) {
            int k = -1;
            for (unsigned m = left; m != 0; m &= m - 1) {
                const int other = __builtin_ctz(m);
                if (k < 0 || depth[other] < depth[k]) k = other;
            }
            left &= ~(1u << k);
            visit(visitor, boxes, k, block.id[k] & kInstanceMask, entered[k] & alive_);
        }
    }

    // The rays of `groups` that may meet box k before what they have hit by now.
    void visit(const InstanceVisitor& visitor, const BvhNode& boxes, int k, std::uint32_t instance, unsigned groups) noexcept {
        int n = 0;
        for (unsigned m = groups; m != 0; m &= m - 1) {
            const Group& g = groups_[__builtin_ctz(m)];
            unsigned lanes = slabs_[__builtin_ctz(m)](boxes, k, Float16::load(g.t)) & g.active;
            for (; lanes != 0; lanes &= lanes - 1) places_[n++] = static_cast<std::uint16_t>(g.first + __builtin_ctz(lanes));
        }
        if (n == 0) return;
        visitor.visit(visitor.self, instance, places_, n);
        for (unsigned m = groups; m != 0; m &= m - 1) update(__builtin_ctz(m));
    }

    const BvhView* boxes_;
    const float* limit_;
    unsigned alive_ = 0, octant_;  // groups that still look
    bool joined_;
    Span span_, spans_[kMostGroups];
    SpanTest test_, tests_[kMostGroups];
    GroupSlabs slabs_[kMostGroups];
    Group groups_[kMostGroups];
    float ends_[kMostGroups];
    BvhRef refs_[kStackSize];
    std::uint16_t masks_[kStackSize];
    std::uint16_t places_[kRayBatch];
};

}  // namespace glint::GLINT_ISA
