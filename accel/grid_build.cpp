#include "accel/grid_build.h"

#include <algorithm>
#include <numeric>

#include "accel/grid_level.h"

namespace glint {
namespace {

// References in all cells together: beyond the first the outermost level gets coarser, beyond the second cells get no levels.
constexpr double kMostReferencesPerPrimitive = 16.0, kMostReferencesPerBlock = 64.0;
// Costs of a level in steps from cell to cell: to enter it, and to test a block (measured, accel/README.md).
constexpr double kEnterCost = 4.0, kBlockCost = 4.0;
// Slices of the outermost level, each filled by one task.
constexpr int kTasks = 64;

double half_area(glm::dvec3 s) { return s.x * s.y + s.y * s.z + s.z * s.x; }

// Levels, cells and lists under construction; indices count from the part's own start.
struct Part {
    std::vector<GridLevel> levels;
    std::vector<GridCell> cells;
    std::vector<BvhRef> lists;
    std::size_t references = 0;
};

class Builder {
public:
    Builder(const GridBlocks& blocks, const std::vector<BoundedPrimitive>& primitives, double padding, const GridDensity& density)
        : blocks_(blocks), primitives_(primitives), padding_(padding), density_(density) {}

    GridCells build(const ParallelFor& parallel_for) {
        DoubleBox all;
        for (std::size_t i = blocks_.first[blocks_.large]; i < primitives_.size(); ++i) all.grow(grown(i));
        const auto n = static_cast<double>(primitives_.size() - blocks_.first[blocks_.large]);
        double cells = density_.outer * n;
        GridLevel top = make_level(all, cells);
        std::vector<std::uint32_t> every(blocks_.refs.size() - blocks_.large);
        std::iota(every.begin(), every.end(), static_cast<std::uint32_t>(blocks_.large));
        while (count_references(top, every, all) * kBvhWidth > kMostReferencesPerPrimitive * n + 64.0 && cell_count(top) > 1) {
            top = make_level(all, cells *= 0.5);
        }
        std::vector<Planes> planes;
        for (const std::uint32_t b : every) planes.push_back(planes_of(top, b));
        const std::size_t slice = std::size_t{top.n[0]} * top.n[1];
        const int tasks = std::min<int>(kTasks, top.n[2]);
        std::vector<Part> parts(static_cast<std::size_t>(tasks));
        std::vector<GridCell> outer(cell_count(top));
        parallel_for(parts.size(), [&](std::size_t t) {
            const auto plane = [&](std::size_t i) { return static_cast<int>(i * top.n[2] / parts.size()); };
            const int z0 = plane(t), z1 = plane(t + 1);
            std::vector<std::uint32_t> inside;
            for (const std::uint32_t b : every) {
                if (planes[b - blocks_.large].first < z1 && planes[b - blocks_.large].last >= z0) inside.push_back(b);
            }
            fill_cells(top, z0, z1, all, inside, 1, kMostReferencesPerBlock, parts[t],
                       outer.data() + static_cast<std::size_t>(z0) * slice);
        });
        return join(top, std::move(outer), parts, parallel_for);
    }

private:
    [[nodiscard]] DoubleBox grown(std::size_t primitive) const {
        const Aabb& b = primitives_[primitive].bounds;
        return {glm::dvec3(b.lo) - padding_, glm::dvec3(b.hi) + padding_};
    }
    // The planes of cells that a block reaches.
    struct Planes {
        int first, last;
    };
    [[nodiscard]] Planes planes_of(const GridLevel& level, std::uint32_t block) const {
        DoubleBox box;
        for (std::size_t i = blocks_.first[block]; i < blocks_.first[block + 1]; ++i) box.grow(grown(i));
        const CellRange r = range_of(level, box);
        return {r.first.z, r.last.z};
    }
    // An estimate that counts a block once per primitive of a full block.
    [[nodiscard]] double count_references(const GridLevel& level, const std::vector<std::uint32_t>& blocks,
                                          const DoubleBox& box) const {
        double total = 0.0;
        for (const std::uint32_t b : blocks) {
            for (std::size_t i = blocks_.first[b]; i < blocks_.first[b + 1]; ++i) {
                const DoubleBox bounds = grown(i);
                if (!bounds.touches(box)) continue;
                const CellRange r = range_of(level, bounds);
                const glm::dvec3 n(r.last - r.first + 1);
                total += n.x * n.y * n.z;
            }
        }
        return total / kBvhWidth;
    }
    // Calls visit(cell, block) for each block of `blocks` and each cell of planes z0..z1-1 that one of its primitives within
    // `box` touches; a pair may come more than once, but all of a block's come together.
    template <class Visit>
    void for_each_pair(const GridLevel& level, int z0, int z1, const DoubleBox& box, const std::vector<std::uint32_t>& blocks,
                       const Visit& visit) const {
        for (const std::uint32_t b : blocks) {
            for (std::size_t i = blocks_.first[b]; i < blocks_.first[b + 1]; ++i) {
                const DoubleBox bounds = grown(i);
                if (!bounds.touches(box)) continue;
                const CellRange r = range_of(level, bounds);
                for (int z = std::max(r.first.z, z0); z <= std::min(r.last.z, z1 - 1); ++z) {
                    for (int y = r.first.y; y <= r.last.y; ++y) {
                        const std::size_t row =
                            (static_cast<std::size_t>(z - z0) * level.n[1] + static_cast<std::size_t>(y)) * level.n[0];
                        for (int x = r.first.x; x <= r.last.x; ++x) visit(row + static_cast<std::size_t>(x), b);
                    }
                }
            }
        }
    }

