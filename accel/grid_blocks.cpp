#include "accel/grid_blocks.h"

#include <algorithm>
#include <stdexcept>

namespace glint {
namespace {

constexpr std::size_t kWidth = kBvhWidth;
// Ranges of this size are ordered by one task.
constexpr std::size_t kTaskPrimitives = 16384;

struct Range {
    std::size_t begin, end;
};

// Puts the lower half before the upper, both in whole blocks but for the last, and returns where the upper begins.
std::size_t split(std::vector<BoundedPrimitive>& p, Range r) {
    glm::vec3 lo(kInfinity), hi(-kInfinity);
    for (std::size_t i = r.begin; i < r.end; ++i) {
        const glm::vec3 c = p[i].bounds.center();
        lo = glm::min(lo, c);
        hi = glm::max(hi, c);
    }
    const glm::vec3 size = hi - lo;
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const std::size_t blocks = (r.end - r.begin + kWidth - 1) / kWidth;
    const std::size_t middle = r.begin + blocks / 2 * kWidth;
    const auto at = [&](std::size_t i) { return p.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(r.begin), at(middle), at(r.end), [axis](const BoundedPrimitive& a, const BoundedPrimitive& b) {
        const float ca = 0.5f * a.bounds.lo[axis] + 0.5f * a.bounds.hi[axis];
        const float cb = 0.5f * b.bounds.lo[axis] + 0.5f * b.bounds.hi[axis];
        return ca != cb ? ca < cb : a.id < b.id;
    });
    return middle;
}

// Splits until no range exceeds `size`; calls done(range) for each.
template <class Done>
void order(std::vector<BoundedPrimitive>& p, Range r, std::size_t size, const Done& done) {
    if (r.end - r.begin <= size) {
        if (r.begin < r.end) done(r);
        return;
    }
    const std::size_t middle = split(p, r);
    order(p, {r.begin, middle}, size, done);
    order(p, {middle, r.end}, size, done);
}

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

// Lays out blocks for primitives [begin, end), kind by kind, and leaves the ordering of the ranges in `tasks` to do.
void lay_out(std::vector<BoundedPrimitive>& primitives, std::size_t begin, std::size_t end, std::size_t& units,
             GridBlocks& blocks, std::vector<Range>& tasks) {
    const auto at = [&](std::size_t i) { return primitives.begin() + static_cast<std::ptrdiff_t>(i); };
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone}) {
        const auto of_kind = [kind](const BoundedPrimitive& p) { return kind_of(p.id) == kind; };
        const auto next = static_cast<std::size_t>(std::partition(at(begin), at(end), of_kind) - primitives.begin());
        order(primitives, {begin, next}, kTaskPrimitives, [&](Range r) { tasks.push_back(r); });
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
    std::vector<Range> tasks;
    GridBlocks blocks;
    std::size_t units = 1;
    lay_out(primitives, 0, large, units, blocks, tasks);
    blocks.large = blocks.refs.size();
    lay_out(primitives, large, primitives.size(), units, blocks, tasks);
    blocks.first.push_back(static_cast<std::uint32_t>(primitives.size()));
    parallel_for(tasks.size(), [&](std::size_t t) { order(primitives, tasks[t], kWidth, [](Range) {}); });
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
