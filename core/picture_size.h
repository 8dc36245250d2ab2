// How large a picture a file can hold: what a header claims beyond that is not believed, so no memory is taken for it.
// Knows no format but the densest.
#pragma once

#include <cstdint>

namespace glint {

// Deflate packs 1032 bytes into one, of eight pixels each in a PNG; a block of JPEG takes at least a bit, so 512 pixels a byte.
inline constexpr std::int64_t kMostPixelsAByte = 8 * 1032;

[[nodiscard]] constexpr bool can_hold(std::uintmax_t bytes, std::int64_t width, std::int64_t height) {
    return static_cast<std::uintmax_t>(width * height / kMostPixelsAByte) <= bytes;
}

}  // namespace glint
