// From a display value to its byte by looking it up: the rule of to_display() costs a power and a rounding a channel,
// more than the tracing of a coarse preview (34 ms against 8 to 19 ms at 1280x720).
// Knows no image. Invariant: byte_of() gives the rule's own byte for every float; the rule never falls, so the first float of
// each byte says all.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/scene.h"

namespace glint {

// byte = min(255, floor(255.99 x)) of the value after the transfer (linear, or sRGB by IEC 61966-2-1), clamped to 0..1.
[[nodiscard]] std::uint8_t display_byte_by_rule(float x, Transfer transfer);

class DisplayBytes {
public:
    // Made at first use; for all threads.
    [[nodiscard]] static const DisplayBytes& of(Transfer transfer);

    [[nodiscard]] std::uint8_t byte_of(float x) const {
        // A NaN (infinite light at no exposure) is as bright as can be, by the rule too.
        if (!(x < 1.0f)) return 255;
        if (!(x > 0.0f)) return 0;
        unsigned byte = start_[std::bit_cast<std::uint32_t>(x) >> kDropped];
        while (x >= first_[byte + 1]) ++byte;
        return static_cast<std::uint8_t>(byte);
    }

private:
    explicit DisplayBytes(Transfer transfer);

    // Floats that share their sign, exponent and 7 bits more: a few bytes at most lie within.
    static constexpr unsigned kDropped = 16;
    std::array<float, 257> first_;  // of each byte; above all of them at the end
    std::array<std::uint8_t, (std::bit_cast<std::uint32_t>(1.0f) >> kDropped) + 1> start_;
};

}  // namespace glint
