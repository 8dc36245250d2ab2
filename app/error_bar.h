// An error estimate as users see it: in words, as JSON, and when a target will be reached. Knows no renderer and no clock.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/error_estimate.h"
#include "core/renderer.h"

namespace glint {

// `relRMSE 0.0123 ± 0.0004` (half the 95 % interval), `exact`, or empty where nothing is known.
[[nodiscard]] std::string error_text(const ErrorEstimate& estimate);

// When `render --noise target` would stop, at the speed so far.
struct Forecast {
    double target = 0.0;
    int spp = 0;           // 0 = not known
    double seconds = 0.0;  // of rendering from the start
};
[[nodiscard]] Forecast forecast(const ErrorEstimate& estimate, const Progress& progress, std::size_t pixels, double target);

// The next of ... 0.1, 0.05, 0.02, 0.01 ... that the picture is not sure to have reached.
[[nodiscard]] double next_target(const ErrorEstimate& estimate);

// {"relrmse", "low", "high", "slope", "spp", "predicted": {"target", "spp", "seconds"}}; null for what is not known.
[[nodiscard]] nlohmann::json error_json(const ErrorEstimate& estimate, const Forecast& forecast);

}  // namespace glint
