// The entry points of the walk through a grid, one table per instruction set, all giving the same bits.
// Knows grids by their layout only; planes and the choice of the table are the caller's.
#pragma once

#include "accel/bvh_kernels.h"
#include "accel/grid_layout.h"

namespace glint {

struct GridKernels {
    // `best` starts with the distance to beat and what is hit there (nothing: kNoPrimitive), and is improved.
    void (*closest)(const GridView&, const Ray&, Hit& best) noexcept;
    bool (*occluded)(const GridView&, const Ray&) noexcept;
    // nodes: cells entered; leaves: blocks tested.
    void (*count_closest)(const GridView&, const Ray&, TraversalCounts&) noexcept;
};

namespace isa_baseline {
extern const GridKernels grid_kernels;
}
namespace isa_avx2 {
extern const GridKernels grid_kernels;
}
namespace isa_avx512 {
extern const GridKernels grid_kernels;
}

[[nodiscard]] const GridKernels& grid_kernels_for(Isa isa);

}  // namespace glint
