// A level of a grid's cells as the builder sees it: where a box falls, how fine to cut.
// Knows no primitives. Invariant: what is computed here and in the walk differs by float rounding, far below the padding.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>

#include "accel/grid_layout.h"
#include "accel/ray.h"

namespace glint {

struct DoubleBox {
    glm::dvec3 lo{static_cast<double>(kInfinity)}, hi{-static_cast<double>(kInfinity)};

    void grow(const DoubleBox& b) { lo = glm::min(lo, b.lo), hi = glm::max(hi, b.hi); }
    [[nodiscard]] glm::dvec3 size() const { return hi - lo; }
    // Without a branch: it is asked about every primitive of every crowded cell.
    [[nodiscard]] bool touches(const DoubleBox& b) const {
        return (static_cast<int>(lo.x <= b.hi.x) & static_cast<int>(lo.y <= b.hi.y) & static_cast<int>(lo.z <= b.hi.z) &
                static_cast<int>(b.lo.x <= hi.x) & static_cast<int>(b.lo.y <= hi.y) & static_cast<int>(b.lo.z <= hi.z)) != 0;
    }
};

struct CellRange {
    std::uint16_t first[3], last[3];
};

// A level over `box` of about `cells` cells, as cubic as whole numbers allow.
[[nodiscard]] GridLevel make_level(const DoubleBox& box, double cells);
[[nodiscard]] std::size_t cell_count(const GridLevel& level);
// Cells that a box touches; what lies outside counts to the first or last.
[[nodiscard]] inline CellRange range_of(const GridLevel& level, const DoubleBox& box) {
    CellRange r;
    for (int i = 0; i < 3; ++i) {
        // Truncation serves as floor, since what lies below counts to the first cell.
        const auto at = [&](double x) {
            const double cell = (x - static_cast<double>(level.lo[i])) * static_cast<double>(level.inverse[i]);
            return static_cast<std::uint16_t>(static_cast<int>(std::min(std::max(cell, 0.0), level.n[i] - 1.0)));
        };
        r.first[i] = at(box.lo[i]);
        r.last[i] = at(box.hi[i]);
    }
    return r;
}
[[nodiscard]] DoubleBox box_of(const GridLevel& level, glm::ivec3 cell);

}  // namespace glint
