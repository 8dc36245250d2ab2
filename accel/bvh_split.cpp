#include "accel/bvh_split.h"

#include <algorithm>
#include <array>
#include <vector>

#include "accel/bvh_layout.h"

namespace glint {
namespace {

constexpr std::size_t kMaxBins = 32;

// One bin of each axis; counts apart, so that a box is two aligned registers.
// Left uninitialised, for few bins are used where there are few primitives.
struct RawBox {
    __m128 lo, hi;
    void grow(__m128 p_lo, __m128 p_hi) {
        lo = _mm_min_ps(lo, p_lo);
        hi = _mm_max_ps(hi, p_hi);
    }
};
struct Bins {
    std::array<std::array<RawBox, 3>, kMaxBins> boxes;
    alignas(16) std::array<std::array<std::uint32_t, 4>, kMaxBins> counts;

    void clear(int bins) {
        const RawBox empty{_mm_set1_ps(kInfinity), _mm_set1_ps(-kInfinity)};
        std::fill_n(boxes.begin(), bins, std::array<RawBox, 3>{empty, empty, empty});
        std::fill_n(counts.begin(), bins, std::array<std::uint32_t, 4>());
    }
    template <bool kWeighted>
    void count(std::span<const BuildRef> refs, const Binning& binning) {
        for (const BuildRef& r : refs) {
            const __m128 lo = r.low(), hi = r.high();
            alignas(16) std::array<std::uint32_t, 4> bin;
            _mm_store_si128(reinterpret_cast<__m128i*>(bin.data()), binning(_mm_add_ps(lo, hi)));
            const std::uint32_t weight = kWeighted ? static_cast<std::uint32_t>(r.weight) : 1u;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                boxes[bin[axis]][axis].grow(lo, hi);
                counts[bin[axis]][axis] += weight;
            }
        }
    }
    void add(const Bins& other, int bins) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(bins); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                boxes[i][axis].grow(other.boxes[i][axis].lo, other.boxes[i][axis].hi);
                counts[i][axis] += other.counts[i][axis];
            }
        }
    }
};

__m128 select(__m128 mask, __m128 yes, __m128 no) { return _mm_or_ps(_mm_and_ps(mask, yes), _mm_andnot_ps(mask, no)); }

// What grows along a sweep, for the three axes at once.
struct Side {
    std::array<Box4, 3> box;
    __m128i count = _mm_setzero_si128();

    void grow(const Bins& bins, std::size_t i) {
        for (std::size_t axis = 0; axis < 3; ++axis) box[axis].grow(bins.boxes[i][axis].lo, bins.boxes[i][axis].hi);
        count = _mm_add_epi32(count, _mm_load_si128(reinterpret_cast<const __m128i*>(bins.counts[i].data())));
    }
    // leaf_cost() times half the area, infinite for an empty side.
    [[nodiscard]] __m128 cost(bool small) const {
        __m128 x = _mm_sub_ps(box[0].hi, box[0].lo), y = _mm_sub_ps(box[1].hi, box[1].lo);
        __m128 z = _mm_sub_ps(box[2].hi, box[2].lo), none = _mm_setzero_ps();
        _MM_TRANSPOSE4_PS(x, y, z, none);
        const __m128 area = _mm_add_ps(_mm_add_ps(_mm_mul_ps(x, y), _mm_mul_ps(y, z)), _mm_mul_ps(z, x));
        const __m128 n = _mm_cvtepi32_ps(count);
        __m128 leaf = _mm_mul_ps(n, _mm_set1_ps(1.0f / kBvhWidth));
        if (small) {
            const __m128 blocks = _mm_cvtepi32_ps(_mm_srli_epi32(_mm_add_epi32(count, _mm_set1_epi32(kBvhWidth - 1)), 3));
            const __m128 one = _mm_add_ps(_mm_set1_ps(0.5f), _mm_mul_ps(_mm_set1_ps(0.5f), leaf));
            leaf = select(_mm_cmple_ps(leaf, _mm_set1_ps(1.0f)), one, blocks);
        }
        const __m128 empty = _mm_castsi128_ps(_mm_cmpeq_epi32(count, _mm_setzero_si128()));
        return select(empty, _mm_set1_ps(kInfinity), _mm_mul_ps(leaf, area));
    }
};

}  // namespace

