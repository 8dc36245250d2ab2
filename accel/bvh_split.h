// Where to cut a set of boxes in two: binned surface area heuristic (Wald 2007, "On fast Construction of SAH-based Bounding
// Volume Hierarchies"), with the cost of a leaf counted in blocks of eight. Knows boxes and ids, no tree. Invariant: the result
// depends on the set alone, not on threads.
#pragma once

#include <emmintrin.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/geometry.h"
#include "accel/huge_pages.h"
#include "accel/parallel.h"

namespace glint {

// x, y, z in the first three lanes.
struct Box4 {
    __m128 lo = _mm_set1_ps(kInfinity), hi = _mm_set1_ps(-kInfinity);

    void grow(__m128 p_lo, __m128 p_hi) {
        lo = _mm_min_ps(lo, p_lo);
        hi = _mm_max_ps(hi, p_hi);
    }
    void grow(const Box4& b) { grow(b.lo, b.hi); }
    // Half the surface area; 0 when empty.
    [[nodiscard]] float half_area() const {
        const __m128 d = _mm_max_ps(_mm_sub_ps(hi, lo), _mm_setzero_ps());
        const __m128 m = _mm_mul_ps(d, _mm_shuffle_ps(d, d, _MM_SHUFFLE(3, 0, 2, 1)));
        return _mm_cvtss_f32(m) + _mm_cvtss_f32(_mm_shuffle_ps(m, m, 1)) + _mm_cvtss_f32(_mm_movehl_ps(m, m));
    }
};

// The bounds of a primitive with its id, or of a cluster of primitives with its number.
struct alignas(16) BuildRef {
    float lo[3];
    PrimitiveId id;
    float hi[3];
    float weight;  // of a cluster, leaves in it; a float, because the bits of a small integer are a subnormal one and slow

    [[nodiscard]] __m128 low() const {
        // Without the id, whose bits are a subnormal float and slow.
        return _mm_and_ps(_mm_load_ps(lo), _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)));
    }
    [[nodiscard]] __m128 high() const { return _mm_load_ps(hi); }
    // Twice the centre.
    [[nodiscard]] __m128 center2() const { return _mm_add_ps(low(), high()); }
};

using BuildRefs = std::vector<BuildRef, HugePageAllocator<BuildRef>>;

// A set of references with what is known of it.
struct BuildRange {
    std::uint32_t first = 0, count = 0;
    Box4 bounds, centers;  // centers: of twice the centres
};

// Large sets are worked on by all threads, in chunks of this size.
constexpr std::uint32_t kChunk = 1u << 14;
inline bool in_chunks(const BuildRange& range) { return range.count > 2 * kChunk; }
inline std::size_t chunks_of(std::size_t count) { return (count + kChunk - 1) / kChunk; }
template <class Ref>
std::span<Ref> chunk(std::span<Ref> refs, const BuildRange& range, std::size_t i) {
    const auto begin = static_cast<std::uint32_t>(i) * kChunk;
    return refs.subspan(range.first + begin, std::min(kChunk, range.count - begin));
}

// Maps a centre to its bin; the same function when counting and when partitioning.
struct Binning {
    __m128 lo, scale;
    int bins;

    explicit Binning(const BuildRange& range);
    // The bins along the three axes in the first three lanes.
    [[nodiscard]] __m128i operator()(__m128 center2) const {
        return _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(center2, lo), scale));
    }
};

struct Split {
    int axis = -1;           // -1: the centres do not differ
    int bin = 0;             // the first bin of the right side
    float cost = kInfinity;  // sum of both sides' expected cost times half area
    Box4 left, right;
};

// Cost of `count` primitives in one leaf or, for more, in the leaves to come; a node visit is 1.
[[nodiscard]] float leaf_cost(std::uint32_t count, bool small);

// The cheapest cut between bins. Clusters count their weights in leaves.
enum class SplitOf { primitives, clusters };
[[nodiscard]] Split best_split(std::span<const BuildRef> refs, const BuildRange& range, SplitOf what,
                               const ParallelFor& parallel_for);
// The cheapest cut of 2 to kMaxSweep primitives or leaves in the order they lie in: axis is 0, bin the size of the left side.
constexpr std::uint32_t kMaxSweep = 160;
enum class SweepOf { primitives, leaves };
[[nodiscard]] Split best_sweep(std::span<const BuildRef> refs, SweepOf what);
// Cuts `range` at `split`; the order within the sides is of no importance.
void partition(std::span<BuildRef> refs, const BuildRange& range, const Split& split, const ParallelFor& parallel_for,
               BuildRange& left, BuildRange& right);
// Halves `range` by the number of its members, along the widest axis of their centres.
void partition_median(std::span<BuildRef> refs, const BuildRange& range, BuildRange& left, BuildRange& right);
// Splits off the members of the first member's kind. Returns false when all are of one kind.
bool partition_by_kind(std::span<BuildRef> refs, const BuildRange& range, BuildRange& left, BuildRange& right);
// Bounds of all, and of refs[first, first + count).
[[nodiscard]] BuildRange measure(std::span<const BuildRef> refs, const ParallelFor& parallel_for);
[[nodiscard]] BuildRange measure(std::span<const BuildRef> refs, std::uint32_t first, std::uint32_t count);

}  // namespace glint
