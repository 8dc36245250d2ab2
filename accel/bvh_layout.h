// What a BVH looks like in memory: nodes and leaf blocks in one array of 64-byte units, addressed by 32-bit references.
// Knows no ray. Plain data and no function of other headers, because the traversal is compiled once per instruction set.
// Invariant: a child's bounds contain the bounds of all primitives below it; a leaf holds up to eight of one kind.
#pragma once

#include <cstddef>
#include <cstdint>

namespace glint {

struct Geometry;

constexpr int kBvhWidth = 8;
constexpr std::size_t kBvhUnit = 64;  // bytes that a reference counts in

// A reference: bit 31 = leaf, bits 29-30 = kind of its primitives (the numbers of PrimitiveKind), below the first unit.
using BvhRef = std::uint32_t;
constexpr BvhRef kLeafBit = 1u << 31;
constexpr BvhRef kUnitMask = (1u << 29) - 1;
constexpr unsigned leaf_kind(BvhRef r) { return (r >> 29) & 3u; }

struct alignas(64) BvhNode {
    float bounds[6][kBvhWidth];  // lo x, hi x, lo y, hi y, lo z, hi z; an absent child has lo = +inf, hi = -inf
    BvhRef child[kBvhWidth];
    // For each of the eight octants of directions, three bits: order[i] >> 3 * octant names the child that is i-th from the
    // far end. Bit k of the octant is set where the direction's component k is not negative.
    std::uint32_t order[kBvhWidth];
};

// Unused lanes repeat the last primitive.
struct alignas(64) TriangleBlock {
    float v[9][kBvhWidth];  // x y z of the first, second and third vertex
    std::uint32_t id[kBvhWidth];
};
struct alignas(64) SphereBlock {
    float center[3][kBvhWidth], radius[kBvhWidth];
    std::uint32_t id[kBvhWidth];
};
struct alignas(64) BoxBlock {
    float lo[3][kBvhWidth], hi[3][kBvhWidth];
    std::uint32_t id[kBvhWidth];
};
struct alignas(64) ConeBlock {
    std::uint32_t id[kBvhWidth];
};

// What a traversal needs to know.
struct BvhView {
    const std::byte* units = nullptr;  // the root node at unit 0; null for an empty tree
    std::size_t bytes = 0;             // of all units
    std::uint64_t tree = 0;            // a number that no other tree has had
    const Geometry* geometry = nullptr;
    float lo[3] = {}, hi[3] = {};  // bounds of everything
    bool only_triangles = false;
    float magnitude = 0.0f;       // the largest absolute coordinate
    float frustum_extent = 0.0f;  // width of a span up to which its frustum alone is worth the most

    // A reference to a node is the number of its unit: no bit above is set.
    [[nodiscard, gnu::always_inline]] const BvhNode& node(BvhRef r) const {
        return *reinterpret_cast<const BvhNode*>(units + std::size_t{r} * kBvhUnit);
    }
    template <class T>
    [[nodiscard, gnu::always_inline]] const T& at(BvhRef r) const {
        return *reinterpret_cast<const T*>(units + (r & kUnitMask) * kBvhUnit);
    }
};

}  // namespace glint
