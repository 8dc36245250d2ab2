// A level of a grid's cells as the builder sees it: where a box falls, how fine to cut.
// Knows no primitives. Invariant: what is computed here and in the walk differs by float rounding, far below the padding.
#pragma once

#include <cstddef>

#include <glm/glm.hpp>

#include "accel/grid_layout.h"
#include "accel/ray.h"

namespace glint {

struct DoubleBox {
    glm::dvec3 lo{static_cast<double>(kInfinity)}, hi{-static_cast<double>(kInfinity)};

    void grow(const DoubleBox& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
    [[nodiscard]] glm::dvec3 size() const { return hi - lo; }
    [[nodiscard]] bool touches(const DoubleBox& b) const {
        return glm::all(glm::lessThanEqual(lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, hi));
    }
};

struct CellRange {
    glm::ivec3 first, last;
};

// A level over `box` of about `cells` cells, as cubic as whole numbers allow.
[[nodiscard]] GridLevel make_level(const DoubleBox& box, double cells);
[[nodiscard]] std::size_t cell_count(const GridLevel& level);
// Cells that a box touches; what lies outside counts to the first or last.
[[nodiscard]] CellRange range_of(const GridLevel& level, const DoubleBox& box);
[[nodiscard]] DoubleBox box_of(const GridLevel& level, glm::ivec3 cell);

}  // namespace glint