    // The lists of planes z0..z1-1 of a level, in the order of cells.
    struct Lists {
        std::vector<std::uint32_t> offsets, blocks;
    };
    [[nodiscard]] Lists list_blocks(const GridLevel& level, int z0, int z1, const DoubleBox& box,
                                    const std::vector<std::uint32_t>& blocks) const {
        const std::size_t cells = static_cast<std::size_t>(z1 - z0) * level.n[0] * level.n[1];
        Lists lists;
        lists.offsets.assign(cells + 1, 0);
        std::vector<std::uint32_t> last(cells, ~0u);
        for_each_pair(level, z0, z1, box, blocks, [&](std::size_t c, std::uint32_t b) {
            if (last[c] != b) last[c] = b, ++lists.offsets[c + 1];
        });
        for (std::size_t c = 0; c < cells; ++c) lists.offsets[c + 1] += lists.offsets[c];
        lists.blocks.resize(lists.offsets[cells]);
        std::vector<std::uint32_t> next(lists.offsets.begin(), lists.offsets.end() - 1);
        std::fill(last.begin(), last.end(), ~0u);
        for_each_pair(level, z0, z1, box, blocks, [&](std::size_t c, std::uint32_t b) {
            if (last[c] != b) last[c] = b, lists.blocks[next[c]++] = b;
        });
        return lists;
    }

    // Writes cells of planes z0..z1-1 from `out` on, levels within them included.
    void fill_cells(const GridLevel& level, int z0, int z1, const DoubleBox& box, const std::vector<std::uint32_t>& blocks,
                    int depth, double allowance, Part& part, GridCell* out) const {
        const Lists lists = list_blocks(level, z0, z1, box, blocks);
        finish_cells(
            level, z0, z1, lists, depth,
            allowance * static_cast<double>(blocks.size()) / static_cast<double>(std::max<std::size_t>(1, lists.blocks.size())),
            part, [out](std::size_t c, GridCell cell) { out[c] = cell; });
    }
    template <class Write>
    void finish_cells(const GridLevel& level, int z0, int z1, const Lists& lists, int depth, double allowance, Part& part,
                      const Write& write) const {
        std::vector<std::uint32_t> blocks;
        std::size_t c = 0;
        for (int z = z0; z < z1; ++z) {
            for (int y = 0; y < level.n[1]; ++y) {
                for (int x = 0; x < level.n[0]; ++x, ++c) {
                    blocks.assign(lists.blocks.begin() + lists.offsets[c], lists.blocks.begin() + lists.offsets[c + 1]);
                    write(c, finish_cell(blocks, box_of(level, {x, y, z}), depth, allowance, part));
                }
            }
        }
    }
    [[nodiscard]] GridCell finish_cell(const std::vector<std::uint32_t>& blocks, const DoubleBox& box, int depth,
                                       double allowance, Part& part) const {
        if (blocks.empty()) return 0;
        if (blocks.size() == 1) {
            part.references += 1;
            return blocks_.refs[blocks.front()];
        }
        if (blocks.size() >= density_.crowded && depth < kMaxGridDepth && allowance >= 1.5) {
            if (const GridCell level = refine(blocks, box, depth, allowance, part); level != 0) return level;
        }
        part.references += blocks.size();
        const std::size_t first = part.lists.size();
        for (const std::uint32_t b : blocks) part.lists.push_back(blocks_.refs[b]);
        part.lists.back() |= kLastOfList;
        return kListBit | static_cast<GridCell>(first);
    }
    // A level for the cell `box` if a ray through it is better off with one, else 0.
    [[nodiscard]] GridCell refine(const std::vector<std::uint32_t>& blocks, const DoubleBox& box, int depth, double allowance,
                                  Part& part) const {
        DoubleBox contents;
        double primitives = 0.0;
        for (const std::uint32_t b : blocks) {
            for (std::size_t i = blocks_.first[b]; i < blocks_.first[b + 1]; ++i) {
                const DoubleBox bounds = grown(i);
                if (!bounds.touches(box)) continue;
                contents.grow(bounds);
                primitives += 1.0;
            }
        }
        if (primitives == 0.0) return 0;
        contents.lo = glm::max(contents.lo, box.lo);
        contents.hi = glm::min(contents.hi, box.hi);
        // Coarsen until the references fit, by an estimate that counts a block once per primitive.
        GridLevel level{};
        double wanted = density_.inner * primitives, estimate = 0.0;
        for (int attempt = 0; attempt < 8; ++attempt, wanted *= 0.5) {
            level = make_level(contents, wanted);
            estimate = count_references(level, blocks, box);
            if (estimate <= allowance * static_cast<double>(blocks.size())) break;
        }
        const std::size_t cells = cell_count(level);
        if (cells == 1 || estimate > allowance * static_cast<double>(blocks.size())) return 0;
        const Lists lists = list_blocks(level, 0, level.n[2], box, blocks);
        const double references = static_cast<double>(lists.blocks.size()),
                     growth = references / static_cast<double>(blocks.size());
        // A random line meets a convex body inside another with the ratio of their areas (Santaló 2004, "Integral Geometry").
        const glm::dvec3 side(level.size[0], level.size[1], level.size[2]);
        const double chance = half_area(side) / half_area(box.size());
        const double cost = kEnterCost + chance * (static_cast<double>(cells) + kBlockCost * references);
        if (growth > allowance || cost >= kBlockCost * static_cast<double>(blocks.size())) return 0;
        level.first = static_cast<std::uint32_t>(part.cells.size());
        part.cells.resize(part.cells.size() + cells);
        const auto index = static_cast<GridCell>(part.levels.size());
        part.levels.push_back(level);
        finish_cells(level, 0, level.n[2], lists, depth + 1, allowance / std::max(1.0, growth), part,
                     [&part, &level](std::size_t c, GridCell cell) { part.cells[level.first + c] = cell; });
        return kListBit | kLevelBit | index;
    }

