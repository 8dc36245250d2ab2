// The accumulated picture: per pixel double sums of radiance, kept in tiles, each tile stamped with the generation it
// belongs to. Knows no renderer or thread. Not synchronised: its owner locks.
// Invariant: a tile whose stamp is not the asked generation counts as empty, so nothing is ever cleared.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/adaptive.h"
#include "core/image.h"

namespace glint {

constexpr int kTileSize = 16;     // pixels a side
constexpr int kPreviewBlock = 8;  // pixels a side that share one ray of the coarse preview

struct PixelSum {
    glm::dvec3 radiance{0.0};
    glm::vec3 before{0.0f};      // the mean at the last power of two
    glm::vec3 change{0.0f};      // to it from the one before
    std::uint32_t taken = 0;     // samples
    std::uint32_t rejected = 0;  // of them left out of the sums because they were not finite

    [[nodiscard]] glm::dvec3 mean() const {
        return taken > rejected ? radiance / static_cast<double>(taken - rejected) : glm::dvec3(0.0);
    }
    // The next sample, unless it is null, which stands for one that is rejected. Notes what each doubling changes.
    void add(const glm::vec3* sample, Doublings& doublings) {
        if (sample != nullptr)
            radiance += glm::dvec3(*sample);
        else
            ++rejected;
        ++taken;
        // Not std::has_single_bit(), which calls a function where the processor is not known to count bits.
        if ((taken & (taken - 1)) == 0) note_doubling(doublings);
    }

private:
    void note_doubling(Doublings& doublings) {
        const glm::vec3 now(mean()), last = now - before;
        const glm::dvec3 squared = glm::dvec3(last) * glm::dvec3(last);
        const auto k = static_cast<std::size_t>(std::countr_zero(taken));
        if (k > 0) doublings[k - 1].fresh.add(relative_change(last, now, kHiddenFresh * squared));
        if (k > 1) doublings[k - 2].settled.add(relative_change(change, now, kHiddenSettled * squared));
        before = now;
        change = last;
    }
};

// So many sums of nothing.
void set_to_zero(std::vector<PixelSum>& sums, std::size_t pixels);

struct TileRect {
    int x0, y0, x1, y1;  // in the whole picture, upper bounds excluded
    bool operator==(const TileRect&) const = default;
    [[nodiscard]] std::size_t pixels() const { return static_cast<std::size_t>(x1 - x0) * static_cast<std::size_t>(y1 - y0); }
};

class Framebuffer {
public:
    // Covers [x0,x1) x [y0,y1) of the picture. keep_passes: each tile also remembers its sums before the last batch, so
    // that resolve_pass() can answer (twice the memory).
    explicit Framebuffer(TileRect area, bool keep_passes = false);

    [[nodiscard]] TileRect area() const { return area_; }
    [[nodiscard]] std::size_t tile_count() const { return tiles_.size(); }
    [[nodiscard]] TileRect tile_rect(std::size_t tile) const { return tiles_[tile].rect; }

    // Samples each pixel of the tile has in `generation`.
    [[nodiscard]] int samples(std::size_t tile, std::uint64_t generation) const;
    // The tile's sums, row by row; zeros when it has none of this generation.
    void copy_out(std::size_t tile, std::uint64_t generation, std::vector<PixelSum>& sums) const;
    // Takes the sums, and leaves a vector without meaning whose memory can be used again. doublings: those between the samples
    // that the tile had and `samples`; work: RayCounts::work() for them.
    void write_back(std::size_t tile, std::uint64_t generation, std::vector<PixelSum>& sums, int samples,
                    const Doublings& doublings = {}, std::uint64_t work = 0);
    // One colour per preview block of the tile, row by row.
    void write_preview(std::size_t tile, std::uint64_t generation, const std::vector<glm::vec3>& blocks);

    // Sets the tile's pixels of an image that covers area(): means, or previews where there are no samples yet; leaves
    // them alone where there is neither.
    void resolve(std::size_t tile, std::uint64_t generation, Image& image) const;
    // Sets the image to the last pass that every tile has completed, so that each pixel has the same number of samples.
    // Returns that number; 0, and the image untouched, when there is none.
    [[nodiscard]] int resolve_pass(std::uint64_t generation, Image& image) const;
    // The tiles' doublings, summed in order; `samples` is how many each pixel has at least.
    [[nodiscard]] Doublings doublings(std::uint64_t generation, int samples) const;
    // What adaptive sampling goes by, and the tiles apart by the powers of two that their samples have reached.
    [[nodiscard]] std::vector<TileState> states(std::uint64_t generation) const;
    [[nodiscard]] std::vector<Stratum> strata(std::uint64_t generation) const;

private:
    struct Tile {
        TileRect rect;
        std::uint64_t generation = 0, preview_generation = 0;
        int samples = 0, previous_samples = 0;
        std::vector<PixelSum> sums, previous;  // previous: before the last batch
        std::vector<Doubling> doublings;
        std::uint64_t work = 0;
        std::vector<glm::vec3> preview;
    };
    TileRect area_;
    bool keep_passes_;
    std::vector<Tile> tiles_;
};

// Blocks per row of a tile's preview.
[[nodiscard]] inline int preview_blocks(int pixels) { return (pixels + kPreviewBlock - 1) / kPreviewBlock; }

}  // namespace glint
