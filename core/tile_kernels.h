// The integrator's instances by accelerator and parts, and the walk over a tile's pixels that fills its batches.
// Knows no threads; a kernel looks at a generation counter before each wave of a batch and gives up when it moved on.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/framebuffer.h"
#include "core/radiance.h"
#include "core/render_plan.h"

namespace glint {

// Everything a kernel needs besides its accelerator; immutable while the frame lives.
struct KernelInput {
    const Scene& scene;
    const AnyAccelerator& accelerator;
    const RenderPlan& plan;
    const Camera& camera;
    const std::atomic<std::uint64_t>& current_generation;
    std::uint64_t generation;
};

// Adds samples [first, last) of each pixel of `rect` to `sums` in ascending order. False when abandoned.
[[nodiscard]] bool render_tile(const KernelInput& input, TileRect rect, int first, int last, std::vector<PixelSum>& sums,
                               Workspace& workspace);
// One ray through the middle of each preview block. False when abandoned.
[[nodiscard]] bool render_preview(const KernelInput& input, TileRect rect, std::vector<glm::vec3>& blocks, Workspace& workspace);

// The parts of the instance that runs for `parts`: fuzziness without a mirror never occurs, so it shares the plain one.
[[nodiscard]] constexpr unsigned instance_parts(unsigned parts) {
    return (parts & kernel_part::mirror) != 0 ? parts : parts & ~kernel_part::fuzzy;
}

}  // namespace glint
