// Node visits and primitive tests per ray of the one-ray BVH, the part of a query's cost that no machine changes.
// The one place that knows how an accelerator counts.
#pragma once

#include <optional>

#include "competitor.h"

namespace glint::bench {

struct TraversalCost {
    double nodes = 0.0, leaves = 0.0, primitives = 0.0;  // per ray
};

// Empty for shadow rays: the BVH counts closest hits only.
[[nodiscard]] inline std::optional<TraversalCost> traversal_cost(const Bvh& bvh, const RaySet& set) {
    if (set.any || set.rays.empty()) return std::nullopt;
    TraversalCost sum;
    RayBatch batch;
    for (std::size_t first = 0; first < set.rays.size(); first += kRayBatch) {
        batch.clear(set.order);
        for (std::size_t i = first; i < std::min(set.rays.size(), first + kRayBatch); ++i) batch.push(set.rays[i]);
        const TraversalCounts counts = bvh.count_traversal(batch);
        sum.nodes += static_cast<double>(counts.nodes);
        sum.leaves += static_cast<double>(counts.leaves);
        sum.primitives += static_cast<double>(counts.primitives);
    }
    const auto rays = static_cast<double>(set.rays.size());
    return TraversalCost{sum.nodes / rays, sum.leaves / rays, sum.primitives / rays};
}

}  // namespace glint::bench
