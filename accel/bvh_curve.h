// Primitives in the order of a space-filling curve (Morton 1966), and neighbours on it gathered in clusters, after Pantaleoni &
// Luebke 2010, "HLBVH". Knows no tree. Invariant: the order depends on the geometry alone.
#pragma once

#include "accel/bvh_split.h"

namespace glint {

// `refs`: all bounded primitives along the curve. `clusters`: those of one cell of the curve each, id = number of the first of
// them, weight = how many: at most kMaxSweep, unless the finest cell holds more.
void cluster_along_curve(const Geometry& geometry, const ParallelFor& parallel_for, BuildRefs& refs, BuildRefs& clusters);

}  // namespace glint
