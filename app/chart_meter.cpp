#include "app/chart_meter.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

namespace glint::chart {
namespace {

std::string minutes(double seconds) {
    const int s = static_cast<int>(std::clamp(seconds, 0.0, 1e7) + 0.5);
    return fmt::format("{}:{:02}", s / 60, s % 60);
}

}  // namespace

Meter::Meter(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

double Meter::elapsed() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

void Meter::say(const std::string& what) {
    what_ = what;
    show();
}

void Meter::did(double seconds) {
    done_ += seconds;
    if (elapsed() >= next_) show();
}

void Meter::show() {
    if (quiet_) return;
    // Estimates err alike, so the rest is scaled by how the work done so far compares with its estimate.
    const double pace = done_ > 1.0 ? elapsed() / done_ : 1.0;
    const std::string left = planned_ > 0.0 ? fmt::format(", about {} left", minutes((planned_ - done_) * pace)) : "";
    std::fputs(
        fmt::format("{}{} {}{}{}", terminal_ ? "\r" : "", minutes(elapsed()), what_, left, terminal_ ? "\033[K" : "\n").c_str(),
        stderr);
    next_ = elapsed() + (terminal_ ? 0.5 : 5.0);
}

void Meter::end() const {
    if (terminal_ && !quiet_) std::fputs("\n", stderr);
}

}  // namespace glint::chart
