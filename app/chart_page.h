// A chart as one HTML page: drawings inside, nothing fetched from anywhere, readable on light and dark paper.
// Knows no measurement. Every text of the chart is escaped.
#pragma once

#include <filesystem>
#include <string>

#include "app/chart_data.h"
#include "app/chart_figure.h"

namespace glint::chart {

[[nodiscard]] std::string escaped(std::string_view text);
// Draws what it shows with `plotter`; a figure that cannot be drawn stands as a link to its numbers.
[[nodiscard]] std::string page_of(const Chart& chart, Plotter& plotter);

}  // namespace glint::chart
