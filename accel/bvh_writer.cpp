#include "accel/bvh_writer.h"

#include <algorithm>
#include <stdexcept>

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

// x, y, z and something finite, without reading behind the last vertex.
__m128 load(const glm::vec3& v) {
    const __m128 xy = _mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(&v.x)));
    return _mm_movelh_ps(xy, _mm_load_ss(&v.z));
}

void write(TriangleBlock& block, std::span<const PrimitiveId, kBvhWidth> ids, const Geometry& geometry) {
    for (std::size_t lane = 0; lane < kBvhWidth; lane += 4) {
        const std::array<std::uint32_t, 3>* t[4];
        for (std::size_t i = 0; i < 4; ++i) t[i] = &geometry.triangles[index_of(ids[lane + i])];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            __m128 x = load(geometry.vertices[(*t[0])[corner]]), y = load(geometry.vertices[(*t[1])[corner]]);
            __m128 z = load(geometry.vertices[(*t[2])[corner]]), w = load(geometry.vertices[(*t[3])[corner]]);
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
    std::ranges::copy(ids, block.id);
    write(block, ids, geometry);
    return unit;
}

// The numbers 0 to 7 in the order of descending keys, the first one first at equal keys; sorting by insertion.
using Order = std::array<std::uint32_t, kBvhWidth>;
Order descending(const std::array<float, kBvhWidth>& key, std::size_t n) {
    Order order{0, 1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = 1; i < n; ++i) {
        for (std::size_t k = i; k > 0 && key[order[k]] > key[order[k - 1]]; --k) std::swap(order[k], order[k - 1]);
    }
    return order;
}

}  // namespace

std::size_t BvhPart::append_node() {
    const std::size_t unit = append<BvhNode>(units);
    ++nodes;
    return unit;
}

BvhRef BvhPart::append_leaf(const Geometry& geometry, std::span<PrimitiveId> ids) {
    ++leaves;
    // Ascending ids make equal trees equal in memory, whatever order the threads left.
    for (std::size_t i = 1; i < ids.size(); ++i) {
        for (std::size_t k = i; k > 0 && ids[k] < ids[k - 1]; --k) std::swap(ids[k], ids[k - 1]);
    }
    std::array<PrimitiveId, kBvhWidth> all;
    for (std::size_t i = 0; i < kBvhWidth; ++i) all[i] = ids[std::min(i, ids.size() - 1)];
    const PrimitiveKind kind = kind_of(all[0]);
    std::size_t unit = 0;
    switch (kind) {
        case PrimitiveKind::triangle: unit = append_block<TriangleBlock>(units, all, geometry); break;
        case PrimitiveKind::sphere: unit = append_block<SphereBlock>(units, all, geometry); break;
        case PrimitiveKind::box: unit = append_block<BoxBlock>(units, all, geometry); break;
        default: unit = append_block<ConeBlock>(units, all, geometry); break;
    }
    return kLeafBit | static_cast<BvhRef>(kind) << 29 | static_cast<BvhRef>(unit);
}

void BvhPart::move_references(BvhRef by) {
    std::vector<BvhRef> stack{0};
    while (!stack.empty()) {
        BvhNode& n = node(stack.back());
        stack.pop_back();
        for (std::size_t i = 0; i < kBvhWidth && n.bounds[0][i] <= n.bounds[1][i]; ++i) {
            if ((n.child[i] & kLeafBit) == 0) stack.push_back(n.child[i]);
            n.child[i] += by;
        }
    }
}

void write_bounds(BvhNode& node, std::span<const Box4> children) {
    std::array<std::array<float, kBvhWidth>, 4> key{};  // of octants 0 to 3 (bit 2 clear); the others are their reverses
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
        for (std::size_t octant = 0; octant < 4 && i < children.size(); ++octant) {
            const float x = lo[0] + hi[0], y = lo[1] + hi[1], z = lo[2] + hi[2];
            key[octant][i] = ((octant & 1u) != 0 ? x : -x) + ((octant & 2u) != 0 ? y : -y) - z;
        }
    }
    for (unsigned octant = 0; octant < 4; ++octant) {
        const Order far_first = descending(key[octant], children.size());
        for (std::size_t i = 0; i < kBvhWidth; ++i) {
            const std::size_t reversed = i < children.size() ? children.size() - 1 - i : i;
            node.order[i] |= far_first[i] << (3 * octant);
            node.order[i] |= far_first[reversed] << (3 * (7 - octant));
        }
    }
}

}  // namespace glint
