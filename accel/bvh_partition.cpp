#include <algorithm>
#include <array>
#include <vector>

#include "accel/bvh_split.h"

namespace glint {
namespace {

__m128 all_ones() { return _mm_castsi128_ps(_mm_set1_epi32(-1)); }

// One pass of a partition: what went to the left, and the bounds of the centres of both sides.
struct Cut {
    std::uint32_t left = 0;
    Box4 left_centers, right_centers;
};

// Up to this many references are moved by way of a buffer, without a branch on where they go: one in two would be guessed wrong.
constexpr std::size_t kBuffered = 1024;

// Keeps the order of both sides.
Cut partition_buffered(std::span<BuildRef> some, const Binning& binning, const Split& split) {
    std::array<BuildRef, kBuffered> right;
    Cut cut;
    alignas(16) float lo[4], scale[4];
    _mm_store_ps(lo, binning.lo), _mm_store_ps(scale, binning.scale);
    const auto axis = static_cast<std::size_t>(split.axis);
    std::size_t l = 0, r = 0;
    for (const BuildRef& ref : some) {
        const __m128 low = _mm_load_ps(ref.lo), high = _mm_load_ps(ref.hi), c = ref.center2();
        const int bin = _mm_cvttss_si32(_mm_set_ss((ref.lo[axis] + ref.hi[axis] - lo[axis]) * scale[axis]));
        const bool is_left = bin < split.bin;
        // A centre of the other side becomes NaN, which minimum and maximum leave out when it is their first operand.
        const __m128 other = _mm_castsi128_ps(_mm_set1_epi32(is_left ? -1 : 0));
        const __m128 of_right = _mm_or_ps(c, other), of_left = _mm_or_ps(c, _mm_xor_ps(other, all_ones()));
        cut.left_centers.lo = _mm_min_ps(of_left, cut.left_centers.lo),
        cut.left_centers.hi = _mm_max_ps(of_left, cut.left_centers.hi);
        cut.right_centers.lo = _mm_min_ps(of_right, cut.right_centers.lo);
        cut.right_centers.hi = _mm_max_ps(of_right, cut.right_centers.hi);
        _mm_store_ps(some[l].lo, low), _mm_store_ps(some[l].hi, high);
        _mm_store_ps(right[r].lo, low), _mm_store_ps(right[r].hi, high);
        l += is_left, r += !is_left;
    }
    std::copy_n(right.begin(), r, some.begin() + static_cast<std::ptrdiff_t>(l));
    cut.left = static_cast<std::uint32_t>(l);
    return cut;
}

Cut partition_some(std::span<BuildRef> some, const Binning& binning, const Split& split) {
    if (some.size() <= kBuffered) return partition_buffered(some, binning, split);
    Cut cut;
    BuildRef* first = some.data();
    BuildRef* last = first + some.size();
    const auto is_left = [&](const BuildRef& r) {
        alignas(16) std::array<int, 4> bin;
        const __m128 c = r.center2();
        _mm_store_si128(reinterpret_cast<__m128i*>(bin.data()), binning(c));
        const bool yes = bin[static_cast<std::size_t>(split.axis)] < split.bin;
        (yes ? cut.left_centers : cut.right_centers).grow(c, c);
        return yes;
    };
    for (;;) {
        while (first != last && is_left(*first)) ++first;
        if (first == last) break;
        // *first belongs to the right; look for a partner from the end.
        do {
            --last;
        } while (first != last && !is_left(*last));
        if (first == last) break;
        std::swap(*first, *last);
        ++first;
    }
    cut.left = static_cast<std::uint32_t>(first - some.data());
    return cut;
}

// Chunks cut by themselves leave left members behind the middle and as many right ones before it: swaps them, piece by piece.
void exchange(std::span<BuildRef> all, std::span<const Cut> cuts, std::uint32_t middle, const ParallelFor& parallel_for) {
    struct Piece {
        std::uint32_t first, count;
    };
    std::vector<Piece> rights, lefts;  // out of place
    const auto size = static_cast<std::uint32_t>(all.size());
    for (std::uint32_t i = 0; i < cuts.size(); ++i) {
        const std::uint32_t begin = i * kChunk, end = std::min(begin + kChunk, size), cut = begin + cuts[i].left;
        if (cut < std::min(end, middle)) rights.push_back({cut, std::min(end, middle) - cut});
        if (std::max(begin, middle) < cut) lefts.push_back({std::max(begin, middle), cut - std::max(begin, middle)});
    }
    std::vector<std::array<std::uint32_t, 3>> swaps;
    for (std::size_t r = 0, l = 0; r < rights.size() && l < lefts.size();) {
        const std::uint32_t n = std::min({rights[r].count, lefts[l].count, kChunk / 4});
        swaps.push_back({rights[r].first, lefts[l].first, n});
        rights[r].first += n, lefts[l].first += n;
        if ((rights[r].count -= n) == 0) ++r;
        if ((lefts[l].count -= n) == 0) ++l;
    }
    parallel_for(swaps.size(), [&](std::size_t i) {
        std::swap_ranges(all.data() + swaps[i][0], all.data() + swaps[i][0] + swaps[i][2], all.data() + swaps[i][1]);
    });
}

}  // namespace

void partition(std::span<BuildRef> refs, const BuildRange& range, const Split& split, const ParallelFor& parallel_for,
               BuildRange& left, BuildRange& right) {
    const Binning binning(range);
    Cut all;
    if (!in_chunks(range)) {
        all = partition_some(refs.subspan(range.first, range.count), binning, split);
    } else {
        std::vector<Cut> cuts(chunks_of(range.count));
        parallel_for(cuts.size(), [&](std::size_t i) { cuts[i] = partition_some(chunk(refs, range, i), binning, split); });
        for (const Cut& cut : cuts) {
            all.left += cut.left;
            all.left_centers.grow(cut.left_centers);
            all.right_centers.grow(cut.right_centers);
        }
        exchange(refs.subspan(range.first, range.count), cuts, all.left, parallel_for);
    }
    left = {range.first, all.left, split.left, all.left_centers};
    right = {range.first + all.left, range.count - all.left, split.right, all.right_centers};
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

BuildRange measure(std::span<const BuildRef> refs, const ParallelFor& parallel_for) {
    std::vector<BuildRange> parts(chunks_of(refs.size()));
    const auto size = static_cast<std::uint32_t>(refs.size());
    parallel_for(parts.size(), [&](std::size_t i) {
        const auto begin = static_cast<std::uint32_t>(i) * kChunk;
        parts[i] = measure(refs, begin, std::min(kChunk, size - begin));
    });
    BuildRange all{0, size, {}, {}};
    for (const BuildRange& part : parts) {
        all.bounds.grow(part.bounds);
        all.centers.grow(part.centers);
    }
    return all;
}

}  // namespace glint
