// What a grid looks like in memory: levels of cells, lists of blocks, and the blocks of eight primitives that a BVH has too.
// Knows no ray. Plain data and no function of other headers, because the walk is compiled once per instruction set.
// Invariant: a block is listed in every cell that one of its primitives touches when grown by `padding`; a cell says 0, one
// block, a list of them, or a level of its own.
#pragma once

#include "accel/bvh_layout.h"

namespace glint {

using GridCell = std::uint32_t;  // 0: empty; no bit of the two below: the reference of the only block
constexpr GridCell kListBit = 1u << 31;
constexpr GridCell kLevelBit = 1u << 30;  // counts beside kListBit only: a level, else a list of references
constexpr GridCell kIndexMask = kLevelBit - 1;
constexpr BvhRef kLastOfList = 1u << 31;  // in an entry of a list

struct GridLevel {
    float lo[3], size[3], inverse[3];  // lower corner; a cell's sides, and one over them
    std::uint32_t first;               // of its cells, x fastest
    std::uint16_t n[3];
};

// Levels within levels, the outermost included.
constexpr int kMaxGridDepth = 6;

struct GridView {
    BvhView blocks;
    const GridLevel* levels = nullptr;  // the outermost first; null for an empty grid
    const GridCell* cells = nullptr;
    const BvhRef* lists = nullptr;
    const BvhRef* large = nullptr;  // blocks outside the cells, ended as a list is; null for none
    float near_origin = 0.0f;       // `padding` serves rays whose origin has no coordinate beyond this
    double padding = 0.0;
};

}  // namespace glint
