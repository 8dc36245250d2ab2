// Which accelerator a picture should have: estimates of what each costs to build and to ask, and the least of them.
// Knows no threads and builds nothing. Constants are measured and renewed by `tests/bench/regret --calibrate` (core/README.md).
#pragma once

#include <array>

#include "accel/accelerator.h"
#include "core/scene.h"

namespace glint {

// What a picture asks of an accelerator.
struct RayDemand {
    double rays = 1.0e6;  // of all kinds
    int threads = 1;      // that build and render
};
// Samples times what a sample asks for: its camera ray, then a shadow ray to each light; mirrors and glass
// multiply it (within a factor of three of what the bench scenes cast).
[[nodiscard]] RayDemand expected_rays(const Scene& scene, int width, int height, double samples_per_pixel, int threads = 1);

// No more rays than can be traced in these seconds.
[[nodiscard]] RayDemand within(const RayDemand& demand, const Geometry& geometry, double seconds);

struct AcceleratorChoice {
    AcceleratorKind kind;
    BuildQuality quality;  // of a bvh

    // A kind alone means the best of its kind.
    constexpr AcceleratorChoice(AcceleratorKind k = AcceleratorKind::bvh, BuildQuality q = BuildQuality::quality)
        : kind(k), quality(q) {}
    bool operator==(const AcceleratorChoice&) const = default;
};
constexpr std::array<AcceleratorChoice, 4> kAcceleratorChoices{
    {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh, {AcceleratorKind::bvh, BuildQuality::fast}}};

// Seconds for building and asking, by choice.
[[nodiscard]] std::array<double, kAcceleratorChoices.size()> estimated_seconds(const Geometry& geometry, const RayDemand& demand);

// What `auto` means: the choice of the least estimate.
[[nodiscard]] AcceleratorChoice automatic_accelerator(const Scene& scene, const RayDemand& demand = {});

}  // namespace glint
