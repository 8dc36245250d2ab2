// The rays still to be followed of many samples at once: one stack a sample, all in one pool of nodes.
// Knows no surface and no light. Invariant: between two make_room() no node moves and nothing is allocated, so references
// to branches stay valid while children are pushed; depth is bounded by memory alone.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/dimension.h"
#include "core/medium_stack.h"

namespace glint {

// A ray still to be followed; it ends nowhere.
struct Branch {
    glm::vec3 origin, direction;
    glm::vec3 throughput{1.0f};
    std::uint32_t path = kCameraPath;  // names this node of the ray tree; random dimensions hang on it
    int bounces = 0;
    std::uint32_t below = 0;  // the next node of the same stack, or of the free ones
};

class BranchStacks {
public:
    static constexpr std::uint32_t kEmpty = 0xffffffffu;  // the top of a stack without branches

    // Forgets all stacks; the pool keeps its size.
    void clear() {
        if (used_ == 0) return;
        used_ = 0;
        free_ = kEmpty;
        link(0);
    }
    // Lets `n` branches be pushed.
    void make_room(std::size_t n) {
        const std::size_t old = branches_.size();
        if (old - used_ >= n) return;
        branches_.resize(std::max(used_ + n, 2 * old));
        media_.resize(branches_.size());
        link(old);
    }
    // Puts a branch onto the stack whose top is `top` and makes it the top; everything but `below` is still to be filled in.
    // Filled in here, field by field: copied from elsewhere right after it was written, a branch would wait for the processor's
    // store buffer.
    [[nodiscard]] Branch& push(std::uint32_t& top) {
        const std::uint32_t node = free_;
        Branch& branch = branches_[node];
        free_ = branch.below;
        branch.below = top;
        top = node;
        ++used_;
        return branch;
    }
    // Gives a node that is on no stack any more back.
    void release(std::uint32_t node) {
        branches_[node].below = free_;
        free_ = node;
        --used_;
    }
    [[nodiscard]] const Branch& operator[](std::uint32_t node) const { return branches_[node]; }
    // What the branch travels in; kept apart, since only glass looks at it. Whoever pushes and looks, sets it.
    [[nodiscard]] MediumStack& medium(std::uint32_t node) { return media_[node]; }

private:
    // Makes the nodes from `first` on free; the first of them is taken first.
    void link(std::size_t first) {
        for (std::size_t i = branches_.size(); i > first; --i) {
            branches_[i - 1].below = free_;
            free_ = static_cast<std::uint32_t>(i - 1);
        }
    }

    std::vector<Branch> branches_;
    std::vector<MediumStack> media_;
    std::uint32_t free_ = kEmpty;
    std::size_t used_ = 0;
};

}  // namespace glint
