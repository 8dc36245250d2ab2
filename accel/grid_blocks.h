// Primitives in blocks of eight neighbours of one kind: what the cells of a grid list. Each primitive is stored once.
// Knows no cells. Invariant: blocks depend on geometry and ids alone, never on threads.
#pragma once

#include <vector>

#include "accel/bvh_layout.h"
#include "accel/geometry.h"
#include "accel/grid_order.h"
#include "accel/huge_pages.h"
#include "accel/parallel.h"

namespace glint {

struct GridBlocks {
    struct alignas(kBvhUnit) Unit {
        std::byte bytes[kBvhUnit];
    };
    std::vector<Unit, HugePageAllocator<Unit>> units;  // the first is not used, so that no reference is 0
    std::vector<BvhRef> refs;                          // of each block
    std::vector<std::uint32_t> first;                  // of each block's primitives as reordered; one more at the end
    std::size_t large = 0;                             // so many blocks at the start hold the large primitives
};

// Reorders `primitives` so that each block's are neighbours, by splits at medians, the largest extent first. The first `large`
// of them get blocks of their own.
// Throws std::length_error when there are more than references can name.
[[nodiscard]] GridBlocks make_grid_blocks(const Geometry& geometry, std::vector<BoundedPrimitive>& primitives, std::size_t large,
                                          const ParallelFor& parallel_for);

}  // namespace glint
