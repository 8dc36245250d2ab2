#include "accel/grid_order.h"

#include <algorithm>
#include <array>
#include <span>

#include "accel/bvh_layout.h"

namespace glint {
namespace {

constexpr std::size_t kWidth = kBvhWidth;
// Ranges of this size are ordered by one task to the end; items that one task looks at.
constexpr std::size_t kTask = 16384;
// Smaller ranges are left to the library; a pivot of larger ones comes from so many of them.
constexpr std::size_t kSmall = 48, kSample = 32;

struct Item {
    std::array<float, 3> center;
    std::uint32_t index;  // of the primitive, before
};

struct Before {
    std::size_t axis;
    bool operator()(const Item& a, const Item& b) const {
        const float x = a.center[axis], y = b.center[axis];
        // Without a branch: whether a centre is below the median is anyone's guess.
        return (static_cast<int>(x < y) | (static_cast<int>(x == y) & static_cast<int>(a.index < b.index))) != 0;
    }
};

// Puts what is before `pivot` to the front and returns its number (Lomuto's scheme without a branch).
std::size_t partition_at(std::span<Item> items, const Item& pivot, Before before) {
    std::size_t front = 0;
    for (Item& item : items) {
        const Item moved = item;
        item = items[front];
        items[front] = moved;
        front += before(moved, pivot) ? 1 : 0;
    }
    return front;
}

// As std::nth_element with k: pivots of a sample, a little off towards the larger side, so that the rest of the search is small
// (Floyd & Rivest 1975, "Expected time bounds for selection").
void select(std::span<Item> items, std::size_t k, Before before) {
    for (int passes = 0; items.size() > kSmall && passes < 40; ++passes) {
        std::array<Item, kSample> sample;
        for (std::size_t i = 0; i < kSample; ++i) sample[i] = items[i * items.size() / kSample];
        constexpr std::size_t kHalf = kSample / 2;
        const std::size_t rank = k * kSample / items.size();
        const std::size_t at = rank < kHalf ? std::min(kHalf, rank + 3) : std::max(kHalf, rank - 3);
        std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(at), sample.end(), before);
        const std::size_t front = partition_at(items, sample[at], before);
        if (k < front) {
            items = items.first(front);
        } else {
            items = items.subspan(front);
            k -= front;
        }
    }
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(k), items.end(), before);
}

// Where the upper half begins.
std::size_t split(std::span<Item> items, OrderRange r) {
    std::array<float, 3> lo, hi;
    lo.fill(kInfinity);
    hi.fill(-kInfinity);
    for (std::size_t i = r.begin; i < r.end; ++i) {
        for (std::size_t a = 0; a < 3; ++a) {
            lo[a] = std::min(lo[a], items[i].center[a]);
            hi[a] = std::max(hi[a], items[i].center[a]);
        }
    }
    const float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    const std::size_t axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
    const std::size_t blocks = (r.end - r.begin + kWidth - 1) / kWidth;
    const std::size_t half = blocks / 2 * kWidth;
    select(items.subspan(r.begin, r.end - r.begin), half, {axis});
    return r.begin + half;
}

void order(std::span<Item> items, OrderRange r) {
    if (r.end - r.begin <= kWidth) return;
    const std::size_t middle = split(items, r);
    order(items, {r.begin, middle});
    order(items, {middle, r.end});
}

}  // namespace

void order_by_neighbours(std::vector<BoundedPrimitive>& primitives, std::vector<OrderRange> ranges,
                         const ParallelFor& parallel_for) {
    const std::size_t n = primitives.size(), chunks = (n + kTask - 1) / kTask;
    std::vector<Item> items(n);
    parallel_for(chunks, [&](std::size_t t) {
        for (std::size_t i = t * kTask; i < std::min(n, (t + 1) * kTask); ++i) {
            const glm::vec3 c = primitives[i].bounds.center();
            items[i] = {{c.x, c.y, c.z}, static_cast<std::uint32_t>(i)};
        }
    });
    // Level by level, the ranges of a level side by side, until each is a task of its own.
    std::vector<OrderRange> tasks;
    while (!ranges.empty()) {
        std::erase_if(ranges, [&](const OrderRange& r) {
            const bool done = r.end - r.begin <= kTask;
            if (done) tasks.push_back(r);
            return done;
        });
        std::vector<OrderRange> halves(2 * ranges.size());
        parallel_for(ranges.size(), [&](std::size_t i) {
            const std::size_t middle = split(items, ranges[i]);
            halves[2 * i] = {ranges[i].begin, middle};
            halves[2 * i + 1] = {middle, ranges[i].end};
        });
        ranges = std::move(halves);
    }
    parallel_for(tasks.size(), [&](std::size_t t) { order(items, tasks[t]); });
    std::vector<BoundedPrimitive> ordered(n);
    parallel_for(chunks, [&](std::size_t t) {
        for (std::size_t i = t * kTask; i < std::min(n, (t + 1) * kTask); ++i) ordered[i] = primitives[items[i].index];
    });
    primitives = std::move(ordered);
}

}  // namespace glint
