#include "app/convergence.h"

#include <fmt/format.h>

namespace glint {

ConvergenceTable::ConvergenceTable(const Options& options, const Reference* reference, const DisplaySettings& display)
    : options_(options), reference_(reference), display_(display), rows_("spp,seconds,rays,estimate,low,high,slope,relrmse\n") {}

void ConvergenceTable::add(const Progress& p, const ErrorEstimate& e, const Renderer& renderer) {
    if (options_.convergence.empty()) return;
    rows_ += fmt::format("{},{:.6f},{},", p.spp, p.seconds, p.rays.total());
    const bool known = e.kind != ErrorEstimate::Kind::unknown;
    rows_ += known ? fmt::format("{:.6g},{:.6g},{:.6g},", e.relrmse, e.low, e.high) : ",,,";
    rows_ += e.kind == ErrorEstimate::Kind::estimated ? fmt::format("{:.4g},", e.slope) : ",";
    Image image;
    if (reference_ != nullptr && renderer.resolve(image)) rows_ += fmt::format("{:.6g}", reference_->relrmse(image, display_));
    rows_ += '\n';
}

void ConvergenceTable::write() const {
    if (!options_.convergence.empty()) write_file_atomically(options_.convergence, rows_);
}

}  // namespace glint
