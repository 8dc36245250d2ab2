// The sets of primitives a tree is made of, from the whole down to the leaves, and how a set is cut in two: what tells the builds
// apart. Knows no nodes. A `Sets` offers: ahead(), whole(), cut() and write_leaves(). Invariant: what becomes of a set depends on
// it alone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "accel/bvh_clusters.h"

namespace glint {

// Sets below this level are halved by count, which ends within 30 more levels.
constexpr int kSahLevels = 32;

// A child to be: a leaf, or a set with the cut that would divide it.
struct Candidate {
    BuildRange range;
    Split split;
    float area = 0.0f;
    bool leaf = false;
    bool in_order = false;  // of the fast build: leaves of one cluster
};

using LeafIds = std::array<PrimitiveId, kBvhWidth>;

[[nodiscard]] std::span<PrimitiveId> ids_of(std::span<const BuildRef> refs, LeafIds& ids);
// What fits a leaf is one: it costs no more than a node alone.
[[nodiscard]] bool is_leaf(std::span<const BuildRef> primitives);

// A set of primitives with its cut between bins, and the two sets that the cut leaves.
[[nodiscard]] Candidate examine_bins(std::span<BuildRef> refs, const BuildRange& range, int level,
                                     const ParallelFor& parallel_for);
void cut_bins(std::span<BuildRef> refs, const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left,
              Candidate& right);

// References to all primitives, each in any order the cuts leave.
class QualitySets {
public:
    static constexpr bool kLeavesAhead = false;
    static constexpr std::size_t kPrimitives = 1;  // of one reference

    QualitySets(const Geometry& geometry, const ParallelFor& parallel_for);

    // What stands before the first nodes but the root.
    BvhPart ahead();
    Candidate whole(const ParallelFor& parallel_for);
    void cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right);
    // Those children that are leaves.
    void write_leaves(BvhPart& part, std::size_t node, std::span<const Candidate> children) const;

private:
    const Geometry& geometry_;
    BuildRefs refs_;
};

// Leaves written along a space-filling curve, neighbours of which are gathered in clusters. Cuts go between clusters as in the
// quality build, and inside a cluster between neighbours of the order.
class FastSets {
public:
    static constexpr bool kLeavesAhead = true;
    static constexpr std::size_t kPrimitives = 128;

    FastSets(const Geometry& geometry, const ParallelFor& parallel_for);

    BvhPart ahead();
    Candidate whole(const ParallelFor& parallel_for);
    void cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right);
    void write_leaves(BvhPart& part, std::size_t node, std::span<const Candidate> children) const;

private:
    Candidate examine(BuildRange range, bool in_order, int level, const ParallelFor& parallel_for);

    LeafClusters sets_;
};

}  // namespace glint
