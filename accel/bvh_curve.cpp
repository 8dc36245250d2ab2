#include "accel/bvh_curve.h"

#include <algorithm>
#include <array>
#include <bit>

#include "accel/bvh_refs.h"

namespace glint {
namespace {

constexpr int kBitsPerAxis = 10;
constexpr int kDigitBits = 10;  // of the radix sort: three passes
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
// Ranges of the curve that one task gathers.
constexpr std::size_t kGatherSize = 1u << 13;
// Clusters' sizes are floats, which count no further than 2^24.
constexpr std::size_t kMaxCluster = 1u << 23;
constexpr std::size_t kClusterSize = 40;

struct Key {
    std::uint32_t code;
    PrimitiveId id;
};
using Keys = std::vector<Key, HugePageAllocator<Key>>;

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

// Sorts by code, equal ones by id: least digit first, each chunk counting and moving its own keys.
void sort(Keys& keys, const ParallelFor& parallel_for) {
    Keys other(keys.size());
    // Few chunks, for each has a table of its own.
    const std::size_t chunks = std::clamp<std::size_t>(keys.size() / kChunk, 1, 16);
    const std::size_t chunk_size = (keys.size() + chunks - 1) / chunks;
    std::vector<std::array<std::uint32_t, kDigits>> tables(chunks);
    const auto chunk_of = [&](const Keys& k, std::size_t i) {
        const std::size_t begin = std::min(i * chunk_size, k.size());
        return std::span(k).subspan(begin, std::min(chunk_size, k.size() - begin));
    };
    for (int shift = 0; shift < 3 * kBitsPerAxis; shift += kDigitBits) {
        const auto digit = [shift](const Key& k) { return k.code >> shift & (kDigits - 1); };
        parallel_for(chunks, [&](std::size_t i) {
            tables[i].fill(0);
            for (const Key& k : chunk_of(keys, i)) ++tables[i][digit(k)];
        });
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < kDigits; ++d) {
            for (auto& table : tables) sum += std::exchange(table[d], sum);
        }
        parallel_for(chunks, [&](std::size_t i) {
            for (const Key& k : chunk_of(keys, i)) other[tables[i][digit(k)]++] = k;
        });
        keys.swap(other);
    }
}

struct Cell {
    std::uint32_t first, last;
};

// Cuts where the highest bit that differs changes, until `size` is not exceeded or all codes agree.
void cut_cells(std::span<const Key> keys, Cell cell, std::size_t size, std::vector<Cell>& cells) {
    const std::uint32_t differ = keys[cell.first].code ^ keys[cell.last - 1].code;
    const std::size_t count = cell.last - cell.first;
    if (count <= size || (differ == 0 && count <= kMaxCluster)) return cells.push_back(cell);
    std::uint32_t middle = cell.first + static_cast<std::uint32_t>(count / 2);
    if (differ != 0) {
        const std::uint32_t bit = std::bit_floor(differ);
        const auto begin = keys.begin() + cell.first, end = keys.begin() + cell.last;
        middle = static_cast<std::uint32_t>(
            std::partition_point(begin, end, [bit](const Key& k) { return (k.code & bit) == 0; }) - keys.begin());
    }
    cut_cells(keys, {cell.first, middle}, size, cells);
    cut_cells(keys, {middle, cell.last}, size, cells);
}

// The references of a cell's members and of its clusters.
void gather(const Geometry& geometry, std::span<const Key> keys, Cell cell, BuildRefs& refs, BuildRefs& clusters) {
    std::vector<Cell> cells;
    cut_cells(keys, cell, kClusterSize, cells);
    clusters.reserve(cells.size());
    for (const Cell& c : cells) {
        Box4 box;
        for (std::uint32_t i = c.first; i < c.last; ++i) {
            fetch_indices(geometry, keys[std::min<std::size_t>(i + 32, keys.size() - 1)].id);
            fetch_vertices(geometry, keys[std::min<std::size_t>(i + 16, keys.size() - 1)].id);
            const Box4 bounds = bounds_of(geometry, keys[i].id);
            refs[i] = make_ref(bounds, keys[i].id, 1.0f);
            box.grow(bounds);
        }
        clusters.push_back(make_ref(box, c.first, static_cast<float>(c.last - c.first)));
    }
}

}  // namespace

void cluster_along_curve(const Geometry& geometry, const ParallelFor& parallel_for, BuildRefs& refs, BuildRefs& clusters) {
    Keys keys(geometry.bounded_count());
    if (keys.empty()) return;
    const Curve curve = fit_curve(geometry);
    parallel_for(chunks_of(keys.size()), [&](std::size_t i) {
        for_primitives(geometry, i * kChunk, (i + 1) * kChunk, [&](std::size_t at, PrimitiveId id) {
            const Box4 box = bounds_of(geometry, id);
            keys[at] = {curve.code(_mm_add_ps(box.lo, box.hi)), id};
        });
    });
    sort(keys, parallel_for);
    refs.resize(keys.size());
    std::vector<Cell> cells;
    cut_cells(keys, {0, static_cast<std::uint32_t>(keys.size())}, kGatherSize, cells);
    std::vector<BuildRefs> parts(cells.size());
    parallel_for(cells.size(), [&](std::size_t i) { gather(geometry, keys, cells[i], refs, parts[i]); });
    for (BuildRefs& part : parts) {
        clusters.insert(clusters.end(), part.begin(), part.end());
        part = BuildRefs();
    }
}

}  // namespace glint
