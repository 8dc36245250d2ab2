#include "accel/bvh_clusters.h"

#include <algorithm>
#include <stdexcept>

#include "accel/bvh_curve.h"
#include "accel/bvh_refs.h"
#include "accel/bvh_sets.h"

namespace glint {
namespace {

// Primitives of one cluster, and of the cells in it that are cut into leaves. Larger ones make a worse tree, smaller ones more
// work above them.
constexpr std::size_t kClusterSize = 160, kCellSize = 32;
// Stretches of the curve that one task writes, so many at a time: fewer leave threads waiting for each other, more are not copied
// from a cache.
constexpr std::size_t kStretch = 1u << 11, kBatch = 64;

// What a task writes; references count from its own first unit.
struct Stretch {
    BvhPart part;
    BuildRefs leaves, clusters;
    std::vector<CurveCell> larger, cells, crowds;

    void clear() { part.clear(), leaves.clear(), clusters.clear(), larger.clear(), crowds.clear(); }

    void write_leaf(const Geometry& geometry, std::span<const BuildRef> refs, const Box4& box) {
        LeafIds ids;
        part.count_leaf_extent(box);
        leaves.push_back(make_ref(box, part.append_leaf(geometry, ids_of(refs, ids)), 1.0f));
    }
    void write_in_order(const Geometry& geometry, std::span<const BuildRef> refs, const Box4& box) {
        if (is_leaf(refs)) return write_leaf(geometry, refs, box);
        const Split split = best_sweep(refs, SweepOf::primitives);
        const auto n = static_cast<std::size_t>(split.bin);
        write_in_order(geometry, refs.first(n), split.left);
        write_in_order(geometry, refs.subspan(n), split.right);
    }
    void close_cluster(std::size_t first, const Box4& box) {
        clusters.push_back(make_ref(box, static_cast<std::uint32_t>(first), static_cast<float>(leaves.size() - first)));
    }
    Box4 write_cell(const Geometry& geometry, std::span<const CurveKey> keys, CurveCell cell) {
        std::array<BuildRef, kCellSize> refs;
        Box4 box;
        for (std::uint32_t i = cell.first; i < cell.last; ++i) {
            fetch_indices(geometry, keys[std::min<std::size_t>(i + 32, keys.size() - 1)].id);
            fetch_vertices(geometry, keys[std::min<std::size_t>(i + 16, keys.size() - 1)].id);
            const Box4 bounds = bounds_of(geometry, keys[i].id);
            refs[i - cell.first] = make_ref(bounds, keys[i].id, 1.0f);
            box.grow(bounds);
        }
        write_in_order(geometry, std::span(refs).first(cell.count()), box);
        return box;
    }
    void write(const Geometry& geometry, std::span<const CurveKey> keys, CurveCell stretch) {
        cut_cells(keys, stretch, kClusterSize, larger);
        for (const CurveCell& cluster : larger) {
            cells.clear();
            cut_cells(keys, cluster, kCellSize, cells);
            const std::size_t first = leaves.size();
            Box4 box;
            for (const CurveCell& cell : cells) {
                if (cell.count() > kCellSize) {
                    crowds.push_back(cell);
                } else {
                    box.grow(write_cell(geometry, keys, cell));
                }
            }
            if (leaves.size() > first) close_cluster(first, box);
        }
    }
    // A set that the curve does not tell apart, cut as in the quality build: each leaf is a cluster.
    void write_loose(const Geometry& geometry, std::span<BuildRef> refs, const Candidate& c, int level) {
        if (c.leaf) {
            write_leaf(geometry, refs.subspan(c.range.first, c.range.count), c.range.bounds);
            return close_cluster(leaves.size() - 1, c.range.bounds);
        }
        Candidate left, right;
        cut_bins(refs, c, level + 1, serial_for, left, right);
        write_loose(geometry, refs, left, level + 1);
        write_loose(geometry, refs, right, level + 1);
    }
};

class Writer {
public:
    Writer(const Geometry& geometry, const ParallelFor& parallel_for) : geometry_(geometry), parallel_for_(parallel_for) {
        const std::size_t n = geometry.bounded_count();
        out_.written.begin_tree(n);
        out_.leaves.reserve(n / 4 + 64);
        out_.clusters.reserve(n / 16 + 64);
    }

