// `glint chart`: speed against accuracy, measured and drawn.
// Knows the order of the experiments; what they are stands in chart_experiments.h and chart_scaling.h.
#pragma once

#include "app/options.h"

namespace glint {

// Measures what the options name and writes index.html, pictures and numbers into the output folder. Returns the exit code:
// 128+n when signal n ended it, with all that was measured written. Throws ImageError before anything is measured when
// the folder cannot be written.
[[nodiscard]] int run_chart(const Options& options);

}  // namespace glint
