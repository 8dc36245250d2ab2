// Which blocks the cells of one level list, from the cells that each primitive touches.
// Knows no geometry and no levels within levels. Invariants: a cell names a block once; the blocks of a cell stand in the order
// in which they came.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "accel/grid_level.h"

namespace glint {

// The cells of a level that one primitive of a block touches. All of a block's come in a row.
struct BlockRange {
    CellRange cells;
    std::uint32_t block;
};

// The lists of planes z0..z1-1 of a level, in the order of cells, x fastest.
class CellLists {
public:
    void make(const GridLevel& level, int z0, int z1, std::span<const BlockRange> ranges);

    [[nodiscard]] std::size_t cell_count() const { return offsets_.size() - 1; }
    [[nodiscard]] std::size_t reference_count() const { return blocks_.size(); }
    // References in the cells before this one.
    [[nodiscard]] std::size_t references_before(std::size_t cell) const { return offsets_[cell]; }
    [[nodiscard]] std::span<const std::uint32_t> of(std::size_t cell) const {
        return std::span(blocks_).subspan(offsets_[cell], offsets_[cell + 1] - offsets_[cell]);
    }

private:
    struct Pair {
        std::uint32_t cell, block;
    };
    std::vector<std::uint32_t> offsets_, blocks_, last_;  // last_: the latest block of a cell
    std::vector<Pair> pairs_;
};

}  // namespace glint
