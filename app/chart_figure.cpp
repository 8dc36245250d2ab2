// What gnuplot is told.
#include "app/chart_figure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace glint::chart {
namespace {

// Text between single quotes, where gnuplot knows no escapes but the doubled quote.
std::string gnuplot_text(std::string_view text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += "''";
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += ' ';
        else
            out += c;
    }
    return out + "'";
}

std::string_view colour(int i) { return kPalette[static_cast<std::size_t>(i) % kPalette.size()]; }

// Whole decades, or the data with a little room.
struct Range {
    double lo = 0.1, hi = 10.0;
    bool logarithmic = true;

    [[nodiscard]] double part(double v) const {
        return logarithmic ? std::log(v / lo) / std::log(hi / lo) : (v - lo) / (hi - lo);
    }
    [[nodiscard]] bool shows(double v) const { return std::isfinite(v) && (!logarithmic || v > 0.0); }
};

Range range_of(const std::vector<double>& values, bool logarithmic) {
    Range r;
    r.logarithmic = logarithmic;
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double v : values) {
        if (r.shows(v)) lo = std::min(lo, v), hi = std::max(hi, v);
    }
    if (!(lo <= hi)) return r;
    if (!logarithmic) {
        r.lo = std::min(0.0, lo);
        r.hi = hi > r.lo ? hi * 1.05 : r.lo + 1.0;
        return r;
    }
    // Thirds of a decade keep small multiples full.
    r.lo = std::pow(10.0, std::floor(3.0 * std::log10(lo) - 0.2) / 3.0);
    r.hi = std::pow(10.0, std::ceil(3.0 * std::log10(hi) + 0.2) / 3.0);
    return r;
}

std::string axis(char name, const Axis& a, const Range& r, bool powers_of_two) {
    std::string s = fmt::format("set {}range [{:.9g}:{:.9g}]\n", name, r.lo, r.hi);
    const char* offset = name == 'y' ? " offset 1,0" : " offset 0,0.3";
    s += fmt::format("set {}label {} textcolor rgb '#010203'{}\n", name, gnuplot_text(a.label), offset);
    if (!a.places.empty()) {
        std::string names;
        std::ptrdiff_t longest = 0;  // characters, which take about 0.0145 of the width each
        for (std::size_t i = 0; i < a.places.size(); ++i) {
            longest = std::max(longest, std::ranges::count_if(a.places[i], [](char c) { return (c & 0xc0) != 0x80; }));
            names += fmt::format("{}{} {}", i > 0 ? ", " : "", gnuplot_text(a.places[i]), i + 1);
        }
        return s + fmt::format(
                       "set {}range [{:.9g}:{:.9g}]\nset {}tics nomirror textcolor rgb '#010203' ({})\nset lmargin at "
                       "screen {:.4g}\n",
                       name, static_cast<double>(a.places.size()) + 0.6, 0.4, name, names,
                       std::max(0.125, 0.0145 * static_cast<double>(longest) + 0.01));
    }
    if (!a.logarithmic) return s + fmt::format("set {}tics nomirror textcolor rgb '#010203'\n", name);
    s += fmt::format("set logscale {}\n", name);
    std::string tics;
    const auto add = [&](double at, const std::string& label) {
        tics += fmt::format("{}{} {:.9g}", tics.empty() ? "" : ", ", gnuplot_text(label), at);
    };
    const double decades = std::log10(r.hi / r.lo);
    if (powers_of_two) {
        const int skip = decades > 4.0 ? 4 : decades > 1.6 ? 2 : 1;
        for (int k = 0; k < 40; k += skip) {
            if (const double v = std::ldexp(1.0, k); v >= r.lo && v <= r.hi) add(v, fmt::format("{}", v));
        }
    } else {
        const int every = decades > 8.0 ? 2 : 1;
        for (int k = static_cast<int>(std::ceil(std::log10(r.lo) - 1e-9)); k <= std::log10(r.hi) + 1e-9; ++k) {
            if (k % every == 0) add(std::pow(10.0, k), short_number(std::pow(10.0, k)));
            if (decades < 1.4) add(3.0 * std::pow(10.0, k), short_number(3.0 * std::pow(10.0, k)));
        }
    }
    return s + fmt::format("set {}tics nomirror textcolor rgb '#010203' ({})\n", name, tics);
}

