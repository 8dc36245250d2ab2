#include "accel/grid_build.h"

#include <algorithm>
#include <array>

#include "accel/grid_lists.h"
#include "accel/grid_parts.h"

namespace glint {
namespace {

// References in all cells together: beyond the first the outermost level gets coarser, beyond the second cells get no levels.
constexpr double kMostReferencesPerPrimitive = 16.0, kMostReferencesPerBlock = 64.0;
// Costs of a level in steps from cell to cell: to enter it, and to test a block (measured, accel/README.md).
constexpr double kEnterCost = 4.0, kBlockCost = 4.0;
// Slices of the outermost level, each filled by one task; blocks looked at by one task.
constexpr int kSlices = 64;
constexpr std::size_t kChunk = 4096;
// A level of so many references is filled by several tasks, one for each so many.
constexpr std::size_t kTaskReferences = 4096;

double half_area(glm::dvec3 s) { return s.x * s.y + s.y * s.z + s.z * s.x; }
std::size_t chunks(std::size_t n) { return (n + kChunk - 1) / kChunk; }

double cells_in(const CellRange& r) {
    double n = 1.0;
    for (int i = 0; i < 3; ++i) n *= r.last[i] - r.first[i] + 1;
    return n;
}

class Builder {
public:
    Builder(const GridBlocks& blocks, const std::vector<BoundedPrimitive>& primitives, double padding, const GridDensity& density,
            const ParallelFor& parallel_for)
        : blocks_(blocks), primitives_(primitives), padding_(padding), density_(density), parallel_for_(parallel_for) {}

    GridCells build() {
        const DoubleBox all = contents();
        const std::size_t first = blocks_.first[blocks_.large];
        const auto n = static_cast<double>(primitives_.size() - first);
        double cells = density_.outer * n;
        GridLevel top = make_level(all, cells);
        std::vector<BlockRange> ranges(primitives_.size() - first);
        // As if each primitive were a block of its own.
        while (find_ranges(top, ranges) > kMostReferencesPerPrimitive * n + 64.0 && cell_count(top) > 1) {
            top = make_level(all, cells *= 0.5);
        }
        GridPart whole;
        whole.levels.push_back(top);
        whole.cells.resize(cell_count(top));
        const std::size_t slice = std::size_t{top.n[0]} * top.n[1];
        std::vector<GridPart> parts(static_cast<std::size_t>(std::min<int>(kSlices, top.n[2])));
        const auto plane = [&](std::size_t i) { return i * top.n[2] / parts.size(); };
        const auto cells_of = [&](std::size_t t) {
            return std::span(whole.cells).subspan(plane(t) * slice, (plane(t + 1) - plane(t)) * slice);
        };
        parallel_for_(parts.size(), [&](std::size_t t) {
            fill_slice(top, static_cast<int>(plane(t)), static_cast<int>(plane(t + 1)), ranges, parts[t], cells_of(t));
        });
        ranges = {};
        append(parts, whole, parallel_for_, cells_of);
        return {std::move(whole.levels), std::move(whole.cells), std::move(whole.lists), whole.references};
    }

private:
    // What a thread needs at one depth while it fills cells.
    struct Room {
        std::vector<DoubleBox> boxes;  // grown, of the primitives that touch the cell
        std::vector<BlockRange> ranges;
        CellLists lists;
    };
    using Rooms = std::array<Room, kMaxGridDepth + 1>;

