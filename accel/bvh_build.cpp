#include <algorithm>
#include <array>
#include <stdexcept>

#include "accel/bvh.h"
#include "accel/bvh_sets.h"
#include "accel/bvh_writer.h"

namespace glint {
namespace {

// Sets up to this size are built by one task each; larger ones are cut by all threads together.
constexpr std::uint32_t kTaskSize = 1u << 14;
// Tasks whose results wait in memory at a time before they join the tree.
constexpr std::size_t kBatch = 16;
constexpr std::size_t kRootUnits = sizeof(BvhNode) / kBvhUnit;

template <class Sets>
class Builder {
public:
    Builder(const Geometry& geometry, const ParallelFor& parallel_for)
        : parallel_for_(parallel_for), sets_(geometry, parallel_for) {}

    BvhTree build() {
        const Candidate whole = sets_.whole(parallel_for_);
        BvhPart ahead = sets_.ahead();
        // The root comes first, the other nodes behind what stands there already.
        BvhPart top;
        top.origin = ahead.units.size() - kRootUnits;
        fill_node(top, top.append_node(), whole, 1, true);
        BvhTree tree;
        tree.bounds = box_of(whole.range.bounds);
        tree.units = std::move(ahead.units);
        tree.nodes = top.nodes, tree.leaves = ahead.leaves + top.leaves, tree.depth = top.depth;
        top.leaf_sides += ahead.leaf_sides;
        const std::size_t top_units = tree.units.size();
        tree.units.resize(top_units + top.units.size() - kRootUnits);
        for (std::size_t first = 0; first < tasks_.size(); first += kBatch) build_some(first, top, tree);
        std::copy_n(top.units.begin(), kRootUnits, tree.units.begin());
        std::copy(top.units.begin() + kRootUnits, top.units.end(), tree.units.begin() + static_cast<std::ptrdiff_t>(top_units));
        if (tree.leaves > 0) tree.leaf_extent = static_cast<float>(top.leaf_sides / static_cast<double>(tree.leaves));
        return tree;
    }

private:
    struct Task {
        Candidate candidate;
        int level;
        std::size_t node, child;  // of the top part: where the reference to the result goes
    };

    static Aabb box_of(const Box4& box) {
        alignas(16) float lo[4], hi[4];
        _mm_store_ps(lo, box.lo);
        _mm_store_ps(hi, box.hi);
        return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
    }

    // A batch of tasks by all threads, then their results behind the tree's end. In batches, so that the memory the parts are
    // written to is still in a cache when it is used again.
    void build_some(std::size_t first, BvhPart& top, BvhTree& tree) {
        const std::size_t n = std::min(kBatch, tasks_.size() - first);
        parallel_for_(n, [&](std::size_t i) {
            const Task& task = tasks_[first + i];
            BvhPart& part = parts_[i];
            part.clear();
            part.units.reserve(kTaskSize + kTaskSize / 2);
            fill_node(part, part.append_node(), task.candidate, task.level, false);
        });
        std::array<std::size_t, kBatch> offsets;
        std::size_t size = tree.units.size();
        for (std::size_t i = 0; i < n; ++i) {
            const BvhPart& part = parts_[i];
            offsets[i] = size;
            size += part.units.size();
            if (size > kUnitMask) throw std::length_error("too many primitives for one BVH");
            top.node(tasks_[first + i].node).child[tasks_[first + i].child] = static_cast<BvhRef>(offsets[i]);
            top.leaf_sides += part.leaf_sides;
            tree.nodes += part.nodes;
            tree.leaves += part.leaves;
            tree.depth = std::max(tree.depth, part.depth);
        }
        tree.units.resize(size);
        parallel_for_(n, [&](std::size_t i) {
            parts_[i].move_references(static_cast<BvhRef>(offsets[i]), !Sets::kLeavesAhead);
            std::ranges::copy(parts_[i].units, tree.units.begin() + static_cast<std::ptrdiff_t>(offsets[i]));
        });
    }

    void fill_node(BvhPart& part, std::size_t node, const Candidate& whole, int level, bool top) {
        part.depth = std::max(part.depth, level);
        const ParallelFor serial = serial_for;
        std::array<Candidate, kBvhWidth> children;
        children[0] = whole;
        std::size_t n = 1;
        while (n < kBvhWidth) {
            std::size_t widest = n;
            for (std::size_t i = 0; i < n; ++i) {
                if (!children[i].leaf && (widest == n || children[i].area > children[widest].area)) widest = i;
            }
            if (widest == n) break;
            const Candidate open = children[widest];
            sets_.cut(open, level + 1, top ? parallel_for_ : serial, children[widest], children[n]);
            ++n;
        }
        std::array<Box4, kBvhWidth> boxes;
        for (std::size_t i = 0; i < n; ++i) boxes[i] = children[i].range.bounds;
        write_bounds(part.node(node), std::span(boxes).first(n));
        sets_.write_leaves(part, node, std::span(children).first(n));
        for (std::size_t i = 0; i < n; ++i) {
            if (children[i].leaf) continue;
            if (top && children[i].range.count * Sets::kPrimitives <= kTaskSize) {
                tasks_.push_back({children[i], level + 1, node, i});
                continue;
            }
            const std::size_t below = part.append_node();
            part.node(node).child[i] = static_cast<BvhRef>(below);
            fill_node(part, below, children[i], level + 1, top);
        }
    }

    const ParallelFor& parallel_for_;
    Sets sets_;
    std::vector<Task> tasks_;
    std::array<BvhPart, kBatch> parts_;
};

}  // namespace

BvhTree build_bvh(const Geometry& geometry, const ParallelFor& parallel_for, BuildQuality quality) {
    if (geometry.bounded_count() == 0) return {};
    if (quality == BuildQuality::fast) return Builder<FastSets>(geometry, parallel_for).build();
    return Builder<QualitySets>(geometry, parallel_for).build();
}

}  // namespace glint
