#include "app/option_values.h"

#include <fmt/format.h>

namespace glint {

void refuse_value(std::string_view option, std::string_view value, std::string_view wanted) {
    throw UsageError(fmt::format("{}: '{}' is not {}", option, value, wanted));
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = text.find_first_of(separators, begin);
        parts.push_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
        if (end == std::string_view::npos) return parts;
        begin = end + 1;
    }
}

glm::dvec3 vector3(std::string_view option, std::string_view text) {
    const auto parts = split(text, ",");
    if (parts.size() != 3) refuse_value(option, text, "three numbers X,Y,Z");
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = number(option, parts[static_cast<std::size_t>(i)], -1e18, 1e18, "three numbers X,Y,Z");
    return v;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known) {
    std::size_t best = std::max<std::size_t>(2, typed.size() / 3) + 1;
    std::string name;
    for (const std::string& k : known) {
        // Edit distance by Wagner & Fischer (1974), one row at a time.
        std::vector<std::size_t> row(k.size() + 1);
        for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
        for (std::size_t i = 0; i < typed.size(); ++i) {
            std::size_t diagonal = row[0];
            row[0] = i + 1;
            for (std::size_t j = 0; j < k.size(); ++j) {
                const std::size_t replace = diagonal + (typed[i] == k[j] ? 0 : 1);
                diagonal = row[j + 1];
                row[j + 1] = std::min({replace, row[j] + 1, row[j + 1] + 1});
            }
        }
        if (row.back() < best) best = row.back(), name = k;
    }
    return name.empty() ? "" : fmt::format("; did you mean '{}'?", name);
}

}  // namespace glint
