#include "core/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error_metrics.h"
#include "core/eye_filters.h"

namespace glint {
namespace {

// Linear sRGB to XYZ by IEC 61966-2-1's primaries and white, at full precision, and back.
constexpr std::array<glm::vec3, 3> kXyzOfRgb{
    {{0.41238656f, 0.35759149f, 0.18045049f}, {0.21263682f, 0.71518298f, 0.07218020f}, {0.01933062f, 0.11919716f, 0.95037259f}}};
constexpr std::array<glm::vec3, 3> kRgbOfXyz{{{3.24100323f, -1.53739897f, -0.49861588f},
                                              {-0.96922425f, 1.87592998f, 0.04155423f},
                                              {0.05563942f, -0.20401121f, 1.05714898f}}};

glm::vec3 times(const std::array<glm::vec3, 3>& m, glm::vec3 v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

// XYZ relative to white, so that white is (1, 1, 1).
glm::vec3 relative_xyz(glm::vec3 linear) { return times(kXyzOfRgb, linear) / times(kXyzOfRgb, glm::vec3(1.0f)); }

// The opponent space in which the eye's contrast sensitivity is given (2020, section 4.1), without the factors of YCxCz, which
// no linear filter sees: luminance (white 1), red against green, blue against yellow.
struct Opponent {
    Layer y, red_green, blue_yellow;
};

Opponent opponent(const Image& linear) {
    const Layer empty(linear.width, linear.height);
    Opponent o{empty, empty, empty};
    for (std::size_t i = 0; i < linear.pixels.size(); ++i) {
        const glm::vec3 w = relative_xyz(linear.pixels[i]);
        o.y.values[i] = w.y;
        o.red_green.values[i] = w.x - w.y;
        o.blue_yellow.values[i] = w.y - w.z;
    }
    return o;
}

// CIELAB under the white of sRGB, its chroma scaled by lightness after Hunt (2020, section 4.1).
glm::vec3 hunt_lab(glm::vec3 linear) {
    const auto f = [](float t) {
        constexpr float kDelta = 6.0f / 29.0f;
        return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
    };
    const glm::vec3 w = relative_xyz(linear);
    const float x = f(w.x), y = f(w.y), z = f(w.z), lightness = 116.0f * y - 16.0f;
    return {lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z)};
}

// What the eye makes of the colours from where it is.
std::vector<glm::vec3> seen_colors(const Opponent& o, double pixels_per_degree) {
    const Layer y = seen(o.y, Channel::achromatic, pixels_per_degree);
    const Layer red_green = seen(o.red_green, Channel::red_green, pixels_per_degree);
    const Layer blue_yellow = seen(o.blue_yellow, Channel::blue_yellow, pixels_per_degree);
    const glm::vec3 white = times(kXyzOfRgb, glm::vec3(1.0f));
    std::vector<glm::vec3> colors;
    colors.reserve(y.values.size());
    for (std::size_t i = 0; i < y.values.size(); ++i) {
        const glm::vec3 w{y.values[i] + red_green.values[i], y.values[i], y.values[i] - blue_yellow.values[i]};
        colors.push_back(hunt_lab(glm::clamp(times(kRgbOfXyz, w * white), 0.0f, 1.0f)));
    }
    return colors;
}

// HyAB, which suits large differences: city block in lightness, Euclid in chroma; and its power (2020, section 4.1).
float color_distance(glm::vec3 a, glm::vec3 b) {
    constexpr float kExponent = 0.7f;
    const float da = a.y - b.y, db = a.z - b.z;
    return std::pow(std::abs(a.x - b.x) + std::sqrt(da * da + db * db), kExponent);
}

// To 0..1: the lower 40 % of what is possible (green to blue) take 95 % of the range.
float compressed(float distance, float largest) {
    constexpr float kSplit = 0.4f, kTarget = 0.95f;
    const float split = kSplit * largest;
    if (distance < split) return distance * (kTarget / split);
    return kTarget + (distance - split) / (largest - split) * (1.0f - kTarget);
}

// LDR-FLIP of linear values 0..1.
std::vector<float> flip_of_linear(const Image& image, const Image& reference, double pixels_per_degree) {
    const Opponent a = opponent(image), r = opponent(reference);
    const std::vector<glm::vec3> colors_a = seen_colors(a, pixels_per_degree), colors_r = seen_colors(r, pixels_per_degree);
    const Features features_a = features(a.y, pixels_per_degree), features_r = features(r.y, pixels_per_degree);
    const float largest = color_distance(hunt_lab({0.0f, 1.0f, 0.0f}), hunt_lab({0.0f, 0.0f, 1.0f}));
    std::vector<float> map(image.pixels.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
        const float color = compressed(color_distance(colors_a[i], colors_r[i]), largest);
        const float edge = std::abs(features_a.edges[i] - features_r.edges[i]);
        const float point = std::abs(features_a.points[i] - features_r.points[i]);
        const float feature = std::sqrt(std::max(edge, point) / std::numbers::sqrt2_v<float>);
        map[i] = std::pow(color, 1.0f - feature);
    }
    return map;
}

template <class Rule>
Image each_channel(const Image& image, Rule rule) {
    Image out{image.width, image.height, {}};
    out.pixels.reserve(image.pixels.size());
    for (const glm::vec3 p : image.pixels) out.pixels.emplace_back(rule(p.x), rule(p.y), rule(p.z));
    return out;
}

float linear_of_srgb(float s) {
    // A NaN fails the comparison and becomes black.
    const float x = s > 0.0f ? std::min(s, 1.0f) : 0.0f;
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

double mean(const std::vector<float>& map) {
    double sum = 0.0;
    for (const float f : map) sum += static_cast<double>(f);
    return map.empty() ? 0.0 : sum / static_cast<double>(map.size());
}

// Coefficients of Narkowicz' curve with its exposure of 0.6 taken in: (a x^2 + b x) / (c x^2 + d x + e) (2021, section 4).
constexpr double kA = 0.36 * 2.51, kB = 0.6 * 0.03, kC = 0.36 * 2.43, kD = 0.6 * 0.59, kE = 0.14;

float tone_mapped(float x, float exposure) {
    const double v = x > 0.0f ? std::min(static_cast<double>(x) * static_cast<double>(exposure), 1e18) : 0.0;
    return static_cast<float>(std::clamp((kA * v * v + kB * v) / (kC * v * v + kD * v + kE), 0.0, 1.0));
}

// The exposures in stops at which the reference is looked at: first, last and how many.
struct Exposures {
    double first = 0.0, last = 0.0;
    int count = 1;
};

Exposures exposures(const Image& reference) {
    std::vector<double> luminance;
    luminance.reserve(reference.pixels.size());
    std::size_t black = 0;
    for (const glm::vec3 p : reference.pixels) {
        const double y =
            0.2126 * static_cast<double>(p.x) + 0.7152 * static_cast<double>(p.y) + 0.0722 * static_cast<double>(p.z);
        if (!std::isfinite(y)) continue;
        luminance.push_back(std::max(y, 0.0));
        black += luminance.back() == 0.0 ? 1 : 0;
    }
    if (black == luminance.size()) return {};
    std::sort(luminance.begin(), luminance.end());
    const auto median_from = [&](std::size_t from) {
        const std::size_t n = luminance.size() - from;
        return 0.5 * (luminance[from + (n - 1) / 2] + luminance[from + n / 2]);
    };
    double median = median_from(0);
    if (median == 0.0) median = median_from(black);
    // Where the curve reaches 0.85: the positive root of (a - t c) x^2 + (b - t d) x - t e.
    constexpr double kTarget = 0.85;
    const double a = kA - kTarget * kC, b = kB - kTarget * kD, c = -kTarget * kE;
    const double bright = (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
    Exposures e{std::log2(bright / luminance.back()), std::log2(bright / median), 2};
    constexpr double kMost = 64.0;
    e.count = static_cast<int>(std::clamp(std::ceil(e.last - e.first), 2.0, kMost));
    return e;
}

}  // namespace

Flip flip_of_display(const Image& image, const Image& reference, double pixels_per_degree) {
    expect_same_size(image, reference);
    Flip flip;
    flip.map = flip_of_linear(each_channel(image, linear_of_srgb), each_channel(reference, linear_of_srgb), pixels_per_degree);
    flip.mean = mean(flip.map);
    return flip;
}

Flip flip_of_radiance(const Image& image, const Image& reference, double pixels_per_degree) {
    expect_same_size(image, reference);
    const Exposures e = exposures(reference);
    Flip flip;
    flip.map.resize(image.pixels.size());
    for (int k = 0; k < e.count; ++k) {
        const double stops = e.count > 1 ? e.first + (e.last - e.first) * k / (e.count - 1) : e.first;
        const auto exposure = static_cast<float>(std::exp2(stops));
        const auto shown = [exposure](float x) { return tone_mapped(x, exposure); };
        const std::vector<float> map =
            flip_of_linear(each_channel(image, shown), each_channel(reference, shown), pixels_per_degree);
        for (std::size_t i = 0; i < map.size(); ++i) flip.map[i] = std::max(flip.map[i], map[i]);
    }
    flip.mean = mean(flip.map);
    return flip;
}

}  // namespace glint
