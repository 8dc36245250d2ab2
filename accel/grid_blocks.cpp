#include "accel/grid_blocks.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace glint {
namespace {

constexpr std::size_t kWidth = kBvhWidth;

std::size_t units_of(PrimitiveKind kind) {
    const std::size_t bytes = kind == PrimitiveKind::triangle ? sizeof(TriangleBlock)
                              : kind == PrimitiveKind::sphere ? sizeof(SphereBlock)
                              : kind == PrimitiveKind::box    ? sizeof(BoxBlock)
                                                              : sizeof(ConeBlock);
    return bytes / kBvhUnit;
}

// Lane `lane` of the block at `unit`.
void write_lane(std::byte* unit, std::size_t lane, const Geometry& g, PrimitiveId id) {
    const std::uint32_t index = index_of(id);
    switch (kind_of(id)) {
        case PrimitiveKind::triangle: {
            auto& block = *reinterpret_cast<TriangleBlock*>(unit);
            block.id[lane] = id;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const glm::vec3& v = g.vertices[g.triangles[index][corner]];
                for (int axis = 0; axis < 3; ++axis) block.v[3 * corner + static_cast<std::size_t>(axis)][lane] = v[axis];
            }
            return;
        }
        case PrimitiveKind::sphere: {
            auto& block = *reinterpret_cast<SphereBlock*>(unit);
            block.id[lane] = id;
            for (int axis = 0; axis < 3; ++axis) block.center[axis][lane] = g.spheres[index].center[axis];
            block.radius[lane] = g.spheres[index].radius;
            return;
        }
        case PrimitiveKind::box: {
            auto& block = *reinterpret_cast<BoxBlock*>(unit);
            block.id[lane] = id;
            for (int axis = 0; axis < 3; ++axis) {
                block.lo[axis][lane] = g.boxes[index].lo[axis];
                block.hi[axis][lane] = g.boxes[index].hi[axis];
            }
            return;
        }
        default: reinterpret_cast<ConeBlock*>(unit)->id[lane] = id;
    }
}

// Lays out blocks for primitives [begin, end), kind by kind, and leaves each kind's range to be ordered.
void lay_out(std::vector<BoundedPrimitive>& primitives, std::size_t begin, std::size_t end, std::size_t& units,
             GridBlocks& blocks, std::vector<OrderRange>& ranges) {
    const auto at = [&](std::size_t i) { return primitives.begin() + static_cast<std::ptrdiff_t>(i); };
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone}) {
        const auto of_kind = [kind](const BoundedPrimitive& p) { return kind_of(p.id) == kind; };
        const auto next = static_cast<std::size_t>(std::partition(at(begin), at(end), of_kind) - primitives.begin());
        ranges.push_back({begin, next});
        for (; begin < next; begin = std::min(begin + kWidth, next)) {
            if (units > kUnitMask) throw std::length_error("more primitives than a grid can name");
            blocks.refs.push_back(static_cast<BvhRef>(kind) << 29 | static_cast<BvhRef>(units));
            blocks.first.push_back(static_cast<std::uint32_t>(begin));
            units += units_of(kind);
        }
    }
}

}  // namespace

GridBlocks make_grid_blocks(const Geometry& geometry, std::vector<BoundedPrimitive>& primitives, std::size_t large,
                            const ParallelFor& parallel_for) {
    std::vector<OrderRange> ranges;
    GridBlocks blocks;
    std::size_t units = 1;
    lay_out(primitives, 0, large, units, blocks, ranges);
    blocks.large = blocks.refs.size();
    lay_out(primitives, large, primitives.size(), units, blocks, ranges);
    blocks.first.push_back(static_cast<std::uint32_t>(primitives.size()));
    order_by_neighbours(primitives, std::move(ranges), parallel_for);
    blocks.units.resize(units);
    constexpr std::size_t kBlocksATask = 4096;
    parallel_for((blocks.refs.size() + kBlocksATask - 1) / kBlocksATask, [&](std::size_t t) {
        for (std::size_t b = t * kBlocksATask; b < std::min(blocks.refs.size(), (t + 1) * kBlocksATask); ++b) {
            std::byte* unit = blocks.units[blocks.refs[b] & kUnitMask].bytes;
            // Unused lanes repeat the last primitive.
            for (std::size_t lane = 0; lane < kWidth; ++lane) {
                const std::size_t i = std::min<std::size_t>(blocks.first[b] + lane, blocks.first[b + 1] - 1);
                write_lane(unit, lane, geometry, primitives[i].id);
            }
        }
    });
    return blocks;
}

}  // namespace glint
