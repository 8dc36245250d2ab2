// OpenEXR pictures in memory: 32-bit floats, linear, to the bit. Written: scan lines, ZIP, channels R G B, the chromaticities
// of sRGB stated. Read: what the OpenEXR library reads (half, float or integer channels, every compression, tiles), of which
// R, G and B, or Y alone as grey; data and display window as the data window says. Knows no file.
// Damaged data ends in an ImageError; nothing is allocated for a size that is refused.
#pragma once

#include <string>

#include "core/image.h"

namespace glint {

[[nodiscard]] bool is_exr(const std::string& bytes);
// Throws ImageError, its line beginning with `name`.
[[nodiscard]] Image decode_exr(const std::string& bytes, const std::string& name);
[[nodiscard]] std::string encode_exr(const Image& image);

}  // namespace glint
