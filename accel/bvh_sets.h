// The sets of primitives a tree is made of, from the whole down to the leaves, and how a set is cut in two: what tells the builds
// apart. Knows no nodes. A `Sets` offers: whole(), cut() and gather(). Invariant: what becomes of a set depends on it alone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "accel/bvh_layout.h"
#include "accel/bvh_split.h"

namespace glint {

// Sets below this level are halved by count, which ends within 30 more levels.
constexpr int kSahLevels = 32;

// What a range counts, and how it is cut.
enum class SetKind { clusters, in_order, loose };

// A child to be: a leaf, or a set with the cut that would divide it.
struct Candidate {
    BuildRange range;
    Split split;
    float area = 0.0f;
    std::uint32_t primitives = 0;
    bool leaf = false;
    SetKind kind = SetKind::loose;
};

using LeafIds = std::array<PrimitiveId, kBvhWidth>;

// References to all primitives, each in any order the cuts leave.
class QualitySets {
public:
    QualitySets(const Geometry& geometry, const ParallelFor& parallel_for);

    Candidate whole(const ParallelFor& parallel_for);
    void cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right);
    // The primitives of a leaf.
    std::span<PrimitiveId> gather(const Candidate& leaf, LeafIds& ids) const;

private:
    BuildRefs refs_;
};

// References in the order of a space-filling curve, of which neighbours are gathered in clusters. Cuts go between clusters as
// in the quality build, and inside a cluster between neighbours of the order; members of a crowded cell of the curve are cut as
// in the quality build again.
class FastSets {
public:
    FastSets(const Geometry& geometry, const ParallelFor& parallel_for);

    Candidate whole(const ParallelFor& parallel_for);
    void cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right);
    std::span<PrimitiveId> gather(const Candidate& leaf, LeafIds& ids) const;

private:
    Candidate examine(BuildRange range, SetKind kind, int level, const ParallelFor& parallel_for);

    BuildRefs refs_, clusters_;  // a cluster's id is the number of its first primitive
};

}  // namespace glint
