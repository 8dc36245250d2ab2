// Which scenes are charted, and the references that judge them, rendered once and kept.
// Knows the command line's wishes as far as scenes go, and no experiment.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/chart_bench.h"
#include "app/chart_experiments.h"
#include "app/options.h"

namespace glint::chart {

// The scenes named on the command line, or built-in ones that are hard in different ways. Throws UsageError or SceneError.
[[nodiscard]] std::vector<Subject> subjects_of(const Options& options);

// From files in `folder` where they are right, else rendered and written there; what was found wrong is said on stderr, and a
// row about each goes to `table`.
[[nodiscard]] References references_of(Bench& bench, const Effort& effort, const std::filesystem::path& folder, bool quiet,
                                       Meter& meter, Table& table);
// What that takes if nothing is there yet.
[[nodiscard]] double planned_reference_seconds(Bench& bench, const Effort& effort);

// Everything that decides a reference, in words: scene, camera, settings, size, samples, version, and the bytes of a few samples.
[[nodiscard]] std::string reference_key(Bench& bench, const RenderSettings& settings, int spp);

}  // namespace glint::chart