constexpr std::string_view kCommon =
    "set encoding utf8\nset border 3 linecolor rgb '#010203' lw 0.6\nset grid xtics ytics lt 1 lw 0.5 linecolor rgb '#040506'\n"
    "set tics scale 0.5\nunset key\nset rmargin at screen 0.7\nset lmargin at screen 0.125\nset tmargin at screen 0.93\n"
    "set bmargin at screen 0.16\n";

// Names stand at the right, in the order of the curves' ends, pushed apart where they would touch.
std::string labels(const Figure& f, const Range& x, const Range& y) {
    struct Label {
        double at;
        std::size_t series;
    };
    std::vector<Label> list;
    for (std::size_t i = 0; i < f.series.size(); ++i) {
        double at = 0.5, right = -std::numeric_limits<double>::infinity();
        for (const Point& p : f.series[i].points) {
            if (!x.shows(p.x) || !y.shows(p.y) || p.x < right) continue;
            right = p.x;
            at = y.part(p.y);
        }
        // Where the axis holds names, an end's height means nothing: labels stand from the top in their order.
        if (!f.y.places.empty()) at = 0.97 - 0.08 * static_cast<double>(i);
        if (!f.series[i].name.empty()) list.push_back({std::clamp(at, 0.0, 1.0), i});
    }
    std::ranges::stable_sort(list, {}, &Label::at);
    const double gap = std::min(0.066, 1.0 / static_cast<double>(std::max<std::size_t>(1, list.size())));
    for (std::size_t i = 1; i < list.size(); ++i) list[i].at = std::max(list[i].at, list[i - 1].at + gap);
    double ceiling = 1.0;
    for (std::size_t i = list.size(); i-- > 0; ceiling -= gap) {
        list[i].at = std::min(list[i].at, ceiling);
        ceiling = list[i].at;
    }
    std::string s;
    for (const Label& l : list) {
        const Series& series = f.series[l.series];
        const std::string text = series.note.empty() ? series.name : fmt::format("{}  {}", series.name, series.note);
        s += fmt::format("set label {} at graph 1.03, graph {:.4f} left textcolor rgb '{}'\n", gnuplot_text(text), l.at,
                         colour(series.colour));
    }
    return s;
}

std::string data_block(std::size_t i, const Series& series, const Range& x, const Range& y) {
    std::string s = fmt::format("$d{} << EOD\n", i);
    double before = 0.0;
    bool first = true;
    for (const Point& p : series.points) {
        if (!x.shows(p.x) || !y.shows(p.y)) continue;
        if (series.look == Series::Look::front && !first)
            s += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", p.x, before, before, before);
        const bool band = y.shows(p.low) && y.shows(p.high);
        s += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", p.x, p.y, band ? p.low : p.y, band ? p.high : p.y);
        before = p.y;
        first = false;
    }
    return s + "EOD\n";
}

bool empty(const Series& series, const Range& x, const Range& y) {
    return std::ranges::none_of(series.points, [&](const Point& p) { return x.shows(p.x) && y.shows(p.y); });
}

}  // namespace

std::string short_number(double x) {
    if (!std::isfinite(x)) return x > 0.0 ? "∞" : "–";
    if (x == 0.0) return "0";
    const double size = std::abs(x);
    if (size >= 0.0995 && size < 9950.0) return fmt::format("{:.{}g}", x, size >= 100.0 ? 4 : size >= 1.0 ? 3 : 2);
    int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    std::string digits = fmt::format("{:.2g}", x / std::pow(10.0, exponent));
    if (digits == "10") digits = "1", ++exponent;
    static constexpr std::array<std::string_view, 10> raised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string power = exponent < 0 ? "⁻" : "";
    for (const char c : std::to_string(std::abs(exponent))) power += raised[static_cast<std::size_t>(c - '0')];
    return digits == "1" ? fmt::format("10{}", power) : fmt::format("{}·10{}", digits, power);
}

