#include "accel/instance_kernels.h"

#include "accel/instance_groups.h"

// Compiled once per instruction set (CMakeLists.txt says with which flags).
namespace glint::GLINT_ISA {
namespace {

// What box tests need of each ray of a batch, in one cache line.
struct alignas(64) BoxRay {
    float reciprocal[3], near_offset[3], far_offset[3];
    unsigned octant;

    void set(const RayScalars& s) noexcept {
        for (int i = 0; i < 3; ++i) {
            reciprocal[i] = s.reciprocal[i];
            near_offset[i] = s.near_offset[i];
            far_offset[i] = s.far_offset[i];
        }
        octant = s.octant;
    }
};

// enter() of bvh_rays.h for eight boxes whose sides lie in rows: lo x at row 0 and the next axis `step` rows on, hi `beside` on.
template <int kStep, int kBeside>
unsigned enter_rows(const float (*rows)[kBvhWidth], const BoxRay& ray, Float8 limit, Float8& near) noexcept {
    Float8 n[3], f[3];
    for (int i = 0; i < 3; ++i) {
        const int back = (ray.octant >> i & 1u) != 0 ? 0 : kBeside;
        const Float8 r = Float8::set(ray.reciprocal[i]);
        n[i] = mul_sub(Float8::load(rows[i * kStep + back]), r, Float8::set(ray.near_offset[i]));
        f[i] = mul_sub(Float8::load(rows[i * kStep + (kBeside - back)]), r, Float8::set(ray.far_offset[i]));
    }
    near = max(max(n[0], n[1]), max(n[2], Float8::set(0.0f)));
    return le(near, min(min(f[0], f[1]), min(f[2], limit))).bits();
}

unsigned enter_children(const BvhNode& node, const BoxRay& ray, float limit, Float8& near) noexcept {
    return enter_rows<2, 1>(node.bounds, ray, Float8::set(limit), near);
}
// Without the lanes that repeat the last box.
unsigned enter_boxes(const BoxBlock& block, const BoxRay& ray, float limit, Float8& near) noexcept {
    static_assert(offsetof(BoxBlock, hi) == offsetof(BoxBlock, lo) + sizeof(block.lo));
    return enter_rows<1, 3>(block.lo, ray, Float8::set(limit), near) & distinct(block.id);
}

void visit_single(const BoxBlock& block, const BoxRay& box_ray, const float* limit, std::uint16_t place,
                  const InstanceVisitor& visitor) noexcept {
    Float8 near;
    unsigned mask = enter_boxes(block, box_ray, *limit, near);
    alignas(32) float distance[kBvhWidth];
    near.store(distance);
    while (mask != 0) {
        int nearest = __builtin_ctz(mask);
        for (unsigned m = mask & (mask - 1); m != 0; m &= m - 1) {
            if (distance[__builtin_ctz(m)] < distance[nearest]) nearest = __builtin_ctz(m);
        }
        mask &= ~(1u << nearest);
        if (distance[nearest] <= *limit) visitor.visit(visitor.self, block.id[nearest] & kInstanceMask, &place, 1);
    }
}

void walk_from(const BvhView& boxes, BvhRef root, const BoxRay& ray, const float* limit, std::uint16_t place,
               const InstanceVisitor& visitor) noexcept {
    TraversalStack stack;
    int top = 0;
    BvhRef at = root;
    for (;;) {
        if ((at & kLeafBit) == 0) {
            const BvhNode& node = boxes.at<BvhNode>(at);
            Float8 near;
            const unsigned mask = enter_children(node, ray, *limit, near);
            if (mask != 0) {
                at = push_children(stack, top, node, Float8::Mask::from_bits(mask), 3 * ray.octant, near);
                continue;
            }
        } else {
            visit_single(boxes.at<BoxBlock>(at), ray, limit, place, visitor);
        }
        do {
            if (top == 0) return;
            --top;
        } while (stack.near[top] > *limit);
        at = stack.ref[top];
    }
}

bool walk_one(const BvhView& boxes, const Ray& ray, float magnitude, const float* limit,
              const InstanceVisitor& visitor) noexcept {
    const RayScalars scalars = prepare(&ray.origin.x, &ray.direction.x, magnitude, ray.t_max);
    if (!scalars.usable) return false;
    BoxRay box_ray;
    box_ray.set(scalars);
    walk_from(boxes, 0, box_ray, limit, 0, visitor);
    return true;
}

// Rays that go the same way, each with the distance at which it may enter what the list stands for.
struct RayList {
    BvhRef ref;
    int begin, count;
    float nearest;
};

// The rays of a batch through the tree of boxes, as lists: a ray goes on only to the children that it may enter.
class ListWalk {
public:
    ListWalk(const BvhView& boxes, const float* limit, const InstanceVisitor& visitor) noexcept
        : boxes_(boxes), limit_(limit), visitor_(visitor) {}

