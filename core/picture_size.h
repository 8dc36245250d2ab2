// How large a picture a file can hold: what a header or a chunk claims beyond that is not believed, so no memory is taken for it.
// Knows of the formats that stb reads only what that takes.
#pragma once

#include <cstdint>
#include <string_view>

namespace glint {

// Deflate packs 1032 bytes into one, of eight pixels each in a PNG; a block of JPEG takes at least a bit, so 512 pixels a byte.
inline constexpr std::int64_t kMostPixelsAByte = 8 * 1032;

[[nodiscard]] constexpr bool can_hold(std::uintmax_t bytes, std::int64_t width, std::int64_t height) {
    return static_cast<std::uintmax_t>(width * height / kMostPixelsAByte) <= bytes;
}

// Whether each chunk of a PNG up to its end lies within the file, which stb makes room for before it looks; true of other files.
[[nodiscard]] constexpr bool chunks_fit(std::string_view bytes) {
    if (!bytes.starts_with("\x89PNG")) return true;
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        std::uint64_t length = 0;
        for (std::size_t k = 0; k < 4; ++k) length = length << 8 | static_cast<unsigned char>(bytes[at + k]);
        if (length > bytes.size() - at - 12) return false;
        if (bytes.substr(at + 4, 4) == "IEND") break;
        at += 12 + length;
    }
    return true;
}

}  // namespace glint
