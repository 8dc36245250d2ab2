// The table of `render --convergence`: a row per doubling of the samples, as comma-separated values.
// Knows no budget: whoever renders says when the picture has all the samples asked for.
#pragma once

#include <string>

#include "app/compare.h"
#include "core/renderer.h"

namespace glint {

class ConvergenceTable {
public:
    // Both may be used until write(); reference may be null. Does nothing where the options ask for no table.
    ConvergenceTable(const Options& options, const Reference* reference, const DisplaySettings& display);

    void add(const Progress& progress, const ErrorEstimate& estimate, const Renderer& renderer);
    // Throws ImageError when the file cannot be written.
    void write() const;

private:
    const Options& options_;
    const Reference* reference_;
    const DisplaySettings& display_;
    std::string rows_;
};

}  // namespace glint
