// Bounding volume hierarchy: nodes of up to eight children, leaves of up to eight primitives of one kind, traced by one ray, by
// packets or by many rays in flight, in the best instruction set of the machine.
// Knows boxes and ids; what a primitive is stays in primitive.h. Invariant: every ancestor's box contains the bounds of the
// primitives below it and the box tests are conservative, so no hit is ever culled.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/bvh_kernels.h"
#include "accel/huge_pages.h"
#include "accel/parallel.h"
#include "accel/primitive.h"

namespace glint {

// Levels of nodes; the depth of the traversal's stack hangs on it.
constexpr int kMaxBvhDepth = 64;

template <class A>
class InstanceLevel;

struct BvhTree {
    struct alignas(kBvhUnit) Unit {
        std::byte bytes[kBvhUnit];
    };
    using Units = std::vector<Unit, HugePageAllocator<Unit>>;
    Units units;  // empty for an empty scene
    Aabb bounds;
    int depth = 0;             // levels of nodes
    float leaf_extent = 0.0f;  // mean of the leaves' widest sides: how fine the geometry is that has most of them
    std::size_t nodes = 0, leaves = 0;

    [[nodiscard]] BvhView view(const Geometry& geometry) const;
};

// quality: for many rays. fast: a fraction of the time to build, a little slower to trace, for a first look or few rays.
enum class BuildQuality { fast, quality };

// Binned surface area heuristic, of primitives (quality) or of clusters along a space-filling curve (fast); eight-way nodes by
// opening the largest child (Wald, Benthin & Boulos 2008, "Getting rid of packets"); median splits where all centres agree or
// the tree grows too deep. The tree depends on the geometry and the quality alone, not on the threads.
// Throws std::length_error when there are more primitives than references can name (about 10^8 units of 64 bytes).
[[nodiscard]] BvhTree build_bvh(const Geometry& geometry, const ParallelFor& parallel_for = serial_for,
                                BuildQuality quality = BuildQuality::quality);

class Bvh {
public:
    explicit Bvh(std::shared_ptr<const Geometry> geometry, const ParallelFor& parallel_for = serial_for, Isa isa = isa_in_use(),
                 BuildQuality quality = BuildQuality::quality);

    // Inline, as the call on top of the kernel's took 2 to 4 % of a camera ray.
    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept {
        if (!tree_alone_) return closest_of_all(ray);
        Hit best;
        best.t = ray.t_max;
        kernels_->closest(view_, ray, best);
        return best;
    }
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept {
        return tree_alone_ ? kernels_->occluded(view_, ray) : occluded_by_any(ray);
    }
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept;
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const;
    [[nodiscard]] const BvhTree& tree() const { return tree_; }
    // What closest_hit() costs for these rays.
    [[nodiscard]] TraversalCounts count_traversal(const RayBatch& rays) const noexcept;

private:
    [[nodiscard]] Hit closest_of_all(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded_by_any(const Ray& ray) const noexcept;

    std::shared_ptr<const Geometry> geometry_;
    BvhTree tree_;
    BvhView view_;
    bool has_planes_ = false;
    const BvhKernels* kernels_;
    std::shared_ptr<const InstanceLevel<Bvh>> instances_;  // null where there are none
    bool tree_alone_ = false;                              // there is a tree, and neither planes nor instances
};

}  // namespace glint
