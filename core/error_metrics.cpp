#include "core/error_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kPercentile = 0.99;

bool finite(glm::vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// What the means are made of.
struct Sums {
    double square = 0.0, relative = 0.0, absolute = 0.0, shown_square = 0.0, signed_ = 0.0;

    void add(double a, double r) {
        const double e = a - r, shown = std::clamp(a, 0.0, 1.0) - std::clamp(r, 0.0, 1.0);
        square += e * e;
        relative += e * e / (r * r + kRelativeFloor);
        absolute += std::abs(e);
        shown_square += shown * shown;
        signed_ += e;
    }
};

double mean_of_channels(glm::dvec3 a, glm::dvec3 r) { return ((a.x - r.x) + (a.y - r.y) + (a.z - r.z)) / 3.0; }

// In a second pass, since a difference of large sums would lose the scatter of a picture that is bright and biased.
double z_of_bias(const Image& image, const Image& reference, double bias, std::size_t n) {
    if (n < 2) return std::numeric_limits<double>::quiet_NaN();
    double scatter = 0.0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (!finite(image.pixels[i]) || !finite(reference.pixels[i])) continue;
        const double d = mean_of_channels(image.pixels[i], reference.pixels[i]) - bias;
        scatter += d * d;
    }
    if (bias == 0.0) return 0.0;
    const auto count = static_cast<double>(n);
    return bias / std::sqrt(scatter / (count * (count - 1.0)));
}

double percentile(std::vector<float>& values) {
    const auto rank = static_cast<std::size_t>(std::ceil(kPercentile * static_cast<double>(values.size())));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

}  // namespace

void expect_same_size(const Image& a, const Image& b) {
    if (a.width == b.width && a.height == b.height) return;
    throw ImageError(fmt::format("the pictures differ in size: {}x{} and {}x{}", a.width, a.height, b.width, b.height));
}

ErrorMetrics error_metrics(const Image& image, const Image& reference) {
    expect_same_size(image, reference);
    ErrorMetrics m;
    m.pixels = image.pixels.size();
    Sums sums;
    std::vector<float> worst;
    worst.reserve(m.pixels);
    for (std::size_t i = 0; i < m.pixels; ++i) {
        const glm::vec3 a = image.pixels[i], r = reference.pixels[i];
        // Written so that a NaN counts as a difference.
        if (!(a == r) || !finite(a)) ++m.differing;
        if (!finite(a) || !finite(r)) {
            ++m.non_finite;
            continue;
        }
        double largest = 0.0;
        for (int c = 0; c < 3; ++c) {
            const auto x = static_cast<double>(a[c]), y = static_cast<double>(r[c]);
            sums.add(x, y);
            largest = std::max(largest, std::abs(x - y));
        }
        m.max = std::max(m.max, largest);
        worst.push_back(static_cast<float>(largest));
    }
    const std::size_t n = worst.size();
    // 0/0 is the NaN that the header promises where nothing is left.
    const double values = 3.0 * static_cast<double>(n);
    m.rmse = std::sqrt(sums.square / values);
    m.relmse = sums.relative / values;
    m.mae = sums.absolute / values;
    m.psnr = 10.0 * std::log10(values / sums.shown_square);
    m.bias = sums.signed_ / values;
    m.bias_z = z_of_bias(image, reference, m.bias, n);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    m.p99 = n > 0 ? percentile(worst) : nan;
    if (n == 0) m.max = nan;
    return m;
}

Image absolute_difference(const Image& image, const Image& reference) {
    expect_same_size(image, reference);
    Image out{image.width, image.height, {}};
    out.pixels.reserve(image.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        out.pixels.push_back(glm::abs(image.pixels[i] - reference.pixels[i]));
    }
    return out;
}

}  // namespace glint
