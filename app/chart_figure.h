// Figures drawn by gnuplot: as SVG text for the page, as PNG files beside it.
// Knows how gnuplot is talked to and nothing of what is measured. No shell runs, file names are ours, and whatever the user
// named stands between quotes that it cannot leave.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "app/chart_data.h"

namespace glint::chart {

// Readable on light and on dark paper; in turn for series. The page uses them, too.
inline constexpr std::array<std::string_view, 10> kPalette{"#3f7fd6", "#d9742f", "#2e9d78", "#a964c9", "#c9a227",
                                                           "#d2527f", "#5b9aa0", "#8a8f98", "#7f9a3a", "#b5654a"};

class Plotter {
public:
    // Drawings go to `folder` as ID.png.
    explicit Plotter(std::filesystem::path folder) : folder_(std::move(folder)) {}
    // False after the first drawing if there is no gnuplot.
    [[nodiscard]] bool works() const { return works_; }
    // The drawing as an <svg> element; nothing when it could not be made.
    [[nodiscard]] std::optional<std::string> draw(const Figure& figure);
    [[nodiscard]] std::optional<std::string> draw(const WinnerMap& map);

private:
    [[nodiscard]] std::optional<std::string> run(const std::string& id, const std::string& script);

    std::filesystem::path folder_;
    bool works_ = true;
};

// What gnuplot is told, but for terminal and output; for tests.
[[nodiscard]] std::string plot_script(const Figure& figure);
[[nodiscard]] std::string plot_script(const WinnerMap& map);

// A number as the page and the drawings write it: few digits, and powers of ten raised.
[[nodiscard]] std::string short_number(double x);

}  // namespace glint::chart
