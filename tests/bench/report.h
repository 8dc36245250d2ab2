// What was measured on a scene, as Markdown tables and as JSON with every round.
// Knows no clock and no ray.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "measure.h"
#include "traversal_cost.h"
#include "verify.h"

namespace glint::bench {

struct SetResult {
    Check check;
    std::optional<TraversalCost> cost;
    std::vector<std::vector<Rates>> by_threads;  // parallel to SceneResult::threads
};

struct SceneResult {
    std::string name;
    std::size_t triangles = 0, spheres = 0, left_out = 0;
    std::vector<int> threads;
    std::vector<Build> builds;
    std::vector<SetResult> sets;
    long peak_kib = 0;  // of the process so far
};

[[nodiscard]] std::string to_markdown(const SceneResult& result);
[[nodiscard]] nlohmann::json to_json(const SceneResult& result);

}  // namespace glint::bench
