#include "core/tile_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

namespace glint {
namespace {

Sampler pixel_sampler(const KernelInput& in, int x, int y) {
    return {in.plan.sampler, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0, in.plan.seed};
}

// The camera ray of a sample of the pixel, at the position that its sampler (or the pixel's centre) gives.
void set_camera_sample(const KernelInput& in, int x, int y, const Sampler& sampler, CameraSample& sample) {
    const glm::vec2 jitter = in.plan.jitter ? sampler.square(dimension::pixel) : glm::vec2(0.5f);
    const glm::vec2 lens = in.camera.has_lens() ? disk_from_square(sampler.square(dimension::lens)) : glm::vec2(0.0f);
    sample.ray = in.camera.ray(static_cast<float>(x) + jitter.x, static_cast<float>(y) + jitter.y, lens);
    sample.sampler = sampler;
}

// The same for a run of samples of one pixel, from that of `sampler` on, through a pinhole.
constexpr int kRun = Sampler::kRun;
static_assert(kRun == Camera::kRunOfRays);
struct Run {
    float direction[3][kRun];

    Run(const KernelInput& in, int x, int y, const Sampler& sampler) {
        float at_x[kRun], at_y[kRun];
        sampler.squares(dimension::pixel, at_x, at_y);
        for (int k = 0; k < kRun; ++k) {
            at_x[k] = static_cast<float>(x) + at_x[k];
            at_y[k] = static_cast<float>(y) + at_y[k];
        }
        in.camera.pinhole_rays(at_x, at_y, direction);
    }
};

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
unsigned even_bits(unsigned m) {
    unsigned x = 0;
    for (unsigned bit = 0; m >> (2 * bit) != 0; ++bit) x |= ((m >> (2 * bit)) & 1u) << bit;
    return x;
}

// Calls visit(x, y) for each cell of a width x height grid along the Z curve (Morton 1966): any 4^n cells in a row from a
// multiple of 4^n on are a square, whose rays go about the same way.
template <class Visit>
void along_z_curve(int width, int height, Visit&& visit) {
    const unsigned side = std::bit_ceil(static_cast<unsigned>(std::max({1, width, height})));
    for (unsigned m = 0; m < side * side; ++m) {
        const int x = static_cast<int>(even_bits(m)), y = static_cast<int>(even_bits(m >> 1));
        if (x < width && y < height) visit(x, y);
    }
}

// Gathers samples into batches, traces them, and hands each answer to take(cell, radiance) in the order they came in.
template <class A, unsigned kParts, class Take>
class Batcher {
public:
    Batcher(const Job& job, Take take)
        : in_(job.in), integrator_(in_.scene, std::get<A>(in_.accelerator), in_.plan, job.work), take_(take) {
        if (job.work.prepared_for == in_.generation) return;
        integrator_.prepare();
        job.work.prepared_for = in_.generation;
    }

    // Samples [first, last) of a pixel.
    void add(std::size_t cell, int x, int y, int first, int last) {
        const Sampler pixel = pixel_sampler(in_, x, y);
        int k = first;
        if (in_.plan.jitter && !in_.camera.has_lens()) {
            // Half a run costs less than its rays one by one.
            for (; last - k >= kRun / 2 && !stopped_; k += std::min(kRun, last - k)) {
                const Run run(in_, x, y, pixel.at(static_cast<std::uint32_t>(k)));
                for (int i = 0; i < std::min(kRun, last - k) && !stopped_; ++i) {
                    CameraSample& sample = next(cell);
                    sample.ray.origin = in_.camera.eye();
                    sample.ray.direction = {run.direction[0][i], run.direction[1][i], run.direction[2][i]};
                    sample.sampler = pixel.at(static_cast<std::uint32_t>(k + i));
                    if (count_ == samples_.size()) flush();
                }
            }
        }
        for (; k < last && !stopped_; ++k) {
            set_camera_sample(in_, x, y, pixel.at(static_cast<std::uint32_t>(k)), next(cell));
            if (count_ == samples_.size()) flush();
        }
    }
    // Traces what has been gathered. False when the frame is not wanted any more.
    bool flush() {
        const auto stale = [this] { return in_.current_generation.load(std::memory_order_relaxed) != in_.generation; };
        stopped_ = stopped_ || !integrator_.radiance(std::span(samples_).first(count_), radiance_, stale);
        for (std::size_t i = 0; i < count_ && !stopped_; ++i) take_(cells_[i], radiance_[i]);
        count_ = 0;
        return !stopped_;
    }

private:
    CameraSample& next(std::size_t cell) {
        cells_[count_] = cell;
        return samples_[count_++];
    }

    const KernelInput& in_;
    Integrator<A, kParts> integrator_;
    Take take_;
    bool stopped_ = false;
    std::size_t count_ = 0;
    std::array<std::size_t, kRayBatch> cells_;
    std::array<CameraSample, kRayBatch> samples_;
    std::array<glm::vec3, kRayBatch> radiance_;
};

template <class A, unsigned kParts>
bool run_preview(const Job& job) {
    const auto take = [&](std::size_t cell, glm::vec3 c) { (*job.preview)[cell] = finite(c) ? c : glm::vec3(0.0f); };
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
    const auto take = [&](std::size_t pixel, glm::vec3 c) {
        PixelSum& sum = (*job.sums)[pixel];
        if (!finite(c)) {
            ++job.work.counts.non_finite;
            ++sum.rejected;
            return;
        }
        const double l = luminance(glm::dvec3(c));
        sum.radiance += glm::dvec3(c);
        sum.luminance2 += l * l;
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
