// Which tile is visited next: previews first, then every tile in turn, the least sampled at the front.
// Knows no picture and no thread. Not synchronised: its owner locks.
// Invariant: samples never decrease from front to back by more than a visit, so a tile whose worker was held up goes first
// until it has caught up. In turn with the others it would lag for good, and no pass would be complete in all tiles.
#pragma once

#include <cstddef>
#include <deque>

namespace glint {

struct TileTask {
    std::size_t tile = 0;
    bool preview = false;
    int samples = 0;  // per pixel, that the tile has
};

class TileQueue {
public:
    // Starts over with tiles 0 … tiles-1, none of which has a sample.
    void deal(std::size_t tiles, bool previews) {
        tasks_.clear();
        for (std::size_t i = 0; previews && i < tiles; ++i) tasks_.push_back({i, true, 0});
        for (std::size_t i = 0; i < tiles; ++i) tasks_.push_back({i, false, 0});
    }
    void clear() { tasks_.clear(); }
    [[nodiscard]] bool empty() const { return tasks_.empty(); }
    [[nodiscard]] std::size_t size() const { return tasks_.size(); }

    [[nodiscard]] TileTask take() {
        const TileTask task = tasks_.front();
        tasks_.pop_front();
        return task;
    }
    void give_back(const TileTask& task) {
        if (!tasks_.empty() && tasks_.front().samples > task.samples)
            tasks_.push_front(task);
        else
            tasks_.push_back(task);
    }

private:
    std::deque<TileTask> tasks_;
};

}  // namespace glint
