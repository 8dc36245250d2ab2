// One picture against another: `glint compare A B`, and `glint render --reference FILE` after rendering.
// Decides what is compared (radiance with radiance, or display bytes with display bytes), by which metric, and against which
// threshold; computes nothing itself. A picture with a pixel that is not finite is never within a threshold.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/options.h"
#include "core/image.h"

namespace glint {

// Prints every metric, one a line as `name value`, or with --stats json one object; writes the error image of -o. Returns the
// program's exit code: 1 when over the threshold.
[[nodiscard]] int run_compare(const Options& options);

// Whether a value of the metric is good enough; without a threshold only equality is.
[[nodiscard]] bool within_threshold(const Options& options, double value);

// The picture of `render --reference`, read before anything is rendered.
class Reference {
public:
    // Throws ImageError when the file cannot be read or its picture is not of that size.
    Reference(const Options& options, int width, int height);

    struct Verdict {
        bool within = false;
        double value = 0.0;  // of the chosen metric
    };
    // `rendered` holds radiance; against a reference of display bytes it is taken as it is displayed. Adds "reference" to
    // `stats`: file, metric, threshold, within and all values.
    // Root mean relative squared error: what error estimates are about.
    [[nodiscard]] double relrmse(const Image& rendered, const DisplaySettings& display) const;
    [[nodiscard]] Verdict check(const Image& rendered, const DisplaySettings& display, nlohmann::json& stats) const;

private:
    [[nodiscard]] StoredImage like_stored(const Image& rendered, const DisplaySettings& display) const;

    const Options& options_;
    StoredImage stored_;
};

}  // namespace glint
