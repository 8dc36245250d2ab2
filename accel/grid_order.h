// Orders primitives so that each eight in a row are neighbours: what makes good blocks.
// Knows bounds, no primitive and no cells. Invariant: the order depends on its input alone, never on threads.
#pragma once

#include <vector>

#include "accel/geometry.h"
#include "accel/parallel.h"

namespace glint {

struct BoundedPrimitive {
    Aabb bounds;
    PrimitiveId id;
};

struct OrderRange {
    std::size_t begin, end;
};

// Reorders each range by itself: halves of whole blocks (but for the last) at medians across the widest extent of centres,
// until they are blocks. Primitives outside the ranges stay where they are.
void order_by_neighbours(std::vector<BoundedPrimitive>& primitives, std::vector<OrderRange> ranges,
                         const ParallelFor& parallel_for);

}  // namespace glint
