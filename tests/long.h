// How large a test is: small in every run, a night's size where the environment says GLINT_LONG=1 (`tests/run --long`).
// Knows no test. Invariant: the choice is read once, so all tests of a run agree on it.
#pragma once

#include <cstdlib>
#include <string_view>

namespace glint {

inline bool is_long_run() {
    static const bool asked = [] {
        const char* value = std::getenv("GLINT_LONG");
        return value != nullptr && std::string_view(value) == "1";
    }();
    return asked;
}

template <class T>
T scale(T ci, T nightly) {
    return is_long_run() ? nightly : ci;
}

}  // namespace glint
