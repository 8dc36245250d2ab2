// Which kind of file a name asks for, and its bytes. Knows no option but the one that it names when it refuses.
#pragma once

#include <string>

#include "core/image.h"

namespace glint {

enum class PictureFormat { png, pfm, hdr, exr };

// By the ending of `-o NAME`; "-" is PNG. UsageError for another ending.
[[nodiscard]] PictureFormat format_of(const std::string& output);
// PNG as the display shows it; the others hold linear radiance and never see exposure or transfer.
[[nodiscard]] std::string encode(const Image& image, PictureFormat format, const DisplaySettings& display);

}  // namespace glint