    // The parts behind each other, their indices shifted.
    [[nodiscard]] static GridCells join(const GridLevel& top, std::vector<GridCell> outer, std::vector<Part>& parts,
                                        const ParallelFor& parallel_for) {
        GridCells result;
        struct Start {
            std::size_t level, cell, list;
        };
        std::vector<Start> starts;
        Start next{1, outer.size(), 0};
        for (const Part& p : parts) {
            starts.push_back(next);
            next = {next.level + p.levels.size(), next.cell + p.cells.size(), next.list + p.lists.size()};
            result.references += p.references;
        }
        result.levels.resize(next.level);
        result.levels.front() = top;
        result.cells = std::move(outer);
        result.cells.resize(next.cell);
        result.lists.resize(next.list);
        const std::size_t slice = std::size_t{top.n[0]} * top.n[1];
        parallel_for(parts.size(), [&](std::size_t t) {
            Part& p = parts[t];
            const Start& s = starts[t];
            const auto shifted = [&s](GridCell cell) {
                if ((cell & kListBit) == 0) return cell;
                return cell + static_cast<GridCell>((cell & kLevelBit) != 0 ? s.level : s.list);
            };
            const auto plane = [&](std::size_t i) { return i * top.n[2] / parts.size() * slice; };
            for (std::size_t c = plane(t); c < plane(t + 1); ++c) result.cells[c] = shifted(result.cells[c]);
            for (std::size_t c = 0; c < p.cells.size(); ++c) result.cells[s.cell + c] = shifted(p.cells[c]);
            for (std::size_t l = 0; l < p.levels.size(); ++l) {
                result.levels[s.level + l] = p.levels[l];
                result.levels[s.level + l].first += static_cast<std::uint32_t>(s.cell);
            }
            std::copy(p.lists.begin(), p.lists.end(), result.lists.begin() + static_cast<std::ptrdiff_t>(s.list));
            p = Part{};
        });
        return result;
    }

    const GridBlocks& blocks_;
    const std::vector<BoundedPrimitive>& primitives_;
    double padding_;
    GridDensity density_;
};

}  // namespace

GridCells build_grid_cells(const GridBlocks& blocks, const std::vector<BoundedPrimitive>& primitives, double padding,
                           const GridDensity& density, const ParallelFor& parallel_for) {
    return Builder(blocks, primitives, padding, density).build(parallel_for);
}

}  // namespace glint
