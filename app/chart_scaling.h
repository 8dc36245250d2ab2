// Experiments that are about the machine more than about a scene: threads, the break-even of accelerators, the paper's table.
// Knows how to measure and nothing of files.
#pragma once

#include <atomic>

#include "app/chart_bench.h"
#include "app/chart_data.h"
#include "app/chart_meter.h"

namespace glint::chart {

struct Machine {
    int threads;
    bool quick;
    const std::atomic<bool>& stop;
};

// Rays per second over 1, 2, 4 … all threads.
void chart_threads(const Machine& machine, const Subject& subject, Section& section, Meter& meter);
// Break-even over primitives and rays, and the table of the paper that started glint.
void chart_machine(const Machine& machine, Section& section, Meter& meter);
[[nodiscard]] double planned_scaling_seconds(const Machine& machine);

}  // namespace glint::chart
