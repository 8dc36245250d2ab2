// Primitives in the order of a space-filling curve (Morton 1966), and the cells of the curve that hold a few neighbours each,
// after Pantaleoni & Luebke 2010, "HLBVH". Knows no tree. Invariant: the order depends on the geometry alone, not on threads.
#pragma once

#include "accel/bvh_split.h"

namespace glint {

struct CurveKey {
    std::uint32_t code;  // the curve's cell
    PrimitiveId id;
};
using CurveKeys = std::vector<CurveKey, HugePageAllocator<CurveKey>>;

// All bounded primitives by code, equal ones by id.
[[nodiscard]] CurveKeys sort_along_curve(const Geometry& geometry, const ParallelFor& parallel_for);

// keys[first] to keys[last - 1].
struct CurveCell {
    std::uint32_t first, last;

    [[nodiscard]] std::uint32_t count() const { return last - first; }
};

// Cuts `cell` where the highest bit that differs changes, until `size` is not exceeded or all codes agree, and appends the
// pieces.
void cut_cells(std::span<const CurveKey> keys, CurveCell cell, std::size_t size, std::vector<CurveCell>& cells);

}  // namespace glint
