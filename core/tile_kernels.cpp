#include "core/tile_kernels.h"

#include <array>
#include <cmath>
#include <utility>

namespace glint {
namespace {

// Radiance of sample `index` of the pixel, at the position that its sampler (or the pixel's centre) gives.
template <class I>
glm::vec3 pixel_sample(I& integrator, const KernelInput& in, int x, int y, std::uint64_t index, glm::vec2 centre) {
    const Sampler sampler(in.plan.sampler, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), index, in.plan.seed);
    const glm::vec2 jitter = in.plan.jitter ? sampler.square(dimension::pixel) : centre;
    const glm::vec2 lens = in.camera.has_lens() ? disk_from_square(sampler.square(dimension::lens)) : glm::vec2(0.0f);
    return integrator.radiance(in.camera.ray(static_cast<float>(x) + jitter.x, static_cast<float>(y) + jitter.y, lens), sampler);
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

template <class A, unsigned kParts>
bool run(const Job& job) {
    const KernelInput& in = job.in;
    Integrator<A, kParts> integrator(in.scene, std::get<A>(in.accelerator), in.plan, job.work);
    const int step = job.sums != nullptr ? 1 : kPreviewBlock;
    std::size_t i = 0;
    for (int y = job.rect.y0; y < job.rect.y1; y += step) {
        for (int x = job.rect.x0; x < job.rect.x1; x += step, ++i) {
            if (in.current_generation.load(std::memory_order_relaxed) != in.generation) return false;
            if (job.sums == nullptr) {
                const int cx = std::min(x + step / 2, job.rect.x1 - 1), cy = std::min(y + step / 2, job.rect.y1 - 1);
                const glm::vec3 c = pixel_sample(integrator, in, cx, cy, 0, glm::vec2(0.5f));
                (*job.preview)[i] = finite(c) ? c : glm::vec3(0.0f);
                continue;
            }
            PixelSum& sum = (*job.sums)[i];
            for (int k = job.first; k < job.last; ++k) {
                const glm::vec3 c = pixel_sample(integrator, in, x, y, static_cast<std::uint64_t>(k), glm::vec2(0.5f));
                if (!finite(c)) {
                    ++job.work.counts.non_finite;
                    ++sum.rejected;
                    continue;
                }
                const double l = luminance(glm::dvec3(c));
                sum.radiance += glm::dvec3(c);
                sum.luminance2 += l * l;
            }
        }
    }
    return true;
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
