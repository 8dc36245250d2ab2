// Damage to files, for tests of readers: bits flipped, bytes set, runs cut out, doubled or brought from a second file, ends cut
// off, and numbers in text replaced by others that are hard to bear.
// Knows no format. Invariant: the damage is a function of the bytes and of the state of `random`.
#pragma once

#include <array>
#include <cctype>
#include <random>
#include <string>
#include <string_view>

namespace glint::test {

inline constexpr std::array<std::string_view, 24> kHardNumbers{
    "0",          "-0",      "-1",     "1",     "2",    "255", "65536", "2147483647", "-2147483648",
    "4294967295", "1e-45",   "1e-320", "1e-20", "1e-7", "3e7", "1e18",  "1.5e19",     "9223372036854775807",
    "3.4e38",     "-3.4e38", "1e39",   "1e308", "nan",  "inf"};

// Replaces the number at or after `at`, if there is one.
inline void replace_number(std::string& bytes, std::size_t at, std::string_view by) {
    const auto is_part = [](char c) {
        return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '+';
    };
    while (at < bytes.size() && !is_part(bytes[at])) ++at;
    std::size_t end = at;
    while (end < bytes.size() && (is_part(bytes[end]) || bytes[end] == 'e')) ++end;
    bytes.replace(at, end - at, by);
}

// One to four changes; runs may come from `other`.
inline std::string damaged(std::string bytes, const std::string& other, std::mt19937& random) {
    const auto below = [&random](std::size_t n) { return n == 0 ? std::size_t{0} : static_cast<std::size_t>(random() % n); };
    for (std::size_t change = 1 + below(4); change > 0 && !bytes.empty(); --change) {
        const std::size_t at = below(bytes.size()), run = 1 + below(below(4) == 0 ? bytes.size() : 16);
        switch (below(8)) {
            case 0: bytes[at] = static_cast<char>(random()); break;
            case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
            case 2: bytes.erase(at, run); break;
            case 3: bytes.insert(at, bytes.substr(below(bytes.size()), run)); break;
            case 4: bytes.insert(at, other.substr(below(other.size()), run)); break;
            case 5: bytes.resize(below(4) == 0 ? at : bytes.size()); break;
            default: replace_number(bytes, at, kHardNumbers[below(kHardNumbers.size())]); break;
        }
    }
    return bytes;
}

}  // namespace glint::test
