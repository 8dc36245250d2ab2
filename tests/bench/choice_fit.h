// From measured costs to the constants of core/accelerator_choice.cpp: straight lines, fitted in relative error.
// Knows the model's shape, not its present constants.
#pragma once

#include <string>
#include <vector>

#include "choice_cost.h"
#include "core/scene.h"

namespace glint::bench {

struct Measured {
    std::shared_ptr<const Scene> scene;
    DemandCost cost;
};
// Lines to read the constants from: building by primitives, a ray by doublings of blocks, for scenes of triangles and others.
[[nodiscard]] std::string fitted_constants(const std::vector<Measured>& measured);

}  // namespace glint::bench
