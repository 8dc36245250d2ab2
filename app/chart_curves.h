// Error and seconds of variants of one scene's settings, over rising sample counts and many seeds.
// Knows no figure. Invariants: variants take turns, seed by seed, so that a slow moment of the machine hits all of them; each
// seed's time is one timing, so there are as many timings as seeds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/chart_bench.h"
#include "app/chart_meter.h"
#include "app/chart_reference.h"
#include "app/chart_statistics.h"

namespace glint::chart {

struct Variant {
    std::string name;
    RenderSettings settings;
    AcceleratorChoice accelerator;
    std::vector<int> spps;
    const Reference* reference;  // not null
};

// One variant at one sample count.
struct Measured {
    int spp = 0;
    double seconds = 0.0, seconds_mad = 0.0;  // rendering alone: median and median absolute deviation
    Band error;                               // relMSE, the reference's noise taken off
    double rays = 0.0;
    Band honesty;           // the renderer's own estimate of relRMSE over the true one; 0 where it makes none
    double coverage = 0.0;  // share of the pictures whose 95 % interval holds the true one
    [[nodiscard]] double total(double build) const { return build + seconds; }
};

struct Curve {
    std::string name;
    RenderSettings settings;
    double build = 0.0;  // seconds, of the accelerator
    std::vector<Measured> points;
    std::optional<BiasSplit> split;  // at the last sample count; relMSE units

    [[nodiscard]] std::vector<XY> error_over_seconds() const;
    // Exponent a of root relMSE ~ N^-a over its points.
    [[nodiscard]] std::optional<Slope> exponent() const;
};

// seeds >= 2. split: also tell bias from variance.
[[nodiscard]] std::vector<Curve> measure_curves(Bench& bench, const std::vector<Variant>& variants, int seeds, bool split,
                                                Meter& meter);
// What that will take, from one sample's time of the subject's own settings.
[[nodiscard]] double planned_seconds(Bench& bench, const std::vector<Variant>& variants, int seeds);

// 1, step, step^2 … up to `most`.
[[nodiscard]] std::vector<int> powers(int step, int most);

}  // namespace glint::chart
