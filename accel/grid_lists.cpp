#include "accel/grid_lists.h"

#include <algorithm>

namespace glint {

void CellLists::make(const GridLevel& level, int z0, int z1, std::span<const BlockRange> ranges) {
    const std::size_t cells = static_cast<std::size_t>(z1 - z0) * level.n[0] * level.n[1];
    offsets_.assign(cells + 1, 0);
    last_.assign(cells, ~0u);
    std::size_t count = 0;
    for (const BlockRange& r : ranges) {
        const CellRange& c = r.cells;
        const int z_first = std::max<int>(c.first[2], z0), z_last = std::min<int>(c.last[2], z1 - 1);
        if (z_last < z_first) continue;
        const std::size_t across = c.last[0] - c.first[0] + 1u;
        const std::size_t most = count + across * (c.last[1] - c.first[1] + 1u) * static_cast<std::size_t>(z_last - z_first + 1);
        if (pairs_.size() < most) pairs_.resize(most + most / 2);
        for (int z = z_first; z <= z_last; ++z) {
            for (int y = c.first[1]; y <= c.last[1]; ++y) {
                const std::size_t row =
                    (static_cast<std::size_t>(z - z0) * level.n[1] + static_cast<std::size_t>(y)) * level.n[0];
                for (std::size_t cell = row + c.first[0]; cell < row + c.first[0] + across; ++cell) {
                    // Written in any case and kept if new: a branch would be guessed wrong half the time.
                    const unsigned is_new = last_[cell] != r.block ? 1u : 0u;
                    last_[cell] = r.block;
                    offsets_[cell + 1] += is_new;
                    pairs_[count] = {static_cast<std::uint32_t>(cell), r.block};
                    count += is_new;
                }
            }
        }
    }
    for (std::size_t c = 0; c < cells; ++c) offsets_[c + 1] += offsets_[c];
    blocks_.resize(count);
    std::copy(offsets_.begin(), offsets_.end() - 1, last_.begin());
    for (std::size_t i = 0; i < count; ++i) blocks_[last_[pairs_[i].cell]++] = pairs_[i].block;
}

}  // namespace glint
