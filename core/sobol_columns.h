// Generator matrices of the Sobol' dimensions after the first two, as columns with their bits reversed: what a bit of the index
// adds. From primitive polynomials and first direction numbers of Joe & Kuo 2008 ("Constructing Sobol' sequences with better
// two-dimensional projections", table new-joe-kuo-6). Knows no random number.
#pragma once

#include <array>
#include <cstdint>

namespace glint {

struct SobolColumns {
    std::array<std::uint32_t, 32> first, second;
};

// Dimension by degree and inner coefficients of its polynomial and its first direction numbers.
constexpr std::array<std::uint32_t, 32> sobol_columns(unsigned degree, std::uint32_t coefficients,
                                                      std::array<std::uint32_t, 5> m) {
    std::array<std::uint32_t, 32> v{};
    for (unsigned k = 0; k < 32; ++k) {
        if (k < degree) {
            v[k] = m[k] << (31 - k);
            continue;
        }
        v[k] = v[k - degree] ^ (v[k - degree] >> degree);
        for (unsigned j = 1; j < degree; ++j) v[k] ^= (coefficients >> (degree - 1 - j) & 1u) * v[k - j];
    }
    std::array<std::uint32_t, 32> reversed{};
    for (unsigned k = 0; k < 32; ++k) {
        for (unsigned bit = 0; bit < 32; ++bit) reversed[k] |= (v[k] >> bit & 1u) << (31 - bit);
    }
    return reversed;
}

// The light takes the third and fourth dimension, the lens the fifth and the tenth: of the first thirteen the one whose products
// with the others err least (at 16 points the sixth errs more than random points do, beside the first).
constexpr SobolColumns kSobolLight{sobol_columns(2, 1, {1, 3}), sobol_columns(3, 1, {1, 3, 1})};
constexpr SobolColumns kSobolLens{sobol_columns(3, 2, {1, 1, 1}), sobol_columns(5, 7, {1, 1, 7, 11, 19})};

}  // namespace glint