Binning::Binning(const BuildRange& range) : lo(range.centers.lo) {
    // Few bins for few primitives: clearing and sweeping them would cost more than the primitives themselves.
    bins = static_cast<int>(std::min<std::uint32_t>(kMaxBins, 4 + range.count));
    const __m128 size = _mm_sub_ps(range.centers.hi, range.centers.lo);
    const __m128 s = _mm_div_ps(_mm_set1_ps(static_cast<float>(bins) * 0.99999f), size);
    // An extent so small that its reciprocal overflows counts as none.
    scale = _mm_and_ps(s, _mm_cmplt_ps(s, _mm_set1_ps(kInfinity)));
}

float leaf_cost(std::uint32_t count, bool small) {
    const float n = static_cast<float>(count);
    if (!small) return n / kBvhWidth;
    return count <= kBvhWidth ? 0.5f + 0.5f * n / kBvhWidth : static_cast<float>((count + kBvhWidth - 1) / kBvhWidth);
}

Split best_split(std::span<const BuildRef> refs, const BuildRange& range, SplitOf what, const ParallelFor& parallel_for) {
    const Binning binning(range);
    const auto bins = static_cast<std::size_t>(binning.bins);
    const auto count = [&](std::span<const BuildRef> some, Bins& into) {
        into.clear(binning.bins);
        what == SplitOf::primitives ? into.count<false>(some, binning) : into.count<true>(some, binning);
    };
    Bins all;
    if (!in_chunks(range)) {
        count(refs.subspan(range.first, range.count), all);
    } else {
        std::vector<Bins> part(chunks_of(range.count));
        parallel_for(part.size(), [&](std::size_t i) { count(chunk(refs, range, i), part[i]); });
        all.clear(binning.bins);
        for (const Bins& b : part) all.add(b, binning.bins);
    }
    const bool small = what == SplitOf::primitives && range.count <= 16 * kBvhWidth;
    alignas(16) float right_cost[kMaxBins][4];
    Side right, left;
    for (std::size_t i = bins - 1; i > 0; --i) {
        right.grow(all, i);
        _mm_store_ps(right_cost[i], right.cost(small));
    }
    __m128 best_cost = _mm_set1_ps(kInfinity), best_bin = _mm_setzero_ps();
    for (std::size_t i = 1; i < bins; ++i) {
        left.grow(all, i - 1);
        const __m128 cost = _mm_add_ps(left.cost(small), _mm_load_ps(right_cost[i]));
        const __m128 better = _mm_cmplt_ps(cost, best_cost);
        best_cost = _mm_min_ps(cost, best_cost);
        best_bin = select(better, _mm_set1_ps(static_cast<float>(i)), best_bin);
    }
    alignas(16) float scale[4], costs[4], at[4];
    _mm_store_ps(scale, binning.scale), _mm_store_ps(costs, best_cost), _mm_store_ps(at, best_bin);
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(scale[axis] > 0.0f) || !(costs[axis] < best.cost)) continue;
        best = {static_cast<int>(axis), static_cast<int>(at[axis]), costs[axis], {}, {}};
    }
    for (std::size_t i = 0; i < bins && best.axis >= 0; ++i) {
        const RawBox& box = all.boxes[i][static_cast<std::size_t>(best.axis)];
        (static_cast<int>(i) < best.bin ? best.left : best.right).grow(box.lo, box.hi);
    }
    return best;
}

namespace {

// Sizes of boxes that grow along a sweep, for four half areas at a time.
struct SweepSizes {
    alignas(16) std::array<std::array<float, 4>, kMaxSweep + 4> size;

