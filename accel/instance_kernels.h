// The walk over the boxes of instances and the step into an instance's space, one table per instruction set with the same bits.
// Knows neither prototypes nor their accelerators: who meets a box is handed to a visitor.
#pragma once

#include "accel/bvh_layout.h"
#include "accel/instance.h"
#include "accel/isa.h"
#include "accel/ray_batch.h"

namespace glint {

// Hears of one instance that rays of a batch may meet: their places in the batch, ascending, at least one.
struct InstanceVisitor {
    void* self;
    void (*visit)(void* self, std::uint32_t instance, const std::uint16_t* rays, int count) noexcept;
};

struct InstanceKernels {
    // Visits every instance whose box a ray may enter at a distance up to limit[ray], nearer ones first where that is cheap.
    // Visits may lower limits, which stand at a multiple of 64 bytes. `magnitude`: of the boxes, or more, which pads them more.
    // Rays that the boxes' arithmetic cannot serve are left out; their places are written to `unusable`, and their number is
    // returned.
    int (*walk)(const BvhView& boxes, const RayBatch& rays, float magnitude, const float* limit, const InstanceVisitor& visitor,
                std::uint16_t* unusable) noexcept;
    // The same for a single ray, whose place is 0. False, without a visit, where it cannot be served.
    bool (*walk_one)(const BvhView& boxes, const Ray& ray, float magnitude, const float* limit,
                     const InstanceVisitor& visitor) noexcept;
    // object_ray() for rays index[0] ... index[count - 1] with limit[ray] as their t_max, into a batch of the same order.
    void (*to_object)(const AffineMap& map, const RayBatch& rays, const std::uint16_t* index, int count, const float* limit,
                      RayBatch& object) noexcept;
};

namespace isa_baseline {
extern const InstanceKernels instance_kernels;
}
namespace isa_avx2 {
extern const InstanceKernels instance_kernels;
}
namespace isa_avx512 {
extern const InstanceKernels instance_kernels;
}

[[nodiscard]] const InstanceKernels& instance_kernels_for(Isa isa);

}  // namespace glint
