// Parts of a grid that were built apart, and how they are put behind each other.
// Knows no primitives. Invariant: parts joined in the order of their cells are the part that one builder would have made, so
// nothing shows how the work was shared out.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "accel/grid_layout.h"
#include "accel/parallel.h"

namespace glint {

// Levels, cells and lists under construction; indices count from the part's own start.
struct GridPart {
    std::vector<GridLevel> levels;
    std::vector<GridCell> cells;
    std::vector<BvhRef> lists;
    std::size_t references = 0;

    // Where another part begins that is put behind this one.
    struct End {
        std::size_t level, cell, list;
    };
    [[nodiscard]] End end() const { return {levels.size(), cells.size(), lists.size()}; }
};

inline GridCell shifted(GridCell cell, const GridPart::End& by) {
    if ((cell & kListBit) == 0) return cell;
    return cell + static_cast<GridCell>((cell & kLevelBit) != 0 ? by.level : by.list);
}

// Copies a part to where `into` has room for it, and shifts the cells that refer to it.
inline void place(const GridPart& part, const GridPart::End& at, GridPart& into, std::span<GridCell> referring) {
    for (GridCell& cell : referring) cell = shifted(cell, at);
    for (std::size_t c = 0; c < part.cells.size(); ++c) into.cells[at.cell + c] = shifted(part.cells[c], at);
    for (std::size_t l = 0; l < part.levels.size(); ++l) {
        into.levels[at.level + l] = part.levels[l];
        into.levels[at.level + l].first += static_cast<std::uint32_t>(at.cell);
    }
    std::copy(part.lists.begin(), part.lists.end(), into.lists.begin() + static_cast<std::ptrdiff_t>(at.list));
}

// Appends parts in their order; referring(i) are the cells, already in `into`, that were written for part i.
template <class Referring>
void append(std::vector<GridPart>& parts, GridPart& into, const ParallelFor& parallel_for, const Referring& referring) {
    std::vector<GridPart::End> starts;
    GridPart::End next = into.end();
    for (const GridPart& p : parts) {
        starts.push_back(next);
        next = {next.level + p.levels.size(), next.cell + p.cells.size(), next.list + p.lists.size()};
        into.references += p.references;
    }
    into.levels.resize(next.level);
    into.cells.resize(next.cell);
    into.lists.resize(next.list);
    parallel_for(parts.size(), [&](std::size_t i) {
        place(parts[i], starts[i], into, referring(i));
        parts[i] = GridPart{};
    });
}

}  // namespace glint
