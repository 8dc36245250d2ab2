// Figures with logarithmic axes, as SVG that takes its colours from the page's style.
// Knows no measurement. Invariant: values of 0 are drawn on a line of their own below the axis, never lost.
#pragma once

#include <string>
#include <vector>

namespace glint::numeric {

struct Series {
    std::string css;  // class that says colour and dashes
    std::vector<double> x, y;
};

struct Range {
    int low, high;  // powers of ten
};

// Lines over powers of ten; points without a value (NaN) interrupt them.
[[nodiscard]] std::string line_plot(const std::string& title, Range x, Range y, int x_step, const std::vector<Series>& series);

struct Mark {
    std::string label;
    bool ours;
    double x, y, high;  // with a thin line up to `high`
};

// Labelled points.
[[nodiscard]] std::string point_plot(const std::string& title, Range x, Range y, const std::vector<Mark>& marks);

}  // namespace glint::numeric
