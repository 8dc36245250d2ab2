#include "core/display_bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

float srgb_encode(float x) { return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f; }

}  // namespace

std::uint8_t display_byte_by_rule(float x, Transfer transfer) {
    x = std::clamp(x, 0.0f, 1.0f);
    if (transfer == Transfer::srgb) x = srgb_encode(x);
    // In double: 255.99f * x would round some products up to the next byte.
    return static_cast<std::uint8_t>(std::min(255.0, std::floor(255.99 * static_cast<double>(x))));
}

const DisplayBytes& DisplayBytes::of(Transfer transfer) {
    static const DisplayBytes linear(Transfer::linear), srgb(Transfer::srgb);
    return transfer == Transfer::linear ? linear : srgb;
}

DisplayBytes::DisplayBytes(Transfer transfer) {
    first_[0] = 0.0f;
    first_[256] = std::numeric_limits<float>::infinity();
    for (unsigned byte = 1; byte < 256; ++byte) {
        // Positive floats are ordered as their bits are.
        std::uint32_t below = std::bit_cast<std::uint32_t>(first_[byte - 1]), at = std::bit_cast<std::uint32_t>(1.0f);
        while (at - below > 1) {
            const std::uint32_t middle = below + (at - below) / 2;
            (display_byte_by_rule(std::bit_cast<float>(middle), transfer) < byte ? below : at) = middle;
        }
        first_[byte] = std::bit_cast<float>(at);
    }
    for (std::uint32_t i = 0; i < start_.size(); ++i) {
        start_[i] = display_byte_by_rule(std::bit_cast<float>(i << kDropped), transfer);
    }
}

}  // namespace glint
