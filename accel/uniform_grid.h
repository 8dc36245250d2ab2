// Uniform grid over blocks of eight primitives, walked by a 3-D DDA in the best instruction set of the machine. A crowded cell
// holds a grid of its own; a few primitives much larger than the rest stay outside and are tested for every ray.
// Invariant: a block is listed in every cell that one of its primitives touches when grown by the rounding error of a ray from
// nearby; a ray from farther away visits all cells within its own error.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/grid_build.h"
#include "accel/grid_kernels.h"
#include "accel/parallel.h"
#include "accel/primitive.h"

namespace glint {

template <class A>
class InstanceLevel;

class UniformGrid {
public:
    explicit UniformGrid(std::shared_ptr<const Geometry> geometry, const ParallelFor& parallel_for = serial_for,
                         Isa isa = isa_in_use(), const GridDensity& density = {});

    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept;
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept;
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const;
    // Of the outermost level; 0 when there is nothing in it.
    [[nodiscard]] glm::ivec3 resolution() const;
    // The lower corner of one of its cells.
    [[nodiscard]] glm::dvec3 corner(glm::ivec3 cell) const;
    [[nodiscard]] std::size_t reference_count() const { return cells_.references; }  // blocks in cells
    [[nodiscard]] std::size_t cell_count() const { return cells_.cells.size(); }     // of all levels
    [[nodiscard]] std::size_t level_count() const { return cells_.levels.size(); }
    // Rays that start with a coordinate beyond this are walked in slices.
    [[nodiscard]] float near_origin() const { return near_origin_; }
    // What closest_hit() costs for these rays: nodes are cells, leaves are blocks.
    [[nodiscard]] TraversalCounts count_traversal(const RayBatch& rays) const noexcept;

private:
    void build_cells(const ParallelFor& parallel_for, const GridDensity& density);
    [[nodiscard]] Hit closest_own(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded_by_own(const Ray& ray) const noexcept;
    [[nodiscard]] GridView view() const noexcept;

    std::shared_ptr<const Geometry> geometry_;
    GridBlocks blocks_;
    GridCells cells_;
    std::vector<BvhRef> large_;  // blocks kept out of the cells
    float magnitude_ = 0.0f, near_origin_ = 0.0f;
    double padding_ = 0.0;
    bool has_planes_ = false;
    const GridKernels* kernels_;
    std::shared_ptr<const InstanceLevel<UniformGrid>> instances_;  // null where there are none
};

}  // namespace glint