    // Number by number: a box put together on the stack and then copied waits for its own stores.
    void grow_into(std::size_t primitive, DoubleBox& box) const {
        const Aabb& b = primitives_[primitive].bounds;
        for (int i = 0; i < 3; ++i) {
            box.lo[i] = static_cast<double>(b.lo[i]) - padding_;
            box.hi[i] = static_cast<double>(b.hi[i]) + padding_;
        }
    }
    [[nodiscard]] DoubleBox grown(std::size_t primitive) const {
        DoubleBox box;
        grow_into(primitive, box);
        return box;
    }
    [[nodiscard]] DoubleBox contents() const {
        const std::size_t first = blocks_.first[blocks_.large], n = primitives_.size() - first;
        std::vector<DoubleBox> boxes(chunks(n));
        parallel_for_(boxes.size(), [&](std::size_t t) {
            DoubleBox box;
            for (std::size_t i = t * kChunk; i < std::min(n, (t + 1) * kChunk); ++i) box.grow(grown(first + i));
            boxes[t] = box;
        });
        DoubleBox all;
        for (const DoubleBox& box : boxes) all.grow(box);
        return all;
    }
    // The cells of the outermost level that each primitive touches; returns their number.
    double find_ranges(const GridLevel& top, std::vector<BlockRange>& ranges) const {
        const std::size_t first_block = blocks_.large, n = blocks_.refs.size() - first_block, start = blocks_.first[first_block];
        std::vector<double> counts(chunks(n));
        parallel_for_(counts.size(), [&](std::size_t t) {
            for (std::size_t k = t * kChunk; k < std::min(n, (t + 1) * kChunk); ++k) {
                const std::size_t b = first_block + k;
                for (std::size_t i = blocks_.first[b]; i < blocks_.first[b + 1]; ++i) {
                    ranges[i - start] = {range_of(top, grown(i)), static_cast<std::uint32_t>(b)};
                    counts[t] += cells_in(ranges[i - start].cells);
                }
            }
        });
        double total = 0.0;
        for (const double count : counts) total += count;
        return total;
    }
    // Planes z0..z1-1 of the outermost level, levels within them included.
    void fill_slice(const GridLevel& top, int z0, int z1, const std::vector<BlockRange>& all, GridPart& part,
                    std::span<GridCell> out) const {
        std::vector<BlockRange> inside;
        std::size_t blocks = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (all[i].cells.first[2] >= z1 || all[i].cells.last[2] < z0) continue;
            if (inside.empty() || inside.back().block != all[i].block) ++blocks;
            inside.push_back(all[i]);
        }
        CellLists lists;
        lists.make(top, z0, z1, inside);
        inside = {};
        const double references = static_cast<double>(std::max<std::size_t>(1, lists.reference_count()));
        const double allowance = kMostReferencesPerBlock * static_cast<double>(blocks) / references;
        Rooms rooms;
        finish_cells(top, z0, 0, lists, 1, allowance, part, rooms, out);
    }
    // Cells from `first` on of a level that begins at plane z0, as many as `out` has room for.
    void finish_cells(const GridLevel& level, int z0, std::size_t first, const CellLists& lists, int depth, double allowance,
                      GridPart& part, Rooms& rooms, std::span<GridCell> out) const {
        for (std::size_t k = 0; k < out.size(); ++k) {
            const std::size_t c = first + k, row = c / level.n[0];
            const glm::ivec3 cell(static_cast<int>(c % level.n[0]), static_cast<int>(row % level.n[1]),
                                  z0 + static_cast<int>(row / level.n[1]));
            out[k] = finish_cell(lists.of(c), level, cell, depth, allowance, part, rooms);
        }
    }
    [[nodiscard]] GridCell finish_cell(std::span<const std::uint32_t> blocks, const GridLevel& level, glm::ivec3 cell, int depth,
                                       double allowance, GridPart& part, Rooms& rooms) const {
        if (blocks.empty()) return 0;
        if (blocks.size() == 1) {
            part.references += 1;
            return blocks_.refs[blocks.front()];
        }
        if (blocks.size() >= density_.crowded && depth < kMaxGridDepth && allowance >= 1.5) {
            if (const GridCell inner = refine(blocks, box_of(level, cell), depth, allowance, part, rooms); inner != 0)
                return inner;
        }
        part.references += blocks.size();
        const std::size_t first = part.lists.size();
        for (const std::uint32_t b : blocks) part.lists.push_back(blocks_.refs[b]);
        part.lists.back() |= kLastOfList;
        return kListBit | static_cast<GridCell>(first);
    }
    // A level for the cell `box` if a ray through it is better off with one, else 0.
    [[nodiscard]] GridCell refine(std::span<const std::uint32_t> blocks, const DoubleBox& box, int depth, double allowance,
                                  GridPart& part, Rooms& rooms) const {
        Room& room = rooms[static_cast<std::size_t>(depth)];
        double touching = 0.0;
        const DoubleBox inside = gather(blocks, box, room, touching);
        if (room.boxes.empty()) return 0;
        const auto n = static_cast<double>(blocks.size());
        // Coarsen until the references fit, by an estimate that counts a block once per primitive.
        GridLevel level{};
        double wanted = density_.inner * static_cast<double>(room.boxes.size()), estimate = 0.0;
        for (int attempt = 0; attempt < 8; ++attempt, wanted *= 0.5) {
            level = make_level(inside, wanted);
            estimate = find_ranges(level, room);
            if (estimate <= allowance * n) break;
        }
        const std::size_t cells = cell_count(level);
        if (cells == 1 || estimate > allowance * n) return 0;
        // A random line meets a convex body inside another with the ratio of their areas (Santaló 2004, "Integral Geometry").
        const glm::dvec3 side(level.size[0], level.size[1], level.size[2]);
        const double chance = half_area(side) / half_area(box.size());
        const auto pays = [&](double references) {
            return kEnterCost + chance * (static_cast<double>(cells) + kBlockCost * references) < kBlockCost * n;
        };
        // There are no fewer references than blocks that touch the cell, so most levels need not be listed.
        if (!pays(touching)) return 0;
        room.lists.make(level, 0, level.n[2], room.ranges);
        const auto references = static_cast<double>(room.lists.reference_count());
        const double growth = references / n;
        if (growth > allowance || !pays(references)) return 0;
        level.first = static_cast<std::uint32_t>(part.cells.size());
        part.cells.resize(part.cells.size() + cells);
        const auto index = static_cast<GridCell>(part.levels.size());
        part.levels.push_back(level);
        fill_level(level, depth + 1, allowance / std::max(1.0, growth), room.lists, part, rooms);
        return kListBit | kLevelBit | index;
    }
    // The grown boxes of what touches the cell, and the part of it that they fill; counts their blocks.
    DoubleBox gather(std::span<const std::uint32_t> blocks, const DoubleBox& box, Room& room, double& touching) const {
        room.boxes.resize(blocks.size() * kBvhWidth);
        room.ranges.resize(blocks.size() * kBvhWidth);
        std::size_t count = 0, met = 0;
        for (const std::uint32_t b : blocks) {
            const std::size_t before = count;
            for (std::size_t i = blocks_.first[b]; i < blocks_.first[b + 1]; ++i) {
                // Written in any case and kept if it touches: a branch would be guessed wrong half the time.
                grow_into(i, room.boxes[count]);
                room.ranges[count].block = b;
                count += room.boxes[count].touches(box) ? 1 : 0;
            }
            met += count != before ? 1 : 0;
        }
        room.boxes.resize(count);
        room.ranges.resize(count);
        touching = static_cast<double>(met);
        DoubleBox inside;
        for (const DoubleBox& bounds : room.boxes) inside.grow(bounds);
        inside.lo = glm::max(inside.lo, box.lo);
        inside.hi = glm::min(inside.hi, box.hi);
        return inside;
    }
    static double find_ranges(const GridLevel& level, Room& room) {
        double total = 0.0;
        for (std::size_t i = 0; i < room.boxes.size(); ++i) {
            room.ranges[i].cells = range_of(level, room.boxes[i]);
            total += cells_in(room.ranges[i].cells);
        }
        return total / kBvhWidth;
    }
    // The cells of a level that `part` has room for already. A dense mesh in the corner of a field is one cell of the outermost
    // level, so a large one is shared out again.
    void fill_level(const GridLevel& level, int depth, double allowance, const CellLists& lists, GridPart& part,
                    Rooms& rooms) const {
        const std::size_t cells = lists.cell_count(), tasks = std::min(cells, lists.reference_count() / kTaskReferences);
        if (tasks < 2) {
            // Levels within append to part.cells, so it may move.
            std::vector<GridCell> out(cells);
            finish_cells(level, 0, 0, lists, depth, allowance, part, rooms, out);
            std::copy(out.begin(), out.end(), part.cells.begin() + level.first);
            return;
        }
        std::vector<std::size_t> starts{0};
        for (std::size_t c = 1; c < cells; ++c) {
            if (lists.references_before(c) >= starts.size() * lists.reference_count() / tasks) starts.push_back(c);
        }
        std::vector<GridPart> parts(starts.size());
        starts.push_back(cells);
        const auto cells_of = [&](std::size_t t) {
            return std::span(part.cells).subspan(level.first + starts[t], starts[t + 1] - starts[t]);
        };
        parallel_for_(parts.size(), [&](std::size_t t) {
            Rooms own;
            finish_cells(level, 0, starts[t], lists, depth, allowance, parts[t], own, cells_of(t));
        });
        append(parts, part, parallel_for_, cells_of);
    }

    const GridBlocks& blocks_;
    const std::vector<BoundedPrimitive>& primitives_;
    double padding_;
    GridDensity density_;
    const ParallelFor& parallel_for_;
};

}  // namespace

GridCells build_grid_cells(const GridBlocks& blocks, const std::vector<BoundedPrimitive>& primitives, double padding,
                           const GridDensity& density, const ParallelFor& parallel_for) {
    return Builder(blocks, primitives, padding, density, parallel_for).build();
}

}  // namespace glint
