// Node visits and primitive tests per ray, the part of a query's cost that no machine changes.
// The one place that will know how an accelerator counts; until one does, there is nothing to tell.
#pragma once

#include <optional>

#include "competitor.h"

namespace glint::bench {

struct TraversalCost {
    double nodes = 0.0, primitives = 0.0;  // per ray
};

[[nodiscard]] inline std::optional<TraversalCost> traversal_cost(const Bvh&, const RaySet&) { return std::nullopt; }

}  // namespace glint::bench
