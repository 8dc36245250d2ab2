#include "tests/numeric/plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace glint::numeric {
namespace {

constexpr double kWidth = 340.0, kHeight = 230.0, kLeft = 46.0, kRight = 10.0, kTop = 26.0, kBottom = 40.0;

// From values to places in the figure.
class Frame {
public:
    Frame(Range x, Range y) : x_(x), y_(y) {}
    [[nodiscard]] double x(double v) const {
        const double f = (std::log10(v) - x_.low) / (x_.high - x_.low);
        return kLeft + std::clamp(f, 0.0, 1.0) * (kWidth - kLeft - kRight);
    }
    [[nodiscard]] double y(double v) const {
        if (!(v > 0.0)) return zero();
        const double f = (std::log10(v) - y_.low) / (y_.high - y_.low);
        return floor() - std::clamp(f, 0.0, 1.0) * (floor() - kTop);
    }
    // Of the lowest power, and the line of zeros below it.
    [[nodiscard]] static double floor() { return kHeight - kBottom - 18.0; }
    [[nodiscard]] static double zero() { return kHeight - kBottom; }

private:
    Range x_, y_;
};

std::string power(int exponent) {
    return exponent == 0   ? "1"
           : exponent == 1 ? "10"
                           : fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}{}</tspan>", exponent < 0 ? "&#8722;" : "",
                                         std::abs(exponent));
}

// `below`: room for more under the figure.
std::string axes(const std::string& title, const Frame& f, Range x, Range y, int x_step, double below = 0.0) {
    std::string s = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, kHeight + below, title);
    s += fmt::format("<text class=\"title\" x=\"{}\" y=\"14\">{}</text>\n", kLeft, title);
    for (int e = x.low; e <= x.high; e += x_step) {
        const double at = f.x(std::pow(10.0, e));
        s += fmt::format("<line class=\"axis\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>", at, kTop, Frame::zero());
        s += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", at, kHeight - 20.0, power(e));
    }
    const int y_step = std::max(1, (y.high - y.low + 3) / 6);
    for (int e = y.high; e >= y.low; e -= y_step) {
        const double at = f.y(std::pow(10.0, e));
        s +=
            fmt::format("<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>", kLeft, kWidth - kRight, at);
        s += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", kLeft - 6.0, at + 4.0, power(e));
    }
    return s + fmt::format(
                   "<line class=\"axis\" x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\"/><text x=\"{3}\" y=\"{4}\" "
                   "text-anchor=\"end\">0</text>\n",
                   kLeft, kWidth - kRight, Frame::zero(), kLeft - 6.0, Frame::zero() + 4.0);
}

}  // namespace

std::string line_plot(const std::string& title, Range x, Range y, int x_step, const std::vector<Series>& series) {
    const Frame f(x, y);
    std::string s = axes(title, f, x, y, x_step);
    for (const Series& line : series) {
        std::string path, dots;
        bool open = false;
        for (std::size_t i = 0; i < line.x.size(); ++i) {
            if (std::isnan(line.y[i])) {
                open = false;
                continue;
            }
            const double px = f.x(line.x[i]), py = f.y(line.y[i]);
            path += fmt::format("{}{:.1f} {:.1f}", open ? "L" : "M", px, py);
            dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.2\"/>", px, py);
            open = true;
        }
        s += fmt::format("<g class=\"{}\"><path d=\"{}\"/>{}</g>\n", line.css, path, dots);
    }
    return s + "</svg>\n";
}

std::string point_plot(const std::string& title, Range x, Range y, const std::vector<Mark>& marks) {
    const Frame f(x, y);
    std::string s = axes(title, f, x, y, 1, 15.0 * static_cast<double>(marks.size()));
    // A letter stands beside each point, and what it means below the figure.
    char letter = 'a';
    double row = kHeight + 2.0;
    for (const Mark& m : marks) {
        const double px = f.x(m.x), py = f.y(m.y);
        s += fmt::format("<g class=\"{}\"><path d=\"M{:.1f} {:.1f}V{:.1f}\"/><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>",
                         m.ours ? "ours" : "other", px, py, f.y(m.high), px, py);
        s += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", px + 6.0, py - 4.0, letter);
        s += fmt::format("<text x=\"{}\" y=\"{}\">{}&#160;&#160;{}</text></g>\n", kLeft, row, letter, m.label);
        ++letter;
        row += 15.0;
    }
    return s + "</svg>\n";
}

}  // namespace glint::numeric
