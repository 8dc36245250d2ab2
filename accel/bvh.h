// Bounding volume hierarchy: binned-SAH binary tree collapsed into nodes of up to eight children.
// Knows boxes and ids; what a primitive is stays in primitive.h. Invariant: every ancestor's box contains the bounds of
// the primitives below it, so by the monotone slab test no hit is ever culled.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/primitive.h"
#include "accel/ray_batch.h"

namespace glint {

constexpr int kBvhWidth = 8;
// Levels of the binary tree before the collapse; median splits below kSahDepth keep the sum within it.
constexpr int kMaxBvhDepth = 64;

struct alignas(64) BvhNode {
    float bounds[6][kBvhWidth];      // lo x y z, hi x y z; an absent child has lo = +inf, hi = -inf and is never entered
    std::uint32_t child[kBvhWidth];  // inner: node index; leaf: first entry of ids
    std::uint32_t count[kBvhWidth];  // 0 = inner, else number of ids
};

struct BvhTree {
    std::vector<BvhNode> nodes;    // nodes[0] is the root; empty for an empty scene
    std::vector<PrimitiveId> ids;  // leaf contents
    int depth = 0;                 // of the binary tree
};

// Binned surface area heuristic (Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"),
// median split where all centroids agree or the tree grows too deep.
[[nodiscard]] BvhTree build_bvh(const Geometry& geometry);

class Bvh {
public:
    explicit Bvh(std::shared_ptr<const Geometry> geometry);

    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept;
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept { closest_hits_one_by_one(*this, rays, hits); }
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept { occluded_one_by_one(*this, rays, result); }
    [[nodiscard]] std::size_t memory_bytes() const;
    [[nodiscard]] const BvhTree& tree() const { return tree_; }

private:
    template <bool any>
    Hit traverse(const Ray& ray) const noexcept;

    std::shared_ptr<const Geometry> geometry_;
    BvhTree tree_;
    float magnitude_ = 0.0f;
};

}  // namespace glint
