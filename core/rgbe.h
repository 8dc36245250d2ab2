// Radiance pictures (.hdr) in memory: three mantissas of 8 bits under one exponent, after Ward 1991 ("Real Pixels", Graphics
// Gems II) and the manual of Radiance. A value is m * 2^(e - 136), as most programs read it (Radiance itself adds half a step).
// Written: run-length coded, each channel rounded to the nearest step, which is at most 1/256 of the pixel's largest channel.
// What the format lacks: negative values and NaN become 0, what is above 255 * 2^119 becomes that. Knows no file.
#pragma once

#include <string>

#include "core/image.h"

namespace glint {

[[nodiscard]] bool is_rgbe(const std::string& bytes);
// Rows from the top down and from the left (-Y +X), run-length coded or flat; EXPOSURE is undone. Refused with an ImageError,
// its line beginning with `name`: anything damaged, XYZE, other orders of rows, the run code from before 1991.
[[nodiscard]] Image decode_rgbe(const std::string& bytes, const std::string& name);
[[nodiscard]] std::string encode_rgbe(const Image& image);

}  // namespace glint