std::string plot_script(const Figure& f) {
    std::vector<double> xs, ys = f.levels;
    for (const Series& s : f.series) {
        for (const Point& p : s.points) xs.push_back(p.x), ys.push_back(p.y), ys.push_back(p.high);
    }
    const Range x = range_of(xs, f.x.logarithmic), y = range_of(ys, f.y.logarithmic);
    std::string script(kCommon);
    const bool counts = f.x.label.find("sample") != std::string::npos || f.x.label.find("thread") != std::string::npos;
    script += axis('x', f.x, x, counts) + axis('y', f.y, y, false);
    for (const double level : f.levels) {
        script += fmt::format(
            "set arrow from graph 0, first {0:.9g} to graph 1, first {0:.9g} nohead dt 3 lw 1 lc rgb '#070809'\n", level);
    }
    script += labels(f, x, y);
    std::string bands, lines;
    for (std::size_t i = 0; i < f.series.size(); ++i) {
        const Series& s = f.series[i];
        if (empty(s, x, y)) continue;
        script += data_block(i, s, x, y);
        if (s.look == Series::Look::curve && s.points.size() > 1) {
            bands +=
                fmt::format("{}$d{} using 1:3:4 with filledcurves fillcolor rgb '{}' fillstyle transparent solid 0.16 noborder",
                            bands.empty() ? "" : ", ", i, colour(s.colour));
        }
        const char* with = s.look == Series::Look::front  ? "lines dt 1 lw 1.2"
                           : s.look == Series::Look::dots ? "points pt 7 ps 0.42"
                                                          : "linespoints pt 7 ps 0.34 lw 1.7";
        lines += fmt::format("{}$d{} using 1:2 with {} lc rgb '{}'", lines.empty() ? "" : ", ", i, with, colour(s.colour));
    }
    if (lines.empty()) return script + "plot NaN\n";
    return script + "plot " + bands + (bands.empty() ? "" : ", ") + lines + "\n";
}

std::string plot_script(const WinnerMap& m) {
    const auto half = [](const std::vector<double>& v) { return v.size() > 1 ? std::sqrt(v[1] / v[0]) : 2.0; };
    const double dx = half(m.xs), dy = half(m.ys);
    const Range x{m.xs.front() / dx, m.xs.back() * dx, true}, y{m.ys.front() / dy, m.ys.back() * dy, true};
    std::string script(kCommon), plots;
    script += axis('x', m.x, x, false) + axis('y', m.y, y, false);
    for (std::size_t c = 0; c < m.candidates.size(); ++c) {
        script += fmt::format("set label {} at graph 1.035, graph {:.3f} left textcolor rgb '{}'\n",
                              gnuplot_text(m.candidates[c]), 0.9 - 0.08 * static_cast<double>(c), colour(static_cast<int>(c)));
        std::string block;
        for (std::size_t j = 0; j < m.ys.size(); ++j) {
            for (std::size_t i = 0; i < m.xs.size(); ++i) {
                if (m.winner[j * m.xs.size() + i] != c) continue;
                block += fmt::format("{0:.9g} {1:.9g} {2:.9g} {3:.9g} {4:.9g} {5:.9g}\n", m.xs[i], m.ys[j], m.xs[i] / dx,
                                     m.xs[i] * dx, m.ys[j] / dy, m.ys[j] * dy);
            }
        }
        if (block.empty()) continue;
        script += fmt::format("$d{} << EOD\n{}EOD\n", c, block);
        plots +=
            fmt::format("{}$d{} using 1:2:3:4:5:6 with boxxyerror fillcolor rgb '{}' fillstyle transparent solid 0.75 noborder",
                        plots.empty() ? "" : ", ", c, colour(static_cast<int>(c)));
    }
    return script + "unset grid\nplot " + (plots.empty() ? "NaN" : plots) + "\n";
}

}  // namespace glint::chart
