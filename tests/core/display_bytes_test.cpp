// Bytes looked up are the rule's own: around every place where the byte changes, and along all of 0..1.
#include "core/display_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace glint {
namespace {

class DisplayBytesOf : public testing::TestWithParam<Transfer> {};

void expect_rule(std::uint32_t bits, Transfer transfer) {
    const auto x = std::bit_cast<float>(bits);
    ASSERT_EQ(DisplayBytes::of(transfer).byte_of(x), display_byte_by_rule(x, transfer)) << x;
}

TEST_P(DisplayBytesOf, AreTheRulesAroundEveryStep) {
    std::uint32_t before = 0;
    for (unsigned byte = 1; byte < 256; ++byte) {
        std::uint32_t at = std::bit_cast<std::uint32_t>(1.0f);
        while (at - before > 1) {
            const std::uint32_t middle = before + (at - before) / 2;
            (display_byte_by_rule(std::bit_cast<float>(middle), GetParam()) < byte ? before : at) = middle;
        }
        for (std::uint32_t bits = at - std::min(at, 500u); bits < at + 500; ++bits) expect_rule(bits, GetParam());
    }
}

TEST_P(DisplayBytesOf, AreTheRulesFromEndToEnd) {
    // 7,919 is prime: the floats that are left out differ from one octave to the next.
    for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(1.0f); bits += 7919) expect_rule(bits, GetParam());
}

TEST_P(DisplayBytesOf, HoldOutsideOfWhatCanBeShown) {
    const float infinity = std::numeric_limits<float>::infinity();
    for (const float x : {0.0f, -0.0f, -1.0f, -infinity, 1e-45f, 1.0f, std::nextafter(1.0f, 0.0f), 2.0f, infinity}) {
        EXPECT_EQ(DisplayBytes::of(GetParam()).byte_of(x), display_byte_by_rule(x, GetParam())) << x;
    }
}

INSTANTIATE_TEST_SUITE_P(Transfers, DisplayBytesOf, testing::Values(Transfer::linear, Transfer::srgb));

}  // namespace
}  // namespace glint
