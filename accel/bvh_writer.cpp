#include "accel/bvh_writer.h"

#include <algorithm>
#include <stdexcept>

#include "accel/bvh_refs.h"

namespace glint {
namespace {

template <class T>
std::size_t append(BvhTree::Units& units) {
    constexpr std::size_t kSize = sizeof(T) / kBvhUnit;
    const std::size_t at = units.size();
    if (at + kSize > kUnitMask) throw std::length_error("too many primitives for one BVH");
    units.resize(at + kSize);
    return at;
}

void write(TriangleBlock& block, std::span<const PrimitiveId, kBvhWidth> ids, const Geometry& geometry) {
    for (std::size_t lane = 0; lane < kBvhWidth; lane += 4) {
        const std::array<std::uint32_t, 3>* t[4];
        for (std::size_t i = 0; i < 4; ++i) t[i] = &geometry.triangles[index_of(ids[lane + i])];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            __m128 x = load_vertex(geometry.vertices[(*t[0])[corner]]), y = load_vertex(geometry.vertices[(*t[1])[corner]]);
            __m128 z = load_vertex(geometry.vertices[(*t[2])[corner]]), w = load_vertex(geometry.vertices[(*t[3])[corner]]);
            _MM_TRANSPOSE4_PS(x, y, z, w);
            _mm_store_ps(&block.v[3 * corner][lane], x);
            _mm_store_ps(&block.v[3 * corner + 1][lane], y);
            _mm_store_ps(&block.v[3 * corner + 2][lane], z);
        }
    }
}
void write(SphereBlock& block, std::span<const PrimitiveId, kBvhWidth> ids, const Geometry& geometry) {
    for (std::size_t lane = 0; lane < kBvhWidth; ++lane) {
        const Sphere& s = geometry.spheres[index_of(ids[lane])];
        for (int axis = 0; axis < 3; ++axis) block.center[axis][lane] = s.center[axis];
        block.radius[lane] = s.radius;
    }
}
void write(BoxBlock& block, std::span<const PrimitiveId, kBvhWidth> ids, const Geometry& geometry) {
    for (std::size_t lane = 0; lane < kBvhWidth; ++lane) {
        const Box& b = geometry.boxes[index_of(ids[lane])];
        for (int axis = 0; axis < 3; ++axis) block.lo[axis][lane] = b.lo[axis], block.hi[axis][lane] = b.hi[axis];
    }
}
void write(ConeBlock&, std::span<const PrimitiveId, kBvhWidth>, const Geometry&) {}

template <class Block>
std::size_t append_block(BvhTree::Units& units, std::span<const PrimitiveId, kBvhWidth> ids, const Geometry& geometry) {
    const std::size_t unit = append<Block>(units);
    Block& block = *reinterpret_cast<Block*>(units[unit].bytes);
    // What pads a block to whole units must not hang on what the memory was before.
    std::memset(units[unit + sizeof(Block) / kBvhUnit - 1].bytes, 0, kBvhUnit);
    std::ranges::copy(ids, block.id);
    write(block, ids, geometry);
    return unit;
}

// Without branches, which would be guessed wrong: the network of Batcher 1968 for eight.
void sort(std::array<PrimitiveId, kBvhWidth>& ids) {
    constexpr std::array<std::array<unsigned char, 2>, 19> kSwaps{{{0, 1},
                                                                   {2, 3},
                                                                   {4, 5},
                                                                   {6, 7},
                                                                   {0, 2},
                                                                   {1, 3},
                                                                   {4, 6},
                                                                   {5, 7},
                                                                   {1, 2},
                                                                   {5, 6},
                                                                   {0, 4},
                                                                   {1, 5},
                                                                   {2, 6},
                                                                   {3, 7},
                                                                   {2, 4},
                                                                   {3, 5},
                                                                   {1, 2},
                                                                   {3, 4},
                                                                   {5, 6}}};
#pragma GCC unroll 19
    for (const auto& [i, k] : kSwaps) {
        const PrimitiveId low = std::min(ids[i], ids[k]), high = std::max(ids[i], ids[k]);
        ids[i] = low, ids[k] = high;
    }
}

// How many of the keys are greater than each, or equal and before it.
std::array<std::uint32_t, kBvhWidth> ranks(const std::array<float, kBvhWidth>& key) {
    const __m128 low = _mm_loadu_ps(key.data()), high = _mm_loadu_ps(key.data() + 4);
    __m128i low_rank = _mm_setzero_si128(), high_rank = _mm_setzero_si128();
    const __m128i low_lane = _mm_setr_epi32(0, 1, 2, 3), high_lane = _mm_setr_epi32(4, 5, 6, 7);
    for (int i = 0; i < kBvhWidth; ++i) {
        const __m128 k = _mm_set1_ps(key[static_cast<std::size_t>(i)]);
        const __m128i lane = _mm_set1_epi32(i);
        const auto before = [&](__m128 other, __m128i other_lane) {
            const __m128 earlier = _mm_castsi128_ps(_mm_cmplt_epi32(lane, other_lane));
            return _mm_castps_si128(_mm_or_ps(_mm_cmpgt_ps(k, other), _mm_and_ps(_mm_cmpeq_ps(k, other), earlier)));
        };
        low_rank = _mm_sub_epi32(low_rank, before(low, low_lane));
        high_rank = _mm_sub_epi32(high_rank, before(high, high_lane));
    }
    std::array<std::uint32_t, kBvhWidth> rank;
    _mm_storeu_si128(reinterpret_cast<__m128i*>(rank.data()), low_rank);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(rank.data() + 4), high_rank);
    return rank;
}

}  // namespace

