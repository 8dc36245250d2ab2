// Cells over blocks: counts, lists, and levels within crowded cells.
// Knows bounds and blocks, no primitive. Invariant: the result depends on its input alone, never on threads.
#pragma once

#include <vector>

#include "accel/grid_blocks.h"
#include "accel/grid_layout.h"

namespace glint {

// How fine the cells are.
struct GridDensity {
    double outer = 0.125;     // cells a primitive in the outermost level
    double inner = 0.5;       // the same in levels within a cell
    std::size_t crowded = 4;  // blocks from which on a cell may get a level of its own
};

struct GridCells {
    std::vector<GridLevel> levels;
    std::vector<GridCell> cells;
    std::vector<BvhRef> lists;
    std::size_t references = 0;  // blocks in cells, over all levels
};

// padding: how much primitives are grown. `primitives` in the order of the blocks.
[[nodiscard]] GridCells build_grid_cells(const GridBlocks& blocks, const std::vector<BoundedPrimitive>& primitives,
                                         double padding, const GridDensity& density, const ParallelFor& parallel_for);

}  // namespace glint
