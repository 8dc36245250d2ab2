// Walks a tree as it lies in memory, and checks what every one must be: each primitive in one leaf, boxes exactly around what
// lies below, the children's order far first. Knows no builder.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "accel/bvh.h"

namespace glint {

inline Aabb box_of(const BvhNode& node, int k) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) box.lo[axis] = node.bounds[2 * axis][k], box.hi[axis] = node.bounds[2 * axis + 1][k];
    return box;
}
inline bool absent(const BvhNode& node, int k) { return box_of(node, k).empty(); }
inline bool is_leaf(BvhRef ref) { return (ref & kLeafBit) != 0; }
inline bool contains(const Aabb& outer, const Aabb& inner) {
    return glm::all(glm::lessThanEqual(outer.lo, inner.lo)) && glm::all(glm::greaterThanEqual(outer.hi, inner.hi));
}
inline bool equal(const Aabb& a, const Aabb& b) { return a.lo == b.lo && a.hi == b.hi; }

// What lies in a leaf, each primitive once.
inline std::vector<PrimitiveId> members(const BvhView& bvh, BvhRef leaf) {
    const std::uint32_t* id = nullptr;
    switch (static_cast<PrimitiveKind>(leaf_kind(leaf))) {
        case PrimitiveKind::triangle: id = bvh.at<TriangleBlock>(leaf).id; break;
        case PrimitiveKind::sphere: id = bvh.at<SphereBlock>(leaf).id; break;
        case PrimitiveKind::box: id = bvh.at<BoxBlock>(leaf).id; break;
        default: id = bvh.at<ConeBlock>(leaf).id; break;
    }
    std::vector<PrimitiveId> ids(id, id + kBvhWidth);
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    return ids;
}

// Half a node visit, and half for what fills the block.
inline double block_cost(std::size_t count) { return 0.5 + 0.5 * static_cast<double>(count) / kBvhWidth; }

// Walks a tree and notes what breaks its invariants.
struct Survey {
    const Geometry& geometry;
    BvhView bvh;
    std::vector<PrimitiveId> ids;
    std::size_t loose_boxes = 0, nodes = 0, leaves = 0, mixed_leaves = 0, bad_orders = 0;
    int levels = 0;
    double cost = 0.0;  // surface area heuristic: visits of nodes and blocks by a random ray, times the root's area

    Survey(const Geometry& g, const BvhTree& t) : geometry(g), bvh(t.view(g)) {
        if (!t.units.empty()) visit(0, 1);
        std::sort(ids.begin(), ids.end());
    }

    // The bounds of everything below.
    Aabb visit(BvhRef index, int level) {
        levels = std::max(levels, level);
        ++nodes;
        const BvhNode& node = bvh.at<BvhNode>(index);
        Aabb all;
        for (int k = 0; k < kBvhWidth; ++k) {
            const Aabb box = box_of(node, k);
            if (absent(node, k)) continue;
            const Aabb below = is_leaf(node.child[k]) ? leaf(node.child[k]) : visit(node.child[k], level + 1);
            loose_boxes += equal(box, below) ? 0 : 1;
            const double visit_cost = is_leaf(node.child[k]) ? block_cost(members(bvh, node.child[k]).size()) : 1.0;
            cost += static_cast<double>(box.half_area()) * visit_cost;
            all.grow(below);
        }
        for (unsigned octant = 0; octant < 8; ++octant) bad_orders += is_far_first(node, octant) ? 0 : 1;
        return all;
    }
    Aabb leaf(BvhRef ref) {
        ++leaves;
        Aabb all;
        for (const PrimitiveId id : members(bvh, ref)) {
            ids.push_back(id);
            mixed_leaves += static_cast<unsigned>(kind_of(id)) == leaf_kind(ref) ? 0 : 1;
            all.grow(geometry.bounds(id));
        }
        return all;
    }
    // Whether the order is a permutation in which no child's centre comes before that of a nearer one.
    static bool is_far_first(const BvhNode& node, unsigned octant) {
        unsigned seen = 0;
        double last = static_cast<double>(kInfinity);
        for (const std::uint32_t order : node.order) {
            const int k = static_cast<int>(order >> (3 * octant) & 7u);
            seen |= 1u << k;
            if (absent(node, k)) continue;
            const glm::dvec3 c = glm::dvec3(box_of(node, k).lo) + glm::dvec3(box_of(node, k).hi);
            double distance = 0.0;
            for (int axis = 0; axis < 3; ++axis) distance += (octant >> axis & 1u) != 0 ? c[axis] : -c[axis];
            if (distance > last + 1e-5 * (std::abs(c.x) + std::abs(c.y) + std::abs(c.z))) return false;
            last = distance;
        }
        return seen == 0xffu;
    }
};

inline void expect_sound(const Geometry& geometry, const BvhTree& tree) {
    const Survey survey(geometry, tree);
    EXPECT_EQ(survey.ids, geometry.bounded_ids()) << "every id exactly once";
    EXPECT_LE(tree.depth, kMaxBvhDepth);
    EXPECT_EQ(survey.nodes, tree.nodes);
    EXPECT_EQ(survey.leaves, tree.leaves);
    EXPECT_EQ(survey.loose_boxes, 0u) << "a child's box is not the bounds of what lies below";
    EXPECT_EQ(survey.mixed_leaves, 0u);
    EXPECT_EQ(survey.bad_orders, 0u);
    EXPECT_LE(survey.levels, tree.depth);
}

}  // namespace glint