    // Of the rays at `places`, ascending, those that can be served; the others go to `unusable`.
    int prepare_rays(const RayBatch& rays, const std::uint16_t* places, int count, std::uint16_t* unusable) noexcept {
        PreparedRays prepared;
        RayScalars scalars;
        int left_out = 0, n = 0;
        for (int k = 0, group = -1; k < count; ++k) {
            const int i = places[k];
            if (i / kGroup != group) prepared.prepare(rays, i / kGroup * kGroup, boxes_.magnitude);
            group = i / kGroup;
            if (!prepared.usable(i % kGroup)) {
                unusable[left_out++] = static_cast<std::uint16_t>(i);
                continue;
            }
            prepared.share(i % kGroup, scalars);
            rays_[i].set(scalars);
            place_[n] = static_cast<std::uint16_t>(i);
            near_[n++] = 0.0f;
        }
        lists_[0] = {0, 0, n, 0.0f};
        depth_ = n > 0 ? 1 : 0;
        return left_out;
    }

    void run() noexcept {
        while (depth_ > 0) {
            const RayList list = lists_[--depth_];
            int n = 0;
            for (int i = list.begin; i < list.begin + list.count; ++i) {
                here_[n] = place_[i];
                n += near_[i] <= limit_[place_[i]] ? 1 : 0;
            }
            if (n == 0) continue;
            const bool leaf = (list.ref & kLeafBit) != 0;
            // A few rays are quicker on their own; and so are many where the tree is deeper than there is room.
            if (n < kFew || list.begin + kBvhWidth * n > kRoom || depth_ + kBvhWidth > kLists) {
                for (int i = 0; i < n; ++i) walk_from(boxes_, list.ref, rays_[here_[i]], limit_ + here_[i], here_[i], visitor_);
            } else if (leaf) {
                visit_leaf(boxes_.at<BoxBlock>(list.ref), n);
            } else {
                divide(boxes_.at<BvhNode>(list.ref), n, list.begin);
            }
        }
    }

private:
    static constexpr int kFew = 3, kRoom = 8192, kLists = 512;

    // Sorts the rays that are here into the eight places of `fan_`, near to far in `order_`.
    template <class Enter>
    int fan_out(int n, Enter enter_eight) noexcept {
        float nearest[kBvhWidth];
        for (int k = 0; k < kBvhWidth; ++k) fan_count_[k] = 0, nearest[k] = HUGE_VALF;
        alignas(32) float distance[kBvhWidth];
        for (int i = 0; i < n; ++i) {
            const std::uint16_t r = here_[i];
            Float8 near;
            unsigned mask = enter_eight(rays_[r], limit_[r], near);
            near.store(distance);
            for (; mask != 0; mask &= mask - 1) {
                const int k = __builtin_ctz(mask);
                const int slot = fan_count_[k]++;
                fan_[k][slot] = r;
                fan_near_[k][slot] = distance[k];
                nearest[k] = distance[k] < nearest[k] ? distance[k] : nearest[k];
            }
        }
        int entered = 0;
        for (int k = 0; k < kBvhWidth; ++k) {
            if (fan_count_[k] == 0) continue;
            int at = entered++;
            for (; at > 0 && nearest[order_[at - 1]] > nearest[k]; --at) order_[at] = order_[at - 1];
            order_[at] = k;
        }
        return entered;
    }

    void divide(const BvhNode& node, int n, int begin) noexcept {
        const int entered =
            fan_out(n, [&](const BoxRay& ray, float limit, Float8& near) { return enter_children(node, ray, limit, near); });
        for (int i = entered - 1; i >= 0; --i) {
            const int k = order_[i];
            lists_[depth_++] = {node.child[k], begin, fan_count_[k], 0.0f};
            for (int r = 0; r < fan_count_[k]; ++r, ++begin) {
                place_[begin] = fan_[k][r];
                near_[begin] = fan_near_[k][r];
            }
        }
    }

