// Sine and cosine of a part of a full turn, by plain arithmetic: the same bits from every library and in vector loops.
// Knows no use. Invariant: within 2^-52 of the true values for u in [0, 1], which needs no reduction by pi.
#pragma once

#include <numbers>

namespace glint {

struct Turn {
    double sin, cos;
};

// Of 2 pi u. The nearest quarter is taken off exactly, so that the series (Taylor's) are asked for an eighth of a turn at most,
// where the first term left out is below 2^-54 of the sum.
[[gnu::always_inline]] inline Turn turn(double u) {
    // Adding and taking off 1.5 * 2^52 rounds to an integer, the nearest and ties to even.
    constexpr double kRound = 0x1.8p52;
    const double quarter = (4.0 * u + kRound) - kRound;
    const double x = (std::numbers::pi / 2.0) * (4.0 * u - quarter), x2 = x * x;
    double s = -1.0 / 1307674368000.0;
    s = s * x2 + 1.0 / 6227020800.0;
    s = s * x2 - 1.0 / 39916800.0;
    s = s * x2 + 1.0 / 362880.0;
    s = s * x2 - 1.0 / 5040.0;
    s = s * x2 + 1.0 / 120.0;
    s = s * x2 - 1.0 / 6.0;
    s = s * x2 * x + x;
    double c = 1.0 / 20922789888000.0;
    c = c * x2 - 1.0 / 87178291200.0;
    c = c * x2 + 1.0 / 479001600.0;
    c = c * x2 - 1.0 / 3628800.0;
    c = c * x2 + 1.0 / 40320.0;
    c = c * x2 - 1.0 / 720.0;
    c = c * x2 + 1.0 / 24.0;
    c = c * x2 - 0.5;
    c = c * x2 + 1.0;
    // Quarters 0 to 4: (s, c), (c, -s), (-s, -c), (-c, s), (s, c).
    const bool odd = (quarter == 1.0) | (quarter == 3.0);
    const double a = odd ? c : s, b = odd ? s : c;
    return {(quarter == 2.0) | (quarter == 3.0) ? -a : a, (quarter == 1.0) | (quarter == 2.0) ? -b : b};
}

}  // namespace glint
