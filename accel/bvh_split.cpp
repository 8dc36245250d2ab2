#include "accel/bvh_split.h"

#include <algorithm>
#include <array>
#include <vector>

#include "accel/bvh_layout.h"

namespace glint {
namespace {

constexpr int kMaxBins = 32;
// Sets larger than this are binned in parallel, in chunks of this size.
constexpr std::uint32_t kChunk = 1u << 16;

struct Bins {
    // By axis and bin; count apart, so that a box is two aligned registers.
    std::array<std::array<Box4, kMaxBins>, 3> boxes;
    std::array<std::array<std::uint32_t, kMaxBins>, 3> counts;

    void clear(int bins) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::fill_n(boxes[axis].begin(), bins, Box4());
            std::fill_n(counts[axis].begin(), bins, 0u);
        }
    }
    void count(std::span<const BuildRef> refs, const Binning& binning) {
        for (const BuildRef& r : refs) {
            const __m128 lo = r.low(), hi = r.high();
            alignas(16) std::array<std::uint32_t, 4> bin;
            _mm_store_si128(reinterpret_cast<__m128i*>(bin.data()), binning(_mm_add_ps(lo, hi)));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                boxes[axis][bin[axis]].grow(lo, hi);
                ++counts[axis][bin[axis]];
            }
        }
    }
    void add(const Bins& other, int bins) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t i = 0; i < static_cast<std::size_t>(bins); ++i) {
                boxes[axis][i].grow(other.boxes[axis][i]);
                counts[axis][i] += other.counts[axis][i];
            }
        }
    }
};

std::span<const BuildRef> members(std::span<const BuildRef> refs, const BuildRange& range) {
    return refs.subspan(range.first, range.count);
}

}  // namespace

Binning::Binning(const BuildRange& range) : lo(range.centers.lo) {
    // Few bins for few primitives: clearing and sweeping them would cost more than the primitives themselves.
    bins = static_cast<int>(std::min<std::uint32_t>(kMaxBins, 4 + range.count));
    const __m128 size = _mm_sub_ps(range.centers.hi, range.centers.lo);
    const __m128 s = _mm_div_ps(_mm_set1_ps(static_cast<float>(bins) * 0.99999f), size);
    // An extent so small that its reciprocal overflows counts as none.
    scale = _mm_and_ps(s, _mm_cmplt_ps(s, _mm_set1_ps(kInfinity)));
}

inline __m128i Binning::operator()(__m128 center2) const { return _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(center2, lo), scale)); }

float leaf_cost(std::uint32_t count, bool small) {
    const float n = static_cast<float>(count);
    if (!small) return n / kBvhWidth;
    return count <= kBvhWidth ? 0.5f + 0.5f * n / kBvhWidth : std::ceil(n / kBvhWidth);
}

Split best_split(std::span<const BuildRef> refs, const BuildRange& range, const ParallelFor& parallel_for) {
    const Binning binning(range);
    const auto bins = static_cast<std::size_t>(binning.bins);
    Bins all;
    all.clear(binning.bins);
    if (range.count <= 2 * kChunk) {
        all.count(members(refs, range), binning);
    } else {
        const std::size_t chunks = (range.count + kChunk - 1) / kChunk;
        std::vector<Bins> part(chunks);
        parallel_for(chunks, [&](std::size_t i) {
            part[i].clear(binning.bins);
            const auto first = static_cast<std::uint32_t>(i) * kChunk;
            part[i].count(refs.subspan(range.first + first, std::min(kChunk, range.count - first)), binning);
        });
        for (const Bins& b : part) all.add(b, binning.bins);
    }
    const bool small = range.count <= 16 * kBvhWidth;
    alignas(16) float scale[4];
    _mm_store_ps(scale, binning.scale);
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(scale[axis] > 0.0f)) continue;
        std::array<float, kMaxBins> right_cost;
        std::array<Box4, kMaxBins> right;
        Box4 box;
        std::uint32_t count = 0;
        for (std::size_t i = bins - 1; i > 0; --i) {
            box.grow(all.boxes[axis][i]);
            count += all.counts[axis][i];
            right[i] = box;
            right_cost[i] = count == 0 ? kInfinity : leaf_cost(count, small) * box.half_area();
        }
        box = Box4();
        count = 0;
        for (std::size_t i = 1; i < bins; ++i) {
            box.grow(all.boxes[axis][i - 1]);
            count += all.counts[axis][i - 1];
            if (count == 0) continue;
            const float cost = leaf_cost(count, small) * box.half_area() + right_cost[i];
            if (cost < best.cost) best = {static_cast<int>(axis), static_cast<int>(i), cost, box, right[i]};
        }
    }
    return best;
}

void partition(std::span<BuildRef> refs, const BuildRange& range, const Split& split, BuildRange& left, BuildRange& right) {
    const Binning binning(range);
    BuildRef* first = refs.data() + range.first;
    BuildRef* last = first + range.count;
    Box4 left_centers, right_centers;
    const auto is_left = [&](const BuildRef& r, Box4& l, Box4& h) {
        alignas(16) std::array<int, 4> bin;
        const __m128 c = r.center2();
        _mm_store_si128(reinterpret_cast<__m128i*>(bin.data()), binning(c));
        const bool yes = bin[static_cast<std::size_t>(split.axis)] < split.bin;
        (yes ? l : h).grow(c, c);
        return yes;
    };
    for (;;) {
        while (first != last && is_left(*first, left_centers, right_centers)) ++first;
        if (first == last) break;
        // *first belongs to the right; look for a partner from the end.
        do {
            --last;
        } while (first != last && !is_left(*last, left_centers, right_centers));
        if (first == last) break;
        std::swap(*first, *last);
        ++first;
    }
    const auto middle = static_cast<std::uint32_t>(first - refs.data());
    left = {range.first, middle - range.first, split.left, left_centers};
    right = {middle, range.first + range.count - middle, split.right, right_centers};
}

void partition_median(std::span<BuildRef> refs, const BuildRange& range, BuildRange& left, BuildRange& right) {
    alignas(16) float size[4];
    _mm_store_ps(size, _mm_sub_ps(range.centers.hi, range.centers.lo));
    const int axis = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
    BuildRef* first = refs.data() + range.first;
    const std::uint32_t half = range.count / 2;
    std::nth_element(first, first + half, first + range.count, [axis](const BuildRef& a, const BuildRef& b) {
        const float ca = a.lo[axis] + a.hi[axis], cb = b.lo[axis] + b.hi[axis];
        return ca != cb ? ca < cb : a.id < b.id;
    });
    left = measure(refs, range.first, half);
    right = measure(refs, range.first + half, range.count - half);
}

bool partition_by_kind(std::span<BuildRef> refs, const BuildRange& range, BuildRange& left, BuildRange& right) {
    BuildRef* first = refs.data() + range.first;
    const PrimitiveKind kind = kind_of(first->id);
    BuildRef* middle = std::partition(first, first + range.count, [kind](const BuildRef& r) { return kind_of(r.id) == kind; });
    const auto count = static_cast<std::uint32_t>(middle - first);
    if (count == range.count) return false;
    left = measure(refs, range.first, count);
    right = measure(refs, range.first + count, range.count - count);
    return true;
}

BuildRange measure(std::span<const BuildRef> refs, std::uint32_t first, std::uint32_t count) {
    BuildRange range{first, count, {}, {}};
    for (const BuildRef& r : refs.subspan(first, count)) {
        range.bounds.grow(r.low(), r.high());
        range.centers.grow(r.center2(), r.center2());
    }
    return range;
}

}  // namespace glint
