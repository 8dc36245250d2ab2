// FLIP: how different two pictures look to somebody who flips between them on a screen, 0 (not at all) to 1.
// LDR-FLIP after Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom & Fairchild 2020 (Proc. ACM CGIT 3, 2), HDR-FLIP after
// Andersson, Nilsson, Shirley & Akenine-Moller 2021 (EGSR). A measure of what is seen, not of how right a picture is: never
// the only gate. Knows no file and no colour map. The same bits everywhere that exp and pow give the same.
#pragma once

#include <vector>

#include "core/image.h"

namespace glint {

// Pixels per degree of sight: a 0.7 m wide screen of 3840 pixels from 0.7 m away, the default of both papers.
inline constexpr double kFlipPixelsPerDegree = 0.7 * 3840.0 / 0.7 * 3.14159265358979323846 / 180.0;  // 67.02

struct Flip {
    double mean = 0.0;       // over the pixels
    std::vector<float> map;  // of each pixel, row-major, top row first
};

// Of display pictures: sRGB values 0..1 (bytes/255). What lies outside is clamped, a NaN counts as black.
// Throws ImageError when the sizes differ.
[[nodiscard]] Flip flip_of_display(const Image& image, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

// Of linear radiance: the largest LDR-FLIP over the exposures at which the reference can sensibly be shown, a stop apart at
// most, through the ACES curve of the second paper. They run from where the reference's largest luminance is displayed as
// 0.85 to where its median is; where more than half of it is black, the median of the rest; at most 64 of them. A negative
// value or NaN counts as black, infinity as brighter than all.
[[nodiscard]] Flip flip_of_radiance(const Image& image, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace glint
