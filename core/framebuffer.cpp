#include "core/framebuffer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace glint {
namespace {

// Rejected samples count as never taken.
glm::vec3 mean(const PixelSum& sum, int samples) {
    const double n = samples - static_cast<double>(sum.rejected);
    return n > 0.0 ? glm::vec3(sum.radiance / n) : glm::vec3(0.0f);
}

}  // namespace

Framebuffer::Framebuffer(TileRect area, bool keep_passes) : area_(area), keep_passes_(keep_passes) {
    for (int y = area.y0; y < area.y1; y += kTileSize) {
        for (int x = area.x0; x < area.x1; x += kTileSize) {
            Tile tile;
            tile.rect = {x, y, std::min(x + kTileSize, area.x1), std::min(y + kTileSize, area.y1)};
            tiles_.push_back(std::move(tile));
        }
    }
}

int Framebuffer::samples(std::size_t tile, std::uint64_t generation) const {
    return tiles_[tile].generation == generation ? tiles_[tile].samples : 0;
}

// Not by assign(): a tile's memory has mostly left the caches, and whole lines are faster written than read and written.
void set_to_zero(std::vector<PixelSum>& sums, std::size_t pixels) {
    static_assert(std::is_trivially_copyable_v<PixelSum>, "zeros are zero bits");
    sums.resize(pixels);
    std::memset(static_cast<void*>(sums.data()), 0, pixels * sizeof(PixelSum));
}

void Framebuffer::copy_out(std::size_t tile, std::uint64_t generation, std::vector<PixelSum>& sums) const {
    const Tile& t = tiles_[tile];
    if (t.generation == generation)
        sums = t.sums;
    else
        set_to_zero(sums, t.rect.pixels());
}

void Framebuffer::write_back(std::size_t tile, std::uint64_t generation, std::vector<PixelSum>& sums, int samples,
                             const Doublings& doublings, std::uint64_t work) {
    Tile& t = tiles_[tile];
    if (t.generation != generation) t.doublings.clear(), t.work = 0;
    t.work += work;
    t.doublings.resize(doublings_within(samples));
    for (std::size_t k = 0; k < t.doublings.size(); ++k) t.doublings[k] += doublings[k];
    if (keep_passes_) {
        t.previous_samples = t.generation == generation ? t.samples : 0;
        t.previous.swap(t.sums);
    }
    t.sums.swap(sums);
    t.samples = samples;
    t.generation = generation;
}

void Framebuffer::write_preview(std::size_t tile, std::uint64_t generation, const std::vector<glm::vec3>& blocks) {
    tiles_[tile].preview = blocks;
    tiles_[tile].preview_generation = generation;
}

void Framebuffer::resolve(std::size_t tile, std::uint64_t generation, Image& image) const {
    const Tile& t = tiles_[tile];
    const bool sampled = t.generation == generation && t.samples > 0;
    const bool previewed = t.preview_generation == generation && !t.preview.empty();
    if (!sampled && !previewed) return;
    const int blocks = preview_blocks(t.rect.x1 - t.rect.x0);
    std::size_t i = 0;
    for (int y = t.rect.y0; y < t.rect.y1; ++y) {
        for (int x = t.rect.x0; x < t.rect.x1; ++x, ++i) {
            const auto block =
                static_cast<std::size_t>((y - t.rect.y0) / kPreviewBlock * blocks + (x - t.rect.x0) / kPreviewBlock);
            image.at(x - area_.x0, y - area_.y0) = sampled ? mean(t.sums[i], t.samples) : t.preview[block];
        }
    }
}

int Framebuffer::resolve_pass(std::uint64_t generation, Image& image) const {
    int pass = tiles_.empty() ? 0 : samples(0, generation);
    for (std::size_t i = 1; i < tiles_.size(); ++i) pass = std::min(pass, samples(i, generation));
    // Tiles are visited in turn, so none is more than a batch ahead of the slowest, but for a tile that takes as long as
    // all others together.
    for (const Tile& t : tiles_) {
        if (pass == 0 || (t.samples != pass && t.previous_samples != pass)) return 0;
    }
    image = {area_.x1 - area_.x0, area_.y1 - area_.y0, std::vector<glm::vec3>(area_.pixels())};
    for (const Tile& t : tiles_) {
        const std::vector<PixelSum>& sums = t.samples == pass ? t.sums : t.previous;
        std::size_t i = 0;
        for (int y = t.rect.y0; y < t.rect.y1; ++y) {
            for (int x = t.rect.x0; x < t.rect.x1; ++x) image.at(x - area_.x0, y - area_.y0) = mean(sums[i++], pass);
        }
    }
    return pass;
}

Doublings Framebuffer::doublings(std::uint64_t generation, int samples) const {
    Doublings sum{};
    for (const Tile& t : tiles_) {
        if (t.generation != generation) continue;
        const std::size_t n = std::min(t.doublings.size(), doublings_within(samples));
        for (std::size_t k = 0; k < n; ++k) sum[k] += t.doublings[k];
    }
    return sum;
}

std::vector<TileState> Framebuffer::states(std::uint64_t generation) const {
    std::vector<TileState> states;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
        const Tile& t = tiles_[i];
        TileState s{samples(i, generation), t.rect.pixels()};
        if (t.generation == generation) {
            const std::size_t n = t.doublings.size();
            if (n > 0) s.change = t.doublings[n - 1].fresh.sum;
            if (n > 1) s.change_before = t.doublings[n - 2].fresh.sum;
            s.work = t.work;
        }
        states.push_back(s);
    }
    return states;
}

std::vector<Stratum> Framebuffer::strata(std::uint64_t generation) const {
    std::vector<Stratum> strata;
    for (std::size_t i = 0; i < tiles_.size(); ++i) {
        const std::size_t known = doublings_within(samples(i, generation));
        if (known >= strata.size()) strata.resize(known + 1);
        Stratum& s = strata[known];
        s.spp = 1 << known;
        s.pixels += tiles_[i].rect.pixels();
        for (std::size_t k = 0; k < known; ++k) s.doublings[k] += tiles_[i].doublings[k];
    }
    std::erase_if(strata, [](const Stratum& s) { return s.pixels == 0; });
    return strata;
}

}  // namespace glint
