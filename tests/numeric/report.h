// What was measured as CSV, JSON and one page that holds its figures.
// Knows no measurement's method. Invariant: all three are written from the same numbers; nothing is fetched from anywhere.
#pragma once

#include <string>
#include <vector>

#include "tests/numeric/self_hits.h"
#include "tests/numeric/test_variants.h"

namespace glint::numeric {

struct Measured {
    int rays;  // of each cell
    int cases;
    std::vector<OffsetCell> offsets;
    std::vector<Variant> variants;
};

[[nodiscard]] std::string offsets_csv(const Measured& m);
[[nodiscard]] std::string variants_csv(const Measured& m);
[[nodiscard]] std::string json(const Measured& m);
[[nodiscard]] std::string page(const Measured& m);

}  // namespace glint::numeric
