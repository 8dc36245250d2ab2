#include "app/picture_format.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "app/option_values.h"
#include "core/exr.h"
#include "core/rgbe.h"

namespace glint {

PictureFormat format_of(const std::string& output) {
    if (output == "-") return PictureFormat::png;
    constexpr std::array<std::string_view, 4> kEndings{".png", ".pfm", ".hdr", ".exr"};
    std::string ending = output.size() > 4 ? output.substr(output.size() - 4) : output;
    std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
    const auto found = std::find(kEndings.begin(), kEndings.end(), ending);
    if (found == kEndings.end()) throw UsageError(fmt::format("-o {}: the ending must be .png, .pfm, .hdr or .exr", output));
    return static_cast<PictureFormat>(found - kEndings.begin());
}

std::string encode(const Image& image, PictureFormat format, const DisplaySettings& display) {
    switch (format) {
        case PictureFormat::png: return encode_png(to_display(image, display), display.transfer);
        case PictureFormat::pfm: return encode_pfm(image);
        case PictureFormat::hdr: return encode_rgbe(image);
        case PictureFormat::exr: return encode_exr(image);
    }
    return {};
}

}  // namespace glint
