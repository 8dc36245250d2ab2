// Uniform grid walked by a 3-D DDA (Amanatides & Woo 1987), cells as one array of ids with offsets.
// A few primitives much larger than the rest stay outside and are tested for every ray.
// Invariant: a primitive inside is listed in every cell that its bounds touch when grown by the rounding error of any ray that
// starts within kFarOrigin times the geometry's size; rays from farther away are answered by brute force.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/brute_force.h"

namespace glint {

class UniformGrid {
public:
    explicit UniformGrid(std::shared_ptr<const Geometry> geometry);

    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept;
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept { closest_hits_one_by_one(*this, rays, hits); }
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept { occluded_one_by_one(*this, rays, result); }
    [[nodiscard]] std::size_t memory_bytes() const;
    [[nodiscard]] glm::ivec3 resolution() const { return resolution_; }
    [[nodiscard]] std::size_t reference_count() const { return ids_.size(); }
    // The lower corner of a cell.
    [[nodiscard]] glm::dvec3 corner(glm::ivec3 cell) const { return lo_ + glm::dvec3(cell) * cell_; }

private:
    template <bool any>
    Hit traverse(const Ray& ray) const noexcept;
    void choose_resolution(std::size_t primitives, double cells_per_primitive);
    // Cells that `box` touches, both corners included.
    void cell_range(const Aabb& box, glm::ivec3& first, glm::ivec3& last) const;
    [[nodiscard]] std::size_t cell_index(glm::ivec3 c) const;
    // Counts the references of the chosen resolution, then fills offsets_ and ids_.
    [[nodiscard]] std::size_t count_references(const std::vector<Aabb>& bounds) const;
    void fill(const std::vector<PrimitiveId>& ids, const std::vector<Aabb>& bounds);

    std::shared_ptr<const Geometry> geometry_;
    BruteForce brute_force_;
    float magnitude_ = 0.0f;
    glm::dvec3 lo_{0.0}, cell_{1.0}, hi_{0.0};
    glm::ivec3 resolution_{0};
    std::vector<std::uint32_t> offsets_;  // of each cell's ids, x fastest; one more at the end
    std::vector<PrimitiveId> ids_;
    std::vector<PrimitiveId> large_;  // kept out of the cells, tested for every ray
};

}  // namespace glint
