// The experiments on one scene: what is compared with what, and the figures that come of it.
// Knows how to measure a curve and nothing of files. Each figure's caption says in two sentences what was found.
#pragma once

#include <string>
#include <vector>

#include "app/chart_bench.h"
#include "app/chart_curves.h"
#include "app/chart_data.h"
#include "app/chart_meter.h"
#include "app/chart_reference.h"

namespace glint::chart {

// How much is measured.
struct Effort {
    int seeds = 12;
    int step = 2;            // sample counts are its powers
    int settings_most = 64;  // samples where approximations are compared
    int timings = 5;
};

// Of each sampler's curves a reference by the other family judges, so that no error of a family hides in its own reference.
struct References {
    Reference jittered;  // judges sobol and joint
    Reference sobol;     // judges jittered, random and regular
    Reference deep;      // jittered, to twice the depth: judges approximations
};

struct Stage {
    Bench& bench;
    const References& references;
    const Effort& effort;
    Meter& meter;

    [[nodiscard]] const Subject& subject() const { return bench.subject(); }
};

// Every sampler: error over seconds and over samples; a row of `targets` for each, and what the renderer itself says of its
// error.
[[nodiscard]] std::vector<Figure> chart_samplers(const Stage& stage, Table& targets, std::vector<Figure>& error_bars);
// No accelerator, grid and bvh: the same bytes, other seconds.
[[nodiscard]] std::vector<Figure> chart_accelerators(const Stage& stage);
// From Whitted's rays on, a feature more with each curve.
[[nodiscard]] std::vector<Figure> chart_features(const Stage& stage);
// What each approximation buys and costs: bias and noise apart, and the front of all settings and sample counts.
[[nodiscard]] std::vector<Figure> chart_settings(const Stage& stage, Table& settings);

// For progress: what the first three take together, and the fourth, in seconds.
[[nodiscard]] double planned_seconds(Bench& bench, const Effort& effort);
[[nodiscard]] double planned_settings_seconds(Bench& bench, const Effort& effort);

// Seconds with a unit that suits them.
[[nodiscard]] std::string seconds_text(double seconds);
// Error over seconds (build included) of curves, with samples, seconds and builds as further columns.
[[nodiscard]] Figure error_figure(const Stage& stage, const std::string& what, const std::vector<Curve>& curves,
                                  bool over_samples);

}  // namespace glint::chart
