// Parts of a turn beside the library's sine and cosine in long double.
#include "core/turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace glint {
namespace {

TEST(Turn, IsWithinTwoToTheMinus52OfTheTruth) {
    long double worst = 0.0L;
    for (int i = 0; i <= 1 << 16; ++i) {
        const double u = i == 1 << 16 ? 1.0 : (i + 0.37 * (i % 3)) * 0x1p-16;
        const long double angle = 2.0L * std::numbers::pi_v<long double> * static_cast<long double>(u);
        const Turn t = turn(u);
        worst = std::max(worst, std::abs(static_cast<long double>(t.sin) - std::sin(angle)));
        worst = std::max(worst, std::abs(static_cast<long double>(t.cos) - std::cos(angle)));
    }
    EXPECT_LE(worst, 0x1p-52L);
}

TEST(Turn, IsExactAtQuarters) {
    const double sines[] = {0, 1, 0, -1, 0}, cosines[] = {1, 0, -1, 0, 1};
    for (int i = 0; i <= 4; ++i) {
        EXPECT_EQ(turn(i / 4.0).sin, sines[i]);
        EXPECT_EQ(turn(i / 4.0).cos, cosines[i]);
    }
}

}  // namespace
}  // namespace glint
