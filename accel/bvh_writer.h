// Writes nodes and leaves as bvh_layout.h has them, one behind the other. Knows no heuristic.
// Invariant: equal calls leave equal bytes. Sizes in units of kBvhUnit bytes.
#pragma once

#include <array>
#include <cstring>
#include <span>

#include "accel/bvh.h"
#include "accel/bvh_split.h"

namespace glint {

// A piece of a tree; its references count from `origin`, that of its first unit.
struct BvhPart {
    BvhTree::Units units;
    std::size_t origin = 0;
    std::size_t nodes = 0, leaves = 0;
    int depth = 0;
    double leaf_sides = 0.0;  // the leaves' widest sides, summed, for BvhTree::leaf_extent

    BvhNode& node(std::size_t unit) { return *reinterpret_cast<BvhNode*>(units[unit - origin].bytes); }
    // Throws std::length_error where references end.
    std::size_t append_node();
    // For a whole tree: reserves what usually suffices (too much costs addresses, as pages never written are never there) and
    // makes room for the root, which is written and counted later.
    void begin_tree(std::size_t primitives);
    // A leaf of 1 to kBvhWidth primitives of one kind, in any order.
    BvhRef append_leaf(const Geometry& geometry, std::span<PrimitiveId> ids);
    void count_leaf_extent(const Box4& bounds);
    // Adds to the references of the nodes written, which then count from another first unit; to those to leaves if told so.
    void move_references(BvhRef by, bool leaves_too);
    void clear() { units.clear(), nodes = leaves = 0, depth = 0, leaf_sides = 0.0; }
};

// The children's bounds and their order for each octant; the children themselves are left 0.
void write_bounds(BvhNode& node, std::span<const Box4> children);

}  // namespace glint
