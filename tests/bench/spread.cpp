#include "spread.h"

#include <algorithm>

namespace glint::bench {

Spread spread(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double part) {
        const double position = part * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::size_t>(position);
        const std::size_t above = std::min(below + 1, values.size() - 1);
        return values[below] + (position - static_cast<double>(below)) * (values[above] - values[below]);
    };
    return {at(0.5), at(0.25), at(0.75)};
}

Spread ratio(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> quotients;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) quotients.push_back(a[i] / b[i]);
    return spread(std::move(quotients));
}

}  // namespace glint::bench
