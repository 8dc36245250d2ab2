// What the eye resolves of one channel of a picture from a given distance: its blur, and its edges and points (Andersson et
// al. 2020, sections 4.1 and 4.2). The base of FLIP. Knows no colours and no differences. Beyond its edges a picture goes on
// with its outermost pixels. Weights are made in double; sums run in float, each pixel's in the same order everywhere.
#pragma once

#include <cstddef>
#include <vector>

namespace glint {

// One channel of a picture, row-major.
struct Layer {
    int width = 0, height = 0;
    std::vector<float> values;

    Layer(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    [[nodiscard]] float* row(int y) { return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
    [[nodiscard]] const float* row(int y) const {
        return values.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    }
};

// The three channels of an opponent space that the eye tells apart with sharpness of their own.
enum class Channel { achromatic, red_green, blue_yellow };

// The channel through the eye's contrast sensitivity; its mean stays.
[[nodiscard]] Layer seen(const Layer& in, Channel channel, double pixels_per_degree);

// Strength of edges and of points in luminance (black 0, white 1), 0 on flat ground.
struct Features {
    std::vector<float> edges, points;
};
[[nodiscard]] Features features(const Layer& luminance, double pixels_per_degree);

}  // namespace glint