    LeafClusters write() {
        const CurveKeys keys = sort_along_curve(geometry_, parallel_for_);
        std::vector<CurveCell> cells, crowds;
        cut_cells(keys, {0, static_cast<std::uint32_t>(keys.size())}, kStretch, cells);
        in_batches(
            cells.size(), [&](Stretch& stretch, std::size_t i) { stretch.write(geometry_, keys, cells[i]); }, crowds);
        for (const CurveCell& crowd : crowds) write_crowd(std::span(keys).subspan(crowd.first, crowd.count()));
        return std::move(out_);
    }

private:
    // Large crowds are cut by all threads, what is left of them is shared out.
    void write_crowd(std::span<const CurveKey> keys) {
        BuildRefs refs(keys.size());
        parallel_for_(chunks_of(keys.size()), [&](std::size_t i) {
            for (std::size_t at = i * kChunk; at < std::min(keys.size(), (i + 1) * kChunk); ++at)
                refs[at] = make_ref(bounds_of(geometry_, keys[at].id), keys[at].id, 1.0f);
        });
        struct Set {
            Candidate candidate;
            int level;
        };
        std::vector<Set> open{{examine_bins(refs, measure(refs, parallel_for_), 1, parallel_for_), 1}}, sets;
        while (!open.empty()) {
            const Set set = open.back();
            open.pop_back();
            if (set.candidate.range.count <= kStretch) {
                sets.push_back(set);
                continue;
            }
            Set left{{}, set.level + 1}, right{{}, set.level + 1};
            cut_bins(refs, set.candidate, set.level + 1, parallel_for_, left.candidate, right.candidate);
            open.push_back(right), open.push_back(left);
        }
        std::vector<CurveCell> none;
        in_batches(
            sets.size(),
            [&](Stretch& stretch, std::size_t i) { stretch.write_loose(geometry_, refs, sets[i].candidate, sets[i].level); },
            none);
    }

    template <class Write>
    void in_batches(std::size_t count, const Write& write, std::vector<CurveCell>& crowds) {
        for (std::size_t begin = 0; begin < count; begin += kBatch) {
            const std::size_t n = std::min(kBatch, count - begin);
            parallel_for_(n, [&](std::size_t i) {
                stretches_[i].clear();
                write(stretches_[i], begin + i);
            });
            join(n);
            for (std::size_t i = 0; i < n; ++i)
                crowds.insert(crowds.end(), stretches_[i].crowds.begin(), stretches_[i].crowds.end());
        }
    }
    void join(std::size_t n) {
        std::array<std::size_t, kBatch> units, leaves, clusters;
        std::size_t unit = out_.written.units.size(), leaf = out_.leaves.size(), cluster = out_.clusters.size();
        for (std::size_t i = 0; i < n; ++i) {
            units[i] = unit, leaves[i] = leaf, clusters[i] = cluster;
            unit += stretches_[i].part.units.size();
            leaf += stretches_[i].leaves.size();
            cluster += stretches_[i].clusters.size();
            out_.written.leaves += stretches_[i].part.leaves;
            out_.written.leaf_sides += stretches_[i].part.leaf_sides;
        }
        if (unit > kUnitMask) throw std::length_error("too many primitives for one BVH");
        out_.written.units.resize(unit), out_.leaves.resize(leaf), out_.clusters.resize(cluster);
        parallel_for_(n, [&](std::size_t i) {
            const Stretch& stretch = stretches_[i];
            std::ranges::copy(stretch.part.units, out_.written.units.begin() + static_cast<std::ptrdiff_t>(units[i]));
            move(stretch.leaves, std::span(out_.leaves).subspan(leaves[i]), units[i]);
            move(stretch.clusters, std::span(out_.clusters).subspan(clusters[i]), leaves[i]);
        });
    }

    // Copies references; what they name begins `by` later there.
    static void move(std::span<const BuildRef> from, std::span<BuildRef> to, std::size_t by) {
        for (std::size_t i = 0; i < from.size(); ++i) {
            to[i] = from[i];
            to[i].id += static_cast<std::uint32_t>(by);
        }
    }

    const Geometry& geometry_;
    const ParallelFor& parallel_for_;
    LeafClusters out_;
    std::array<Stretch, kBatch> stretches_;
};

}  // namespace

LeafClusters write_clusters(const Geometry& geometry, const ParallelFor& parallel_for) {
    return Writer(geometry, parallel_for).write();
}

}  // namespace glint
