// The leaves of the fast build, written along a space-filling curve a cluster of neighbours at a time, while their primitives are
// in the first cache. Knows no nodes. Invariant: what is written depends on the geometry alone, not on threads.
#pragma once

#include "accel/bvh_writer.h"

namespace glint {

struct LeafClusters {
    BvhPart written;     // room for a root, then all leaves
    BuildRefs leaves;    // id: the reference to the leaf; weight: 1
    BuildRefs clusters;  // id: the number of the first leaf; weight: how many leaves, at most kMaxSweep
};

[[nodiscard]] LeafClusters write_clusters(const Geometry& geometry, const ParallelFor& parallel_for);

}  // namespace glint
