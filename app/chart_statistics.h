// What measured numbers come to: medians and their bands, slopes, fronts, crossings, bias and variance.
// Pure: knows no picture, clock or file. Invariant: the same numbers give the same answer; the bootstrap has a fixed seed.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace glint::chart {

// 0 for no values.
[[nodiscard]] double median(std::vector<double> values);
// Median absolute deviation from the median.
[[nodiscard]] double median_deviation(const std::vector<double>& values);

// The median and the ends of its 95 % band.
struct Band {
    double middle = 0.0, low = 0.0, high = 0.0;
};
// Percentile bootstrap (Efron 1979) of the median.
[[nodiscard]] Band median_band(const std::vector<double>& values);

struct XY {
    double x = 0.0, y = 0.0;
};

// The slope of log y over log x by least squares, and its standard error from the residuals (0 for two points). Points that
// are not positive are left out; nothing with fewer than two different x.
struct Slope {
    double slope = 0.0, error = 0.0;
};
[[nodiscard]] std::optional<Slope> log_log_slope(const std::vector<XY>& points);

// Where a falling curve first reaches y, by straight lines between its points in log-log.
struct Crossing {
    enum class Kind { reached, before_first, after_last };  // the latter two: x is that of the first or last point
    Kind kind = Kind::after_last;
    double x = 0.0;
};
[[nodiscard]] Crossing first_below(const std::vector<XY>& curve, double y);

// Indices of the points that no other beats: none has both a smaller-or-equal x and a smaller-or-equal y (one of them smaller;
// of equal points the first counts). By rising x.
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<XY>& points);
// The y of a curve at x by straight lines in log-log, the last of which goes on, but not below `least`; infinity left of its
// first point.
[[nodiscard]] double value_at(const std::vector<XY>& curve, double x, double least = 0.0);

// Bias and noise of a method from K pictures of different seeds, given per value (pixel and channel): its sum and sum of squares
// over the pictures, the reference, the squared standard error of the reference, and what squares are divided by.
class BiasSplit {
public:
    explicit BiasSplit(std::size_t pictures) : pictures_(static_cast<double>(pictures)) {}
    void add(double sum, double sum_of_squares, double reference, double reference_variance, double scale);
    // Between seeds, of one picture. At least two pictures.
    [[nodiscard]] double variance() const { return n_ > 0.0 ? variance_ / n_ : 0.0; }
    // Squared bias, noise of both means taken off: it scatters around its value and may come out below 0.
    [[nodiscard]] double bias2() const { return n_ > 0.0 ? bias2_ / n_ : 0.0; }
    // What of bias2() chance alone would leave: two standard deviations of it were there no bias. Values are taken as
    // independent, which neighbours' channels are not: they are counted by threes.
    [[nodiscard]] double bias2_noise() const;

private:
    double pictures_, n_ = 0.0, variance_ = 0.0, bias2_ = 0.0, chance_ = 0.0;
};

}  // namespace glint::chart
