#include "core/tile_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

namespace glint {
namespace {

Sampler pixel_sampler(const KernelInput& in, int x, int y) {
    return {in.plan.sampler, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, in.plan.seed};
}

bool finite(glm::vec3 c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

struct Job {
    const KernelInput& in;
    TileRect rect;
    int first, last;
    std::vector<PixelSum>* sums;  // null for a preview
    std::vector<glm::vec3>* preview;
    Workspace& work;
};

// Every second bit of a number, the lowest first, closed up.
constexpr unsigned even_bits(unsigned m) {
    unsigned x = 0;
    for (unsigned bit = 0; m >> (2 * bit) != 0; ++bit) x |= ((m >> (2 * bit)) & 1u) << bit;
    return x;
}

struct Cell {
    std::uint8_t x, y;
};
// One tile's.
constexpr std::array<Cell, kTileSize* kTileSize> kZCurve = [] {
    std::array<Cell, kTileSize * kTileSize> cells{};
    for (unsigned m = 0; m < cells.size(); ++m) {
        cells[m] = {static_cast<std::uint8_t>(even_bits(m)), static_cast<std::uint8_t>(even_bits(m >> 1))};
    }
    return cells;
}();

// Calls visit(x, y) for each cell of a width x height grid along the Z curve (Morton 1966): any 4^n cells in a row from a
// multiple of 4^n on are a square, whose rays go about the same way.
template <class Visit>
void along_z_curve(int width, int height, Visit&& visit) {
    const unsigned side = std::bit_ceil(static_cast<unsigned>(std::max({1, width, height})));
    constexpr unsigned kCells = kZCurve.size();
    const unsigned tiles = (side * side + kCells - 1) / kCells;
    for (unsigned tile = 0; tile < tiles; ++tile) {
        const int left = kTileSize * static_cast<int>(even_bits(tile)), top = kTileSize * static_cast<int>(even_bits(tile >> 1));
        for (const Cell cell : std::span(kZCurve).first(std::min(kCells, side * side))) {
            const int x = left + cell.x, y = top + cell.y;
            if (x < width && y < height) visit(x, y);
        }
    }
}

// Gathers samples into batches, traces them, and hands the answers to take(cell, its radiances in a row) in the order they came
// in.
template <class A, unsigned kParts, class Take>
class Batcher {
public:
    Batcher(const Job& job, Take take)
        : in_(job.in), work_(job.work), integrator_(in_.scene, std::get<A>(in_.accelerator), in_.plan, job.work), take_(take) {
        if (job.work.prepared_for == in_.generation) return;
        integrator_.prepare();
        job.work.prepared_for = in_.generation;
    }

    // Samples [first, last) of a pixel.
    void add(std::size_t cell, int x, int y, int first, int last) {
        const std::uint32_t pixel = random_ ? pixel_sampler(in_, x, y).pixel() : 0;
        if (last - first == 1) {
            // Without the calls that a row of samples is worth.
            cells_[count_] = static_cast<std::uint32_t>(cell);
            x_[count_] = static_cast<float>(x);
            y_[count_] = static_cast<float>(y);
            work_.lanes.pixel[count_] = pixel;
            work_.lanes.index[count_] = static_cast<std::uint32_t>(first);
            if (++count_ == kRayBatch) flush();
            return;
        }
        for (int k = first; k < last && !stopped_;) {
            const auto n = std::min(static_cast<std::size_t>(last - k), kRayBatch - count_);
            std::fill_n(cells_ + count_, n, static_cast<std::uint32_t>(cell));
            std::fill_n(x_ + count_, n, static_cast<float>(x));
            std::fill_n(y_ + count_, n, static_cast<float>(y));
            std::fill_n(work_.lanes.pixel + count_, n, pixel);
            std::iota(work_.lanes.index + count_, work_.lanes.index + count_ + n, static_cast<std::uint32_t>(k));
            count_ += n;
            k += static_cast<int>(n);
            if (count_ == kRayBatch) flush();
        }
    }
    // Traces what has been gathered. False when the frame is not wanted any more.
    bool flush() {
        set_rays();
        const auto stale = [this] { return in_.current_generation.load(std::memory_order_relaxed) != in_.generation; };
        stopped_ = stopped_ || !integrator_.radiance(radiance_, stale);
        for (std::size_t i = 0; i < count_ && !stopped_;) {
            const std::size_t first = i;
            while (i < count_ && cells_[i] == cells_[first]) ++i;
            take_(cells_[first], std::span<const glm::vec3>(radiance_).subspan(first, i - first));
        }
        count_ = 0;
        return !stopped_;
    }

private:
    // The camera rays, at the positions that the samplers (or the pixels' centres) give.
    void set_rays() {
        const Lanes& lanes = work_.lanes;
        const auto squares = [&](std::uint32_t dimension) {
            Sampler::squares(in_.plan.sampler, lanes.pixel, lanes.index, dimension, count_, u_[0], u_[1]);
        };
        if (in_.plan.jitter) {
            squares(dimension::pixel);
        } else {
            for (auto& row : u_) std::fill_n(row, count_, 0.5f);
        }
        for (std::size_t i = 0; i < count_; ++i) {
            x_[i] += u_[0][i];
            y_[i] += u_[1][i];
        }
        if (!in_.camera.has_lens()) return in_.camera.pinhole_rays(x_, y_, count_, work_.rays);
        squares(dimension::lens);
        work_.rays.clear(RayOrder::coherent);
        for (std::size_t i = 0; i < count_; ++i) {
            Ray ray = in_.camera.ray(x_[i], y_[i], disk_from_square({u_[0][i], u_[1][i]}));
            ray.t_max = kInfinity;
            work_.rays.push(ray);
        }
    }

    const KernelInput& in_;
    Workspace& work_;
    Integrator<A, kParts> integrator_;
    Take take_;
    const bool random_ = in_.plan.stochastic();  // or nobody asks for a random number
    bool stopped_ = false;
    std::size_t count_ = 0;
    std::uint32_t cells_[kRayBatch];
    alignas(64) float x_[kRayBatch], y_[kRayBatch], u_[2][kRayBatch];
    std::array<glm::vec3, kRayBatch> radiance_;
};

template <class A, unsigned kParts>
bool run_preview(const Job& job) {
    const auto take = [&](std::size_t cell, std::span<const glm::vec3> light) {
        (*job.preview)[cell] = finite(light[0]) ? light[0] : glm::vec3(0.0f);
    };
    Batcher<A, kParts, decltype(take)> batcher(job, take);
    const TileRect& r = job.rect;
    const int columns = preview_blocks(r.x1 - r.x0), rows = preview_blocks(r.y1 - r.y0);
    along_z_curve(columns, rows, [&](int i, int j) {
        const int x = std::min(r.x0 + i * kPreviewBlock + kPreviewBlock / 2, r.x1 - 1);
        const int y = std::min(r.y0 + j * kPreviewBlock + kPreviewBlock / 2, r.y1 - 1);
        batcher.add(static_cast<std::size_t>(j * columns + i), x, y, 0, 1);
    });
    return batcher.flush();
}

template <class A, unsigned kParts>
bool run(const Job& job) {
    if (job.sums == nullptr) return run_preview<A, kParts>(job);
    const auto take = [&](std::size_t pixel, std::span<const glm::vec3> light) {
        PixelSum sum = (*job.sums)[pixel];  // a copy, which stays in registers
        for (const glm::vec3& c : light) {
            const bool good = finite(c);
            if (!good) ++job.work.counts.non_finite;
            sum.add(good ? &c : nullptr, job.work.doublings);
        }
        (*job.sums)[pixel] = sum;
    };
    Batcher<A, kParts, decltype(take)> batcher(job, take);
    const TileRect& r = job.rect;
    const int width = r.x1 - r.x0;
    // The samples of a pixel are the most alike of all, so they stay together; and their sums need them in this order.
    along_z_curve(width, r.y1 - r.y0, [&](int i, int j) {
        const auto pixel = static_cast<std::size_t>(j * width + i);
        batcher.add(pixel, r.x0 + i, r.y0 + j, job.first, job.last);
    });
    return batcher.flush();
}

using Kernel = bool (*)(const Job&);
using KernelRow = std::array<Kernel, kernel_part::count>;

template <class A, unsigned... kParts>
constexpr KernelRow kernel_row(std::integer_sequence<unsigned, kParts...>) {
    return {&run<A, instance_parts(kParts)>...};
}

template <class A>
constexpr KernelRow kRow = kernel_row<A>(std::make_integer_sequence<unsigned, kernel_part::count>());

const std::array<KernelRow, kAcceleratorNames.size()> kKernels{kRow<BruteForce>, kRow<UniformGrid>, kRow<Bvh>};

bool dispatch(const Job& job) { return kKernels[job.in.accelerator.index()][job.in.plan.kernel](job); }

}  // namespace

bool render_tile(const KernelInput& input, TileRect rect, int first, int last, std::vector<PixelSum>& sums,
                 Workspace& workspace) {
    return dispatch({input, rect, first, last, &sums, nullptr, workspace});
}

bool render_preview(const KernelInput& input, TileRect rect, std::vector<glm::vec3>& blocks, Workspace& workspace) {
    blocks.assign(
        static_cast<std::size_t>(preview_blocks(rect.x1 - rect.x0)) * static_cast<std::size_t>(preview_blocks(rect.y1 - rect.y0)),
        glm::vec3(0.0f));
    return dispatch({input, rect, 0, 1, nullptr, &blocks, workspace});
}

}  // namespace glint
