// How far a picture lies from a reference, in the usual measures (FLIP apart: flip.h).
// Works on the numbers as they are: linear radiance, or bytes/255 of a display picture; knows no file, exposure or transfer.
// Means run over pixels and channels, summed in double in the order of the pixels, so that they are the same everywhere.
// A pixel with a NaN or infinity on either side is left out of every mean, percentile and maximum, and counted.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "core/image.h"

namespace glint {

// What a comparison can be judged by.
enum class Metric { rmse, relmse, mae, psnr, flip };
inline constexpr std::array<std::string_view, 5> kMetricNames{"rmse", "relmse", "mae", "psnr", "flip"};

// What relative errors add to the square of the truth, so that dark pixels do not outweigh all others.
inline constexpr double kRelativeFloor = 0.01;

// With a = picture, r = reference. The real-valued ones are NaN where no pixel is finite.
struct ErrorMetrics {
    double rmse = 0.0;    // sqrt(mean (a-r)^2)
    double relmse = 0.0;  // mean (a-r)^2 / (r^2 + kRelativeFloor), the denominator squared: Rousselle, Knaus & Zwicker 2011
    double mae = 0.0;     // mean |a-r|
    double psnr = 0.0;    // dB: 10 log10(1 / mean (a-r)^2) with both clamped to 0..1, so its peak is display white, 1;
                          // infinite where nothing that a display shows differs
    double bias = 0.0;    // mean (a-r), signed
    // bias over its standard error, which is taken from the scatter of a-r from pixel to pixel (channels averaged first, since
    // they share their samples). Assumes that the errors of pixels are independent: true for noise, where |z| > 3 tells a bias;
    // structured errors (edges, rows) make it too large or too small. Infinite without scatter; NaN for less than two pixels.
    double bias_z = 0.0;
    double p99 = 0.0;            // 99 % of the pixels differ by no more than this, in their worst channel (nearest rank)
    double max = 0.0;            // the worst channel of the worst pixel
    std::size_t non_finite = 0;  // pixels with a NaN or infinity in either picture
    std::size_t differing = 0;   // pixels with any difference; a NaN or infinity always counts as one
    std::size_t pixels = 0;
};

// Throws ImageError when the sizes differ.
[[nodiscard]] ErrorMetrics error_metrics(const Image& image, const Image& reference);

// |a-r| of each channel. Throws ImageError when the sizes differ.
[[nodiscard]] Image absolute_difference(const Image& image, const Image& reference);

// Throws ImageError, with both sizes in its line, when the sizes differ.
void expect_same_size(const Image& a, const Image& b);

}  // namespace glint
