// Ways to run a loop, none of which may leave a trace in what is built, and how much of a block is written.
// Knows no accelerator.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "accel/bvh_layout.h"
#include "tests/accel/random.h"

namespace glint {

// Every loop in another order: back to front, then at random.
inline void shuffled_for(std::size_t count, const std::function<void(std::size_t)>& task) {
    std::vector<std::size_t> order(count);
    std::iota(order.rbegin(), order.rend(), std::size_t{0});
    Random random(count);
    for (std::size_t i = 0; count > 2 && i < count; ++i)
        std::swap(order[i],
                  order[std::min(count - 1, static_cast<std::size_t>(random.uniform(0.0f, static_cast<float>(count))))]);
    for (const std::size_t i : order) task(i);
}

inline void on_four_threads(std::size_t count, const std::function<void(std::size_t)>& task) {
    std::atomic<std::size_t> next{0};
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            for (std::size_t i = next++; i < count; i = next++) task(i);
        });
    }
}

// Bytes of a block that are written, and those that it takes.
inline std::pair<std::size_t, std::size_t> block_bytes(PrimitiveKind kind) {
    switch (kind) {
        case PrimitiveKind::triangle: return {offsetof(TriangleBlock, id) + sizeof(TriangleBlock::id), sizeof(TriangleBlock)};
        case PrimitiveKind::sphere: return {offsetof(SphereBlock, id) + sizeof(SphereBlock::id), sizeof(SphereBlock)};
        case PrimitiveKind::box: return {offsetof(BoxBlock, id) + sizeof(BoxBlock::id), sizeof(BoxBlock)};
        default: return {offsetof(ConeBlock, id) + sizeof(ConeBlock::id), sizeof(ConeBlock)};
    }
}

}  // namespace glint
