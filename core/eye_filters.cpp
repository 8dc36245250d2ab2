#include "core/eye_filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace glint {
namespace {

// Weights of an odd number of neighbours.
using Kernel = std::vector<float>;

Layer filtered(const Layer& in, const Kernel& along_rows, const Kernel& along_columns) {
    const int width = in.width, height = in.height;
    Layer half(width, height), out(width, height);
    const auto reach = static_cast<std::ptrdiff_t>(along_rows.size() / 2);
    std::vector<float> padded(static_cast<std::size_t>(width) + along_rows.size() - 1);
    for (int y = 0; y < height; ++y) {
        const float* source = in.row(y);
        std::fill(padded.begin(), padded.begin() + reach, source[0]);
        std::copy(source, source + width, padded.begin() + reach);
        std::fill(padded.end() - reach, padded.end(), source[width - 1]);
        float* sum = half.row(y);
        for (std::size_t k = 0; k < along_rows.size(); ++k) {
            const float weight = along_rows[k];
            const float* neighbour = padded.data() + k;
            for (int x = 0; x < width; ++x) sum[x] += weight * neighbour[x];
        }
    }
    const int tall = static_cast<int>(along_columns.size() / 2);
    for (int y = 0; y < height; ++y) {
        float* sum = out.row(y);
        for (int k = -tall; k <= tall; ++k) {
            const float weight = along_columns[static_cast<std::size_t>(k + tall)];
            const float* source = half.row(std::clamp(y + k, 0, height - 1));
            for (int x = 0; x < width; ++x) sum[x] += weight * source[x];
        }
    }
    return out;
}

Kernel kernel(const std::vector<double>& weights, double scale = 1.0) {
    Kernel narrow;
    for (const double w : weights) narrow.push_back(static_cast<float>(w * scale));
    return narrow;
}

// Contrast sensitivity of a channel: a sum of amplitude * sqrt(pi/b) * exp(-pi^2 x^2 / b), x in degrees (2020, table 1).
struct Gaussian {
    double amplitude, b;
};
constexpr Gaussian kAchromatic[] = {{1.0, 0.0047}};
constexpr Gaussian kRedGreen[] = {{1.0, 0.0053}};
constexpr Gaussian kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kWidestB = 0.04;  // decides the reach of all three

std::span<const Gaussian> sensitivity(Channel channel) {
    switch (channel) {
        case Channel::achromatic: return kAchromatic;
        case Channel::red_green: return kRedGreen;
        case Channel::blue_yellow: return kBlueYellow;
    }
    return kAchromatic;
}

void scale_signs_to_one(std::vector<double>& weights) {
    double positive = 0.0, negative = 0.0;
    for (const double w : weights) (w > 0.0 ? positive : negative) += w;
    for (double& w : weights) w /= w > 0.0 ? positive : -negative;
}

}  // namespace

Layer seen(const Layer& in, Channel channel, double pixels_per_degree) {
    constexpr double kPi = std::numbers::pi;
    const std::span<const Gaussian> sum_of = sensitivity(channel);
    const int reach = static_cast<int>(std::ceil(3.0 * std::sqrt(kWidestB / (2.0 * kPi * kPi)) * pixels_per_degree));
    std::vector<std::vector<double>> weights(sum_of.size());
    std::vector<double> scale;
    double total = 0.0;
    for (std::size_t i = 0; i < sum_of.size(); ++i) {
        double sum = 0.0;
        for (int k = -reach; k <= reach; ++k) {
            const double x = k / pixels_per_degree;
            weights[i].push_back(std::exp(-kPi * kPi * x * x / sum_of[i].b));
            sum += weights[i].back();
        }
        scale.push_back(sum_of[i].amplitude * std::sqrt(kPi / sum_of[i].b));
        total += scale[i] * sum * sum;
    }
    Layer out(in.width, in.height);
    for (std::size_t i = 0; i < sum_of.size(); ++i) {
        // A Gaussian of x and y is a product of two; each gets the root of its share.
        const Kernel narrow = kernel(weights[i], std::sqrt(scale[i] / total));
        const Layer part = filtered(in, narrow, narrow);
        for (std::size_t p = 0; p < out.values.size(); ++p) out.values[p] += part.values[p];
    }
    return out;
}

// First and second derivatives of a Gaussian as wide as the eye resolves; each sign's weights sum to one.
Features features(const Layer& luminance, double pixels_per_degree) {
    constexpr double kWidth = 0.082;  // degrees
    const double deviation = 0.5 * kWidth * pixels_per_degree;
    const int reach = static_cast<int>(std::ceil(3.0 * deviation));
    std::vector<double> gauss, first, second;
    for (int k = -reach; k <= reach; ++k) {
        const double g = std::exp(-k * k / (2.0 * deviation * deviation));
        gauss.push_back(g);
        first.push_back(-k * g);
        second.push_back((k * k / (deviation * deviation) - 1.0) * g);
    }
    for (std::vector<double>* weights : {&gauss, &first, &second}) scale_signs_to_one(*weights);
    const Kernel smooth = kernel(gauss);
    const auto strength = [&](const Kernel& derivative) {
        const Layer across = filtered(luminance, derivative, smooth), down = filtered(luminance, smooth, derivative);
        std::vector<float> out(across.values.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = std::sqrt(across.values[i] * across.values[i] + down.values[i] * down.values[i]);
        }
        return out;
    };
    return {strength(kernel(first)), strength(kernel(second))};
}

}  // namespace glint
