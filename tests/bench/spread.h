// What rounds of a measurement come to. Knows only numbers.
#pragma once

#include <vector>

namespace glint::bench {

// The median and the quartiles.
struct Spread {
    double median = 0.0, low = 0.0, high = 0.0;
};
[[nodiscard]] Spread spread(std::vector<double> values);
// Of the quotients round by round: what slows both down in a round cancels.
[[nodiscard]] Spread ratio(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace glint::bench
