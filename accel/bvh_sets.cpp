#include "accel/bvh_sets.h"

#include <algorithm>

#include "accel/bvh_curve.h"
#include "accel/bvh_refs.h"

namespace glint {
namespace {

bool of_one_kind(std::span<const PrimitiveId> ids) {
    return std::ranges::all_of(ids, [&](PrimitiveId id) { return kind_of(id) == kind_of(ids.front()); });
}

std::span<PrimitiveId> ids_of(std::span<const BuildRef> refs, LeafIds& ids) {
    for (std::size_t i = 0; i < refs.size(); ++i) ids[i] = refs[i].id;
    return std::span(ids).first(refs.size());
}

// A set of primitives with its cut between bins. What fits a leaf is one: it costs no more than a node alone.
Candidate examine_bins(std::span<BuildRef> refs, const BuildRange& range, int level, const ParallelFor& parallel_for) {
    Candidate c;
    c.range = range;
    c.area = range.bounds.half_area();
    c.primitives = range.count;
    LeafIds ids;
    c.leaf = range.count <= kBvhWidth && of_one_kind(ids_of(refs.subspan(range.first, range.count), ids));
    if (!c.leaf && level < kSahLevels) c.split = best_split(refs, range, range.count, parallel_for);
    return c;
}

void cut_bins(std::span<BuildRef> refs, const Candidate& c, const ParallelFor& parallel_for, BuildRange& left,
              BuildRange& right) {
    if (c.split.axis >= 0) {
        partition(refs, c.range, c.split, parallel_for, left, right);
    } else if (c.kind == SetKind::clusters || c.range.count > kBvhWidth || !partition_by_kind(refs, c.range, left, right)) {
        partition_median(refs, c.range, left, right);
    }
}

}  // namespace

QualitySets::QualitySets(const Geometry& geometry, const ParallelFor& parallel_for) : refs_(make_refs(geometry, parallel_for)) {}

Candidate QualitySets::whole(const ParallelFor& parallel_for) {
    return examine_bins(refs_, measure(refs_, parallel_for), 1, parallel_for);
}

void QualitySets::cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right) {
    BuildRange l, r;
    cut_bins(refs_, c, parallel_for, l, r);
    left = examine_bins(refs_, l, level, parallel_for);
    right = examine_bins(refs_, r, level, parallel_for);
}

std::span<PrimitiveId> QualitySets::gather(const Candidate& leaf, LeafIds& ids) const {
    return ids_of(std::span(refs_).subspan(leaf.range.first, leaf.range.count), ids);
}

FastSets::FastSets(const Geometry& geometry, const ParallelFor& parallel_for) {
    cluster_along_curve(geometry, parallel_for, refs_, clusters_);
}

Candidate FastSets::whole(const ParallelFor& parallel_for) {
    return examine(measure(clusters_, parallel_for), SetKind::clusters, 1, parallel_for);
}

Candidate FastSets::examine(BuildRange range, SetKind kind, int level, const ParallelFor& parallel_for) {
    if (kind == SetKind::clusters && range.count == 1) {
        const BuildRef& cluster = clusters_[range.first];
        range.first = cluster.id;
        range.count = static_cast<std::uint32_t>(cluster.weight);
        kind = range.count <= kMaxSweep ? SetKind::in_order : SetKind::loose;
        if (kind == SetKind::loose) range = measure(refs_, range.first, range.count);
    }
    if (kind == SetKind::loose) return examine_bins(refs_, range, level, parallel_for);
    Candidate c;
    c.range = range;
    c.kind = kind;
    c.area = range.bounds.half_area();
    c.primitives = range.count;
    if (kind == SetKind::clusters) {
        c.primitives = 0;
        for (const BuildRef& cluster : std::span(clusters_).subspan(range.first, range.count)) {
            const auto size = static_cast<std::uint32_t>(cluster.weight);
            c.primitives += size;
            // Its members are wanted soon, and the last one first.
            if (range.count <= 3 && size <= kMaxSweep) {
                const BuildRef* members = refs_.data() + cluster.id;
                for (std::uint32_t i = 0; i < size; i += 2) _mm_prefetch(members + (size - 1 - i), _MM_HINT_T0);
            }
        }
    }
    LeafIds ids;
    c.leaf = c.primitives <= kBvhWidth && of_one_kind(gather(c, ids));
    if (c.leaf) return c;
    if (kind == SetKind::in_order) {
        c.split = best_sweep(refs_, range.first, range.count);
    } else if (level < kSahLevels) {
        c.split = best_split(clusters_, range, c.primitives, parallel_for);
    }
    return c;
}

void FastSets::cut(const Candidate& c, int level, const ParallelFor& parallel_for, Candidate& left, Candidate& right) {
    BuildRange l, r;
    if (c.kind == SetKind::in_order) {
        const auto n = static_cast<std::uint32_t>(c.split.bin);
        l = {c.range.first, n, c.split.left, {}};
        r = {c.range.first + n, c.range.count - n, c.split.right, {}};
    } else {
        cut_bins(c.kind == SetKind::clusters ? clusters_ : refs_, c, parallel_for, l, r);
    }
    left = examine(l, c.kind, level, parallel_for);
    right = examine(r, c.kind, level, parallel_for);
}

std::span<PrimitiveId> FastSets::gather(const Candidate& leaf, LeafIds& ids) const {
    const std::span<const BuildRef> refs(refs_);
    if (leaf.kind != SetKind::clusters) return ids_of(refs.subspan(leaf.range.first, leaf.range.count), ids);
    std::size_t n = 0;
    for (const BuildRef& cluster : std::span(clusters_).subspan(leaf.range.first, leaf.range.count)) {
        for (const BuildRef& r : refs.subspan(cluster.id, static_cast<std::size_t>(cluster.weight))) ids[n++] = r.id;
    }
    return std::span(ids).first(n);
}

}  // namespace glint
