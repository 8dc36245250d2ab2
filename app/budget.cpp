#include "app/budget.h"

#include <algorithm>
#include <new>
#include <utility>

namespace glint {
namespace {

constexpr double kBeat = 0.25;  // seconds

std::size_t pixels_of(const Frame& f) {
    const bool whole = f.x1 == 0 && f.y1 == 0;
    return static_cast<std::size_t>(whole ? f.width : f.x1 - f.x0) * static_cast<std::size_t>(whole ? f.height : f.y1 - f.y0);
}

// False when the frame was not finished in time.
bool finish(const Renderer& renderer, const Budget& budget, const std::atomic<bool>& stop, const BudgetWatch& watch) {
    for (Progress p = renderer.progress();; p = renderer.progress()) {
        if (p.out_of_memory) throw std::bad_alloc();
        if (p.finished && !stop) return true;
        if (p.seconds >= budget.seconds || stop) return false;
        if (watch.at_beat) watch.at_beat(p);
        renderer.wait(std::min(budget.seconds, p.seconds + kBeat), &stop);
    }
}

}  // namespace

std::string_view render_within(Renderer& renderer, Frame frame, const Budget& budget, const std::atomic<bool>& stop,
                               const BudgetWatch& watch) {
    const std::size_t pixels = pixels_of(frame);
    frame.spp = budget.spp;
    if (budget.noise > 0.0) frame.spp = std::min(frame.spp, least_samples(pixels));
    if (budget.every_doubling) frame.spp = 1;
    int spp = frame.spp;
    const std::uint64_t generation = renderer.restart(std::move(frame));
    while (finish(renderer, budget, stop, watch)) {
        const ErrorEstimate error = renderer.error();
        if (watch.at_step) watch.at_step(renderer.progress(), error);
        if (budget.noise > 0.0 && error_reached(error, pixels, budget.noise)) return "noise";
        if (error.kind == ErrorEstimate::Kind::exact || spp >= budget.spp) return "spp";
        spp = spp > budget.spp / 2 ? budget.spp : 2 * spp;
        renderer.extend(generation, spp);
    }
    return stop ? "signal" : "time";
}

}  // namespace glint