    void set(std::size_t i, __m128 d) { _mm_store_ps(size[i].data(), d); }
    [[nodiscard]] __m128 half_areas(std::size_t i) const {
        __m128 x = _mm_load_ps(size[i].data()), y = _mm_load_ps(size[i + 1].data()), z = _mm_load_ps(size[i + 2].data());
        __m128 other = _mm_load_ps(size[i + 3].data());
        _MM_TRANSPOSE4_PS(x, y, z, other);
        return _mm_add_ps(_mm_add_ps(_mm_mul_ps(x, y), _mm_mul_ps(y, z)), _mm_mul_ps(z, x));
    }
};

// What n members cost, rising for the left side and falling for the right one; behind the last cut nothing is affordable.
struct SweepCosts {
    std::array<float, kMaxSweep + 4> rising, falling;

    explicit SweepCosts(SweepOf what) {
        const auto cost = [&](std::uint32_t n) { return what == SweepOf::leaves ? static_cast<float>(n) : leaf_cost(n, true); };
        falling.fill(kInfinity);
        for (std::uint32_t n = 0; n < kMaxSweep + 4; ++n) rising[n] = cost(n);
        for (std::uint32_t n = 1; n <= kMaxSweep; ++n) falling[kMaxSweep - n] = cost(n);
    }
};

}  // namespace

Split best_sweep(std::span<const BuildRef> refs, SweepOf what) {
    static const SweepCosts kPrimitives(SweepOf::primitives), kLeaves(SweepOf::leaves);
    const SweepCosts& costs = what == SweepOf::leaves ? kLeaves : kPrimitives;
    const std::size_t cuts = refs.size() - 1;
    SweepSizes left, right;  // [i]: of the first i + 1 members, and of the others
    Box4 first, last;
    for (std::size_t i = 0, k = cuts; k > 0; ++i, --k) {
        first.grow(refs[i].low(), refs[i].high());
        last.grow(refs[k].low(), refs[k].high());
        left.set(i, _mm_sub_ps(first.hi, first.lo));
        right.set(k - 1, _mm_sub_ps(last.hi, last.lo));
    }
    for (std::size_t i = 0; i < 3; ++i) left.set(cuts + i, _mm_setzero_ps()), right.set(cuts + i, _mm_setzero_ps());
    __m128 best_cost = _mm_set1_ps(kInfinity), best_at = _mm_setzero_ps(), at = _mm_setr_ps(0.0f, 1.0f, 2.0f, 3.0f);
    const float* falling = &costs.falling[kMaxSweep - cuts];
    for (std::size_t i = 0; i < cuts; i += 4) {
        const __m128 cost = _mm_add_ps(_mm_mul_ps(_mm_loadu_ps(&costs.rising[i + 1]), left.half_areas(i)),
                                       _mm_mul_ps(_mm_loadu_ps(falling + i), right.half_areas(i)));
        best_at = select(_mm_cmplt_ps(cost, best_cost), at, best_at);
        best_cost = _mm_min_ps(cost, best_cost);
        at = _mm_add_ps(at, _mm_set1_ps(4.0f));
    }
    alignas(16) std::array<float, 4> cost, index;
    _mm_store_ps(cost.data(), best_cost), _mm_store_ps(index.data(), best_at);
    std::size_t lane = 0;
    for (std::size_t i = 1; i < 4; ++i) {
        if (cost[i] < cost[lane] || (cost[i] == cost[lane] && cost[i] < kInfinity && index[i] < index[lane])) lane = i;
    }
    Split best{0, static_cast<int>(index[lane]) + 1, cost[lane], {}, {}};
    const auto cut = static_cast<std::size_t>(best.bin);
    for (const BuildRef& r : refs.first(cut)) best.left.grow(r.low(), r.high());
    for (const BuildRef& r : refs.subspan(cut)) best.right.grow(r.low(), r.high());
    return best;
}

}  // namespace glint
