// The entry points of the BVH's traversal, one table per instruction set, all giving the same bits.
// Knows trees by their layout only; planes and the choice of the table are the caller's.
#pragma once

#include "accel/bvh_layout.h"
#include "accel/isa.h"
#include "accel/ray_batch.h"

namespace glint {

// What a query cost: nodes entered, leaf blocks tested, and primitives in them.
struct TraversalCounts {
    std::uint64_t rays = 0, nodes = 0, leaves = 0, primitives = 0;
};

struct BvhKernels {
    // `best` starts with the distance to beat and what is hit there (nothing: kNoPrimitive), and is improved.
    void (*closest)(const BvhView&, const Ray&, Hit& best) noexcept;
    bool (*occluded)(const BvhView&, const Ray&) noexcept;
    // The same for a batch; `hits` start as `best` does.
    void (*closest_batch)(const BvhView&, const RayBatch&, HitBatch& hits) noexcept;
    // Sets result[i] where ray i hits; skips entries that are true already.
    void (*occluded_batch)(const BvhView&, const RayBatch&, bool* result) noexcept;
    void (*count_closest)(const BvhView&, const Ray&, TraversalCounts&) noexcept;
};

namespace isa_baseline {
extern const BvhKernels kernels;
}
namespace isa_avx2 {
extern const BvhKernels kernels;
}
namespace isa_avx512 {
extern const BvhKernels kernels;
}

[[nodiscard]] const BvhKernels& bvh_kernels(Isa isa);

// One primitive in the baseline instruction set: the cases that the kernels leave to the scalar code.
void intersect_alone(const Ray& ray, float magnitude, const Geometry& geometry, PrimitiveId id, Hit& best) noexcept;

}  // namespace glint
