// The reference and the oracle: a loop over every primitive. Its answers define what the other accelerators must return.
#pragma once

#include <memory>
#include <vector>

#include "accel/primitive.h"
#include "accel/ray_batch.h"

namespace glint {

class BruteForce {
public:
    explicit BruteForce(std::shared_ptr<const Geometry> geometry);

    [[nodiscard]] Hit closest_hit(const Ray& ray) const noexcept;
    [[nodiscard]] bool occluded(const Ray& ray) const noexcept;
    void closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept { closest_hits_one_by_one(*this, rays, hits); }
    void occluded(const RayBatch& rays, OccludedBatch& result) const noexcept { occluded_one_by_one(*this, rays, result); }
    [[nodiscard]] std::size_t memory_bytes() const { return 0; }

private:
    std::shared_ptr<const Geometry> geometry_;
    float magnitude_;
    std::vector<BruteForce> prototypes_;
};

}  // namespace glint