    void visit_leaf(const BoxBlock& block, int n) noexcept {
        const int entered =
            fan_out(n, [&](const BoxRay& ray, float limit, Float8& near) { return enter_boxes(block, ray, limit, near); });
        for (int i = 0; i < entered; ++i) {
            const int k = order_[i];
            int left = 0;
            for (int r = 0; r < fan_count_[k]; ++r) {
                here_[left] = fan_[k][r];
                left += fan_near_[k][r] <= limit_[fan_[k][r]] ? 1 : 0;
            }
            if (left > 0) visitor_.visit(visitor_.self, block.id[k] & kInstanceMask, here_, left);
        }
    }

    const BvhView& boxes_;
    const float* limit_;
    const InstanceVisitor& visitor_;
    BoxRay rays_[kRayBatch];
    int depth_ = 0;
    RayList lists_[kLists];
    // The rays of all lists, one list behind the other, and room for the next eight.
    std::uint16_t place_[kRoom];
    float near_[kRoom];
    std::uint16_t here_[kRayBatch];
    int fan_count_[kBvhWidth], order_[kBvhWidth];
    std::uint16_t fan_[kBvhWidth][kRayBatch];
    float fan_near_[kBvhWidth][kRayBatch];
};

int walk(const BvhView& boxes, const RayBatch& rays, float magnitude, const float* limit, const InstanceVisitor& visitor,
         std::uint16_t* unusable) noexcept {
    BvhView padded = boxes;
    padded.magnitude = magnitude;
    std::uint16_t rest[kRayBatch];
    int left = rays.count;
    if (rays.order == RayOrder::divergent) {
        for (int i = 0; i < left; ++i) rest[i] = static_cast<std::uint16_t>(i);
    } else {
        GroupWalk groups;
        left = groups.gather_all(padded, rays, limit, rest);
        groups.run(visitor);
    }
    if (left == 0) return 0;
    ListWalk lists(padded, limit, visitor);
    const int left_out = lists.prepare_rays(rays, rest, left, unusable);
    lists.run();
    return left_out;
}

// Eight rays at a time. The lanes beyond `count` repeat the first ray, so that nothing undefined is computed with.
void to_object(const AffineMap& map, const RayBatch& rays, const std::uint16_t* index, int count, const float* limit,
               RayBatch& object) noexcept {
    object.count = count;
    object.order = rays.order;
    for (int first = 0; first < count; first += kBvhWidth) {
        const int at = index[first];
        Double8 v[6];
        if (at % kBvhWidth == 0 && first + kBvhWidth <= count && index[first + kBvhWidth - 1] == at + kBvhWidth - 1) {
            for (int k = 0; k < 3; ++k) {
                v[k] = widen(Float8::load(rays.origin[k] + at));
                v[3 + k] = widen(Float8::load(rays.direction[k] + at));
            }
            Float8::load(limit + at).store(object.t_max + first);
        } else {
            alignas(32) float in[6][kBvhWidth];
            for (int l = 0; l < kBvhWidth; ++l) {
                const int from = index[first + l < count ? first + l : first];
                for (int k = 0; k < 3; ++k) {
                    in[k][l] = rays.origin[k][from];
                    in[3 + k][l] = rays.direction[k][from];
                }
                object.t_max[first + l] = limit[from];
            }
            for (int k = 0; k < 6; ++k) v[k] = widen(Float8::load(in[k]));
        }
        for (int k = 0; k < 3; ++k) {
            const auto& r = map.row[k];
            const Double8 x = Double8::set(r[0]), y = Double8::set(r[1]), z = Double8::set(r[2]);
            narrow(((x * v[0] + y * v[1]) + z * v[2]) + Double8::set(r[3])).store(object.origin[k] + first);
            narrow((x * v[3] + y * v[4]) + z * v[5]).store(object.direction[k] + first);
        }
    }
}

}  // namespace

const InstanceKernels instance_kernels{walk, walk_one, to_object};

}  // namespace glint::GLINT_ISA
