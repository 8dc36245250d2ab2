#include "accel/bvh_sets.h"

#include <algorithm>

#include "accel/bvh_refs.h"

namespace glint {
namespace {

void cut_range(std::span<BuildRef> refs, const Candidate& c, bool primitives, const ParallelFor& parallel_for, BuildRange& left,
               BuildRange& right) {
    if (c.split.axis >= 0) {
        partition(refs, c.range, c.split, parallel_for, left, right);
    } else if (!primitives || c.range.count > kBvhWidth || !partition_by_kind(refs, c.range, left, right)) {
        partition_median(refs, c.range, left, right);
    }
}

}  // namespace

std::span<PrimitiveId> ids_of(std::span<const BuildRef> refs, LeafIds& ids) {
    for (std::size_t i = 0; i < refs.size(); ++i) ids[i] = refs[i].id;
    return std::span(ids).first(refs.size());
}

bool is_leaf(std::span<const BuildRef> primitives) {
    return primitives.size() <= kBvhWidth &&
           std::ranges::all_of(primitives, [&](const BuildRef& r) { return kind_of(r.id) == kind_of(primitives.front().id); });
}

Candidate examine_bins(std::span<BuildRef> refs, const BuildRange& range, int level, const ParallelFor& parallel_for) {
    Candidate c;
    c.range = range;
    c.area = range.bounds.half_area();
    c.leaf = is_leaf(refs.subspan(range.first, range.count));
    if (!c.leaf && level < kSahLevels) c.split = best_split(refs, range, SplitOf::primitives, parallel_for);
    return c;
}

void cut_bins(std::span<BuildRef> refs, const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left,
              Candidate& right) {
    BuildRange l, r;
    cut_range(refs, c, true, parallel_for, l, r);
    left = examine_bins(refs, l, level, parallel_for);
    right = examine_bins(refs, r, level, parallel_for);
}

QualitySets::QualitySets(const Geometry& geometry, const ParallelFor& parallel_for)
    : geometry_(geometry), refs_(make_refs(geometry, parallel_for)) {}

BvhPart QualitySets::ahead() {
    BvhPart part;
    part.begin_tree(refs_.size());
    return part;
}

Candidate QualitySets::whole(const ParallelFor& parallel_for) {
    return examine_bins(refs_, measure(refs_, parallel_for), 1, parallel_for);
}

void QualitySets::cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right) {
    cut_bins(refs_, c, level, parallel_for, left, right);
}

// Together, so that what they need is on its way while others are written.
void QualitySets::write_leaves(BvhPart& part, std::size_t node, std::span<const Candidate> children) const {
    std::array<LeafIds, kBvhWidth> ids;
    std::array<std::span<PrimitiveId>, kBvhWidth> some;
    for (std::size_t i = 0; i < children.size(); ++i) {
        if (!children[i].leaf) continue;
        some[i] = ids_of(std::span(refs_).subspan(children[i].range.first, children[i].range.count), ids[i]);
        for (const PrimitiveId id : some[i]) fetch_indices(geometry_, id);
    }
    for (std::size_t i = 0; i < children.size(); ++i) {
        for (const PrimitiveId id : some[i]) fetch_vertices(geometry_, id);
    }
    for (std::size_t i = 0; i < children.size(); ++i) {
        if (!children[i].leaf) continue;
        part.count_leaf_extent(children[i].range.bounds);
        const BvhRef leaf = part.append_leaf(geometry_, some[i]);
        part.node(node).child[i] = leaf;
    }
}

FastSets::FastSets(const Geometry& geometry, const ParallelFor& parallel_for) : sets_(write_clusters(geometry, parallel_for)) {}

BvhPart FastSets::ahead() { return std::move(sets_.written); }

Candidate FastSets::whole(const ParallelFor& parallel_for) {
    return examine(measure(sets_.clusters, parallel_for), false, 1, parallel_for);
}

Candidate FastSets::examine(BuildRange range, bool in_order, int level, const ParallelFor& parallel_for) {
    if (!in_order && range.count == 1) {
        const BuildRef& cluster = sets_.clusters[range.first];
        range.first = cluster.id;
        range.count = static_cast<std::uint32_t>(cluster.weight);
        in_order = true;
    }
    Candidate c;
    c.range = range;
    c.in_order = in_order;
    c.area = range.bounds.half_area();
    c.leaf = in_order && range.count == 1;
    if (c.leaf) return c;
    if (in_order) {
        c.split = best_sweep(std::span(sets_.leaves).subspan(range.first, range.count), SweepOf::leaves);
    } else if (level < kSahLevels) {
        c.split = best_split(sets_.clusters, range, SplitOf::clusters, parallel_for);
    }
    return c;
}

void FastSets::cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right) {
    BuildRange l, r;
    if (c.in_order) {
        const auto n = static_cast<std::uint32_t>(c.split.bin);
        l = {c.range.first, n, c.split.left, {}};
        r = {c.range.first + n, c.range.count - n, c.split.right, {}};
    } else {
        cut_range(sets_.clusters, c, false, parallel_for, l, r);
    }
    left = examine(l, c.in_order, level, parallel_for);
    right = examine(r, c.in_order, level, parallel_for);
}

void FastSets::write_leaves(BvhPart& part, std::size_t node, std::span<const Candidate> children) const {
    for (std::size_t i = 0; i < children.size(); ++i) {
        if (children[i].leaf) part.node(node).child[i] = sets_.leaves[children[i].range.first].id;
    }
}

}  // namespace glint
