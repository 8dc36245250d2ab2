// A chart's numbers as files: a CSV of every figure, map and table, and one JSON of all.
// Knows no drawing. Numbers are written with all their digits.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "app/chart_data.h"

namespace glint::chart {

[[nodiscard]] std::string csv_of(const Figure& figure);
[[nodiscard]] std::string csv_of(const WinnerMap& map);
[[nodiscard]] std::string csv_of(const Table& table);
[[nodiscard]] nlohmann::json json_of(const Chart& chart);

// ID.csv of everything, and chart.json. Throws ImageError where a file cannot be written.
void write_data(const Chart& chart, const std::filesystem::path& folder);

}  // namespace glint::chart
