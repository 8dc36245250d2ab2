#include "core/tile_queue.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

namespace glint {
namespace {

TEST(TileQueue, PreviewsComeFirst) {
    TileQueue queue;
    queue.deal(2, true);
    EXPECT_EQ(queue.size(), 4u);
    EXPECT_TRUE(queue.take().preview);
    EXPECT_TRUE(queue.take().preview);
    EXPECT_FALSE(queue.take().preview);
}

// Two workers, one of them stopped by the system for many passes: afterwards all tiles are within one visit again.
TEST(TileQueue, AHeldUpTileCatchesUp) {
    constexpr int kVisit = 8;
    TileQueue queue;
    queue.deal(25, false);
    std::array<int, 25> samples{};
    const auto visit = [&](TileTask task) {
        task.samples += kVisit;
        samples[task.tile] = task.samples;
        queue.give_back(task);
    };
    const TileTask held = queue.take();
    for (int i = 0; i < 24 * 10; ++i) visit(queue.take());
    visit(held);
    for (int i = 0; i < 24; ++i) visit(queue.take());
    const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
    EXPECT_LE(*most - *least, kVisit);
}

}  // namespace
}  // namespace glint
