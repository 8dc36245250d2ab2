// How this folder gets threads: from its caller.
#pragma once

#include <cstddef>
#include <functional>

namespace glint {

// Calls task(0) ... task(count - 1), in any order, on any threads, and returns when all are done.
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void serial_for(std::size_t count, const std::function<void(std::size_t)>& task) {
    for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace glint
