// The values that options take, read and checked: numbers in a range, lists, names of a choice.
// Knows no option. Errors: UsageError, one line that names the option, the value and what was wanted.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

// The user's words make no sense (exit 2).
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse_value(std::string_view option, std::string_view value, std::string_view wanted);

// The whole of `text` as a number in [least, most].
template <class T>
[[nodiscard]] T number(std::string_view option, std::string_view text, T least, T most, std::string_view wanted) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    // Written so that a NaN is refused.
    if (error != std::errc() || stop != end || !(value >= least && value <= most)) refuse_value(option, text, wanted);
    return value;
}

// The parts between any of the separators, empty ones included.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text, std::string_view separators);
// X,Y,Z, each at most 1e18.
[[nodiscard]] glm::dvec3 vector3(std::string_view option, std::string_view text);

// The word of `known` closest to `typed`, as "; did you mean 'x'?", or nothing when none is near.
[[nodiscard]] std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known);

// The position of `text` among `names`.
template <std::size_t N>
[[nodiscard]] std::size_t choice(std::string_view option, std::string_view text, const std::array<std::string_view, N>& names) {
    const auto found = std::find(names.begin(), names.end(), text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    throw UsageError(std::string(option) + ": unknown value '" + std::string(text) + "'" +
                     did_you_mean(text, std::vector<std::string>(names.begin(), names.end())));
}

}  // namespace glint