std::size_t BvhPart::append_node() {
    const std::size_t unit = append<BvhNode>(units);
    ++nodes;
    return origin + unit;
}

void BvhPart::begin_tree(std::size_t primitives) {
    units.reserve(primitives + primitives / 2 + 64);
    append<BvhNode>(units);
}

BvhRef BvhPart::append_leaf(const Geometry& geometry, std::span<PrimitiveId> ids) {
    ++leaves;
    // Ascending ids make equal trees equal in memory, whatever order the threads left.
    std::array<PrimitiveId, kBvhWidth> all;
    all.fill(~PrimitiveId{0});
    std::ranges::copy(ids, all.begin());
    sort(all);
    std::fill(all.begin() + static_cast<std::ptrdiff_t>(ids.size()), all.end(), all[ids.size() - 1]);
    const PrimitiveKind kind = kind_of(all[0]);
    std::size_t unit = 0;
    switch (kind) {
        case PrimitiveKind::triangle: unit = append_block<TriangleBlock>(units, all, geometry); break;
        case PrimitiveKind::sphere: unit = append_block<SphereBlock>(units, all, geometry); break;
        case PrimitiveKind::box: unit = append_block<BoxBlock>(units, all, geometry); break;
        default: unit = append_block<ConeBlock>(units, all, geometry); break;
    }
    return kLeafBit | static_cast<BvhRef>(kind) << 29 | static_cast<BvhRef>(origin + unit);
}

void BvhPart::count_leaf_extent(const Box4& bounds) {
    alignas(16) float side[4];
    _mm_store_ps(side, _mm_sub_ps(bounds.hi, bounds.lo));
    leaf_sides += static_cast<double>(std::max(side[0], std::max(side[1], side[2])));
}

void BvhPart::move_references(BvhRef by, bool leaves_too) {
    std::vector<BvhRef> stack{0};
    while (!stack.empty()) {
        BvhNode& n = node(stack.back());
        stack.pop_back();
        for (std::size_t i = 0; i < kBvhWidth && n.bounds[0][i] <= n.bounds[1][i]; ++i) {
            const bool leaf = (n.child[i] & kLeafBit) != 0;
            if (!leaf) stack.push_back(n.child[i]);
            if (!leaf || leaves_too) n.child[i] += by;
        }
    }
}

void write_bounds(BvhNode& node, std::span<const Box4> children) {
    std::array<std::array<float, kBvhWidth>, 4> key;  // of octants 0 to 3 (bit 2 clear); the others are their reverses
    for (std::size_t i = 0; i < kBvhWidth; ++i) {
        const Box4 box = i < children.size() ? children[i] : Box4();
        alignas(16) float lo[4], hi[4];
        _mm_store_ps(lo, box.lo);
        _mm_store_ps(hi, box.hi);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            node.bounds[2 * axis][i] = lo[axis];
            node.bounds[2 * axis + 1][i] = hi[axis];
        }
        node.child[i] = node.order[i] = 0;
        const float x = lo[0] + hi[0], y = lo[1] + hi[1], z = lo[2] + hi[2];
        for (std::size_t octant = 0; octant < 4; ++octant) {
            const float k = ((octant & 1u) != 0 ? x : -x) + ((octant & 2u) != 0 ? y : -y) - z;
            key[octant][i] = i < children.size() ? k : -kInfinity;  // absent children stay behind
        }
    }
    for (unsigned octant = 0; octant < 4; ++octant) {
        const auto rank = ranks(key[octant]);
        for (std::uint32_t i = 0; i < kBvhWidth; ++i) {
            const std::size_t reversed = i < children.size() ? children.size() - 1 - rank[i] : i;
            node.order[rank[i]] |= i << (3 * octant);
            node.order[reversed] |= i << (3 * (7 - octant));
        }
    }
}

}  // namespace glint
