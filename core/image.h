// Pictures: linear float images, the only transfer to display bytes, PNG, JPEG and PFM files (rgbe.h and exr.h hold the rest).
// Rows run from the top down. Knows nothing of how a picture came to be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/settings.h"

namespace glint {

// The largest picture that is read back: as for rendering.
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 28;

struct Image {
    int width = 0, height = 0;
    std::vector<glm::vec3> pixels;  // linear radiance, row-major, top row first

    [[nodiscard]] glm::vec3& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    [[nodiscard]] glm::vec3 at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

// Display bytes, three a pixel, top row first.
struct Image8 {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

// The one path from radiance to bytes: exposure, then clamp, then transfer (linear, or sRGB by IEC 61966-2-1),
// then byte = min(255, floor(255.99 x)). A NaN becomes magenta, so that it is seen.
[[nodiscard]] Image8 to_display(const Image& image, const DisplaySettings& display);

// A file could not be written or read; the message is one line that starts with the path.
class ImageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// PNG with an sRGB chunk where the transfer is sRGB (a gAMA chunk of 1.0 where it is linear). Bytes of the file.
[[nodiscard]] std::string encode_png(const Image8& image, Transfer transfer);
// PFM, little endian, linear radiance (Debevec's format: rows from the bottom up). Bytes of the file.
[[nodiscard]] std::string encode_pfm(const Image& image);
// Written under a temporary name beside `path`, then renamed: there is never half a file. Throws ImageError.
void write_file_atomically(const std::filesystem::path& path, const std::string& bytes);

struct StoredImage {
    Image image;
    bool radiance = false;  // linear radiance (PFM, HDR, EXR); otherwise bytes/255 as a display gets them (PNG, JPEG)
};
// PNG or JPEG bytes as stored (no transfer undone), PFM, Radiance HDR or OpenEXR; chosen by content. Throws ImageError. A small
// file that claims to be a large picture is refused before memory is taken for it.
[[nodiscard]] StoredImage read_stored_image(const std::filesystem::path& path);
[[nodiscard]] Image read_image(const std::filesystem::path& path);

struct ImageDifference {
    double rmse = 0.0;          // over pixels and channels
    double max = 0.0;           // largest absolute difference of a channel
    std::size_t differing = 0;  // pixels with any difference
    std::size_t pixels = 0;
};
// Throws ImageError when the sizes differ.
[[nodiscard]] ImageDifference difference(const Image& a, const Image& b);

}  // namespace glint
