#include "accel/bvh_curve.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "accel/bvh_refs.h"

namespace glint {
namespace {

constexpr int kBitsPerAxis = 10;
constexpr int kDigitBits = 10;  // of the radix sort: three passes
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
using Table = std::array<std::uint32_t, kDigits>;

// Maps twice a centre to the curve's cell.
struct Curve {
    __m128 lo, scale;

    [[nodiscard]] std::uint32_t code(__m128 center2) const {
        const __m128 top = _mm_set1_ps(static_cast<float>((1 << kBitsPerAxis) - 1));
        const __m128 cell = _mm_min_ps(_mm_max_ps(_mm_mul_ps(_mm_sub_ps(center2, lo), scale), _mm_setzero_ps()), top);
        // Two zeros between the bits of each number, all lanes at once.
        __m128i b = _mm_cvttps_epi32(cell);
        const auto spread = [&](int shift, int mask) {
            b = _mm_and_si128(_mm_or_si128(b, _mm_slli_epi32(b, shift)), _mm_set1_epi32(mask));
        };
        spread(16, 0x030000ff), spread(8, 0x0300f00f), spread(4, 0x030c30c3), spread(2, 0x09249249);
        alignas(16) std::array<std::uint32_t, 4> bits;
        _mm_store_si128(reinterpret_cast<__m128i*>(bits.data()), b);
        return bits[0] << 2 | bits[1] << 1 | bits[2];
    }
};

// Cubic cells over where most centres of a sample are: a few primitives far away must not make the cells of the others coarse.
// What lies outside goes to the cells at the border.
Curve fit_curve(const Geometry& geometry) {
    const std::size_t count = geometry.bounded_count(), step = 1 + count / 8192;
    Box4 box;
    __m128d sum[2]{}, squares[2]{};
    double n = 0.0;
    const auto add = [&](std::size_t, PrimitiveId id) {
        const Box4 bounds = bounds_of(geometry, id);
        const __m128 c = _mm_add_ps(bounds.lo, bounds.hi);
        box.grow(c, c);
        const __m128d halves[2]{_mm_cvtps_pd(c), _mm_cvtps_pd(_mm_movehl_ps(c, c))};
        for (int i = 0; i < 2; ++i) {
            sum[i] = _mm_add_pd(sum[i], halves[i]);
            squares[i] = _mm_add_pd(squares[i], _mm_mul_pd(halves[i], halves[i]));
        }
        n += 1.0;
    };
    for (std::size_t i = 0; i < count; i += step) for_primitives(geometry, i, i + 1, add);
    alignas(16) double s[4], q[4];
    alignas(16) float lo[4], hi[4];
    for (int i = 0; i < 2; ++i) _mm_store_pd(s + 2 * i, sum[i]), _mm_store_pd(q + 2 * i, squares[i]);
    _mm_store_ps(lo, box.lo), _mm_store_ps(hi, box.hi);
    float size = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const double mean = s[axis] / n, deviation = std::sqrt(std::max(0.0, q[axis] / n - mean * mean));
        lo[axis] = std::max(lo[axis], static_cast<float>(mean - 4.0 * deviation));
        hi[axis] = std::min(hi[axis], static_cast<float>(mean + 4.0 * deviation));
        size = std::max(size, hi[axis] - lo[axis]);
    }
    const float scale = static_cast<float>(1 << kBitsPerAxis) / size;
    return {_mm_load_ps(lo), _mm_setr_ps(scale < kInfinity ? scale : 0.0f, scale < kInfinity ? scale : 0.0f,
                                         scale < kInfinity ? scale : 0.0f, 0.0f)};
}

std::size_t digit_of(const CurveKey& key, int shift) { return key.code >> shift & (kDigits - 1); }

}  // namespace

// Least digit first, each chunk counting and moving its own keys.
CurveKeys sort_along_curve(const Geometry& geometry, const ParallelFor& parallel_for) {
    CurveKeys keys(geometry.bounded_count());
    if (keys.empty()) return keys;
    // Few chunks, for each has a table of its own.
    const std::size_t chunks = std::clamp<std::size_t>(keys.size() / kChunk, 1, 16);
    const std::size_t chunk_size = (keys.size() + chunks - 1) / chunks;
    std::vector<Table> tables(chunks);
    const auto chunk_of = [&](const CurveKeys& k, std::size_t i) {
        const std::size_t begin = std::min(i * chunk_size, k.size());
        return std::span(k).subspan(begin, std::min(chunk_size, k.size() - begin));
    };
    const Curve curve = fit_curve(geometry);
    parallel_for(chunks, [&](std::size_t i) {
        tables[i].fill(0);
        const std::size_t begin = std::min(i * chunk_size, keys.size()), end = std::min(begin + chunk_size, keys.size());
        for_primitives(geometry, begin, end, [&](std::size_t at, PrimitiveId id) {
            const Box4 box = bounds_of(geometry, id);
            keys[at] = {curve.code(_mm_add_ps(box.lo, box.hi)), id};
            ++tables[i][digit_of(keys[at], 0)];
        });
    });
    CurveKeys other(keys.size());
    for (int shift = 0; shift < 3 * kBitsPerAxis; shift += kDigitBits) {
        if (shift > 0) {
            parallel_for(chunks, [&](std::size_t i) {
                tables[i].fill(0);
                for (const CurveKey& k : chunk_of(keys, i)) ++tables[i][digit_of(k, shift)];
            });
        }
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < kDigits; ++d) {
            for (Table& table : tables) sum += std::exchange(table[d], sum);
        }
        parallel_for(chunks, [&](std::size_t i) {
            for (const CurveKey& k : chunk_of(keys, i)) other[tables[i][digit_of(k, shift)]++] = k;
        });
        keys.swap(other);
    }
    return keys;
}

void cut_cells(std::span<const CurveKey> keys, CurveCell cell, std::size_t size, std::vector<CurveCell>& cells) {
    const std::uint32_t differ = keys[cell.first].code ^ keys[cell.last - 1].code;
    if (cell.count() <= size || differ == 0) return cells.push_back(cell);
    const std::uint32_t bit = std::bit_floor(differ);
    const auto begin = keys.begin() + cell.first, end = keys.begin() + cell.last;
    const auto middle = static_cast<std::uint32_t>(
        std::partition_point(begin, end, [bit](const CurveKey& k) { return (k.code & bit) == 0; }) - keys.begin());
    cut_cells(keys, {cell.first, middle}, size, cells);
    cut_cells(keys, {middle, cell.last}, size, cells);
}

}  // namespace glint
