#include "app/chart_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace glint::chart {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014).
std::uint64_t next(std::uint64_t& state) {
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// Linear between order statistics; `sorted` is not empty.
double quantile(const std::vector<double>& sorted, double q) {
    const double at = q * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

}  // namespace

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    return quantile(values, 0.5);
}

double median_deviation(const std::vector<double>& values) {
    const double middle = median(values);
    std::vector<double> away;
    away.reserve(values.size());
    for (const double v : values) away.push_back(std::abs(v - middle));
    return median(std::move(away));
}

Band median_band(const std::vector<double>& values) {
    constexpr int kResamples = 1000;
    if (values.empty()) return {};
    std::uint64_t state = 1;
    std::vector<double> medians, drawn(values.size());
    medians.reserve(kResamples);
    for (int i = 0; i < kResamples; ++i) {
        for (double& d : drawn) d = values[next(state) % values.size()];
        medians.push_back(median(drawn));
    }
    std::ranges::sort(medians);
    return {median(values), quantile(medians, 0.025), quantile(medians, 0.975)};
}

std::optional<Slope> log_log_slope(const std::vector<XY>& points) {
    std::vector<XY> logs;
    XY mean;
    for (const XY& p : points) {
        if (!(p.x > 0.0) || !(p.y > 0.0) || !std::isfinite(p.x) || !std::isfinite(p.y)) continue;
        logs.push_back({std::log(p.x), std::log(p.y)});
        mean.x += logs.back().x;
        mean.y += logs.back().y;
    }
    const auto n = static_cast<double>(logs.size());
    mean = {mean.x / n, mean.y / n};
    double xx = 0.0, xy = 0.0, residual = 0.0;
    for (const XY& p : logs) {
        xx += (p.x - mean.x) * (p.x - mean.x);
        xy += (p.x - mean.x) * (p.y - mean.y);
    }
    if (logs.size() < 2 || !(xx > 0.0)) return std::nullopt;
    const double slope = xy / xx;
    for (const XY& p : logs) {
        const double off = p.y - mean.y - slope * (p.x - mean.x);
        residual += off * off;
    }
    return Slope{slope, logs.size() > 2 ? std::sqrt(residual / (n - 2.0) / xx) : 0.0};
}

Crossing first_below(const std::vector<XY>& curve, double y) {
    if (curve.empty()) return {};
    if (curve.front().y <= y) return {Crossing::Kind::before_first, curve.front().x};
    for (std::size_t i = 1; i < curve.size(); ++i) {
        const XY &a = curve[i - 1], &b = curve[i];
        if (b.y > y) continue;
        // A value at or below 0 (the reference's noise was taken off) has no logarithm: the point itself then.
        if (!(b.y > 0.0)) return {Crossing::Kind::reached, b.x};
        const double part = std::log(a.y / y) / std::log(a.y / b.y);
        return {Crossing::Kind::reached, a.x * std::pow(b.x / a.x, part)};
    }
    return {Crossing::Kind::after_last, curve.back().x};
}

std::vector<std::size_t> pareto_front(const std::vector<XY>& points) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return points[a].x < points[b].x || (points[a].x == points[b].x && points[a].y < points[b].y);
    });
    std::vector<std::size_t> front;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order) {
        if (!(points[i].y < least)) continue;
        least = points[i].y;
        front.push_back(i);
    }
    return front;
}

double value_at(const std::vector<XY>& curve, double x, double least) {
    if (curve.empty() || x < curve.front().x) return std::numeric_limits<double>::infinity();
    if (curve.size() == 1) return curve.front().y;
    std::size_t i = 1;
    while (i + 1 < curve.size() && x > curve[i].x) ++i;
    const XY &a = curve[i - 1], &b = curve[i];
    if (!(a.y > 0.0) || !(b.y > 0.0) || !(b.x > a.x)) return std::min(a.y, b.y);
    const double y = a.y * std::pow(b.y / a.y, std::log(x / a.x) / std::log(b.x / a.x));
    return x > b.x ? std::clamp(y, std::min(least, b.y), b.y) : y;
}

void BiasSplit::add(double sum, double sum_of_squares, double reference, double reference_variance, double scale) {
    const double mean = sum / pictures_;
    const double variance = std::max(0.0, sum_of_squares / pictures_ - mean * mean) * pictures_ / (pictures_ - 1.0);
    const double noise = variance / pictures_ + reference_variance;
    const double off = mean - reference;
    variance_ += variance / scale;
    bias2_ += (off * off - noise) / scale;
    // The square of a centred normal of variance v has variance 2 v^2.
    chance_ += 2.0 * noise * noise / (scale * scale);
    n_ += 1.0;
}

double BiasSplit::bias2_noise() const { return n_ > 0.0 ? 2.0 * std::sqrt(3.0 * chance_) / n_ : 0.0; }

}  // namespace glint::chart
