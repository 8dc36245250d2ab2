// The upper of two levels: instances in a tree of their world boxes, and below it one accelerator of kind A for each prototype.
// Knows A by its queries only. Invariant: a box is so large that no hit computed in the instance's own space lies outside, for
// any ray (accel/README.md has the sum), and the nearer hit wins, at equal t the lower id, wherever it comes from.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "accel/bvh.h"
#include "accel/geometry.h"
#include "accel/instance_kernels.h"
#include "accel/ray_batch.h"

namespace glint {

// The boxes of all instances, in a tree of their own.
class InstanceBoxes {
public:
    InstanceBoxes(const Geometry& world, const ParallelFor& parallel_for);

    [[nodiscard]] const BvhView& view() const { return view_; }
    // What to tell the kernels, so that the boxes are padded enough for rays from so far away.
    [[nodiscard]] float magnitude_for(float largest_coordinate) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const { return tree_.units.size() * sizeof(BvhTree::Unit); }

private:
    BvhTree tree_;
    BvhView view_;
    double near_origin_ = 0.0;  // rays from within this far find the boxes large enough as they are
    double most_bend_ = 0.0;    // of all instances, see kMaxBend
};

template <class A>
class InstanceLevel {
public:
    using MakeAccelerator = std::function<A(std::shared_ptr<const Geometry>)>;
    // Null for a world without instances.
    static std::shared_ptr<const InstanceLevel> build(std::shared_ptr<const Geometry> world, const ParallelFor& parallel_for,
                                                      Isa isa, const MakeAccelerator& make);

    // Each improves what it is given: the nearest hit so far with its distance, or whether there was any.
    void closest_hit(const Ray& ray, Hit& best) const noexcept;
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept;
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept;
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const;
    // Adds what closest_hit() costs below the boxes.
    void count_traversal(const Ray& ray, Hit best, TraversalCounts& counts) const noexcept;

private:
    struct Query;
    struct Below {
        A accelerator;
        std::uint32_t first_rank[4];  // of each kind's primitives, see Geometry::rank()
    };
    InstanceLevel(std::shared_ptr<const Geometry> world, const ParallelFor& parallel_for, Isa isa, const MakeAccelerator& make);
    template <class Visit>
    void for_each(const Ray& ray, const float& limit, Visit visit) const noexcept;
    template <class Visit>
    void for_each(const RayBatch& rays, const float* limit, Visit visit) const noexcept;
    void keep(const Instance& instance, const Hit& found, Hit& best) const noexcept;

    std::shared_ptr<const Geometry> world_;
    InstanceBoxes boxes_;
    std::vector<Below> below_;  // by prototype
    const InstanceKernels* kernels_;
};

}  // namespace glint
