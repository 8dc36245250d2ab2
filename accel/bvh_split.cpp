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

Split best_split(std::span<const BuildRef> refs, const BuildRange& range, std::uint32_t primitives,
                 const ParallelFor& parallel_for) {
    const Binning binning(range);
    const auto bins = static_cast<std::size_t>(binning.bins);
    const auto count = [&](std::span<const BuildRef> some, Bins& into) {
        into.clear(binning.bins);
        primitives == range.count ? into.count<false>(some, binning) : into.count<true>(some, binning);
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
    const bool small = primitives <= 16 * kBvhWidth;
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

Split best_sweep(std::span<const BuildRef> refs, std::uint32_t first, std::uint32_t count) {
    static const std::array<float, kMaxSweep> kLeafCost = [] {
        std::array<float, kMaxSweep> cost;
        for (std::uint32_t i = 0; i < kMaxSweep; ++i) cost[i] = leaf_cost(i, true);
        return cost;
    }();
    alignas(16) float right[kMaxSweep][8];  // the box of refs[i] to the last, and its cost where a lane is free
    Box4 box;
    const BuildRef* r = refs.data() + first;
    for (std::uint32_t i = count - 1; i > 0; --i) {
        box.grow(r[i].low(), r[i].high());
        _mm_store_ps(right[i], box.lo), _mm_store_ps(right[i] + 4, box.hi);
        right[i][3] = kLeafCost[count - i] * box.half_area();
    }
    Split best;
    box = Box4();
    for (std::uint32_t i = 1; i < count; ++i) {
        box.grow(r[i - 1].low(), r[i - 1].high());
        const float cost = kLeafCost[i] * box.half_area() + right[i][3];
        if (cost < best.cost || best.axis < 0) best = {0, static_cast<int>(i), cost, box, {}};
    }
    best.right = {_mm_load_ps(right[best.bin]), _mm_load_ps(right[best.bin] + 4)};
    return best;
}

}  // namespace glint
