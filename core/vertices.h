// Where rays have met surfaces: the points, what they are made of as far as light straight from a source matters, and that
// light; structure of arrays, so that a processor's vectors can compute and read them.
// Knows no accelerator and no light. Invariant: arrays may be read and written up to the next multiple of kRunOfVertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/ray_batch.h"
#include "core/material.h"
#include "core/surface_points.h"

namespace glint {

constexpr std::size_t kRunOfVertices = 8;
static_assert(kRayBatch % kRunOfVertices == 0);

// n rounded up to whole runs.
constexpr std::size_t whole_runs(std::size_t n) { return (n + kRunOfVertices - 1) / kRunOfVertices * kRunOfVertices; }

struct alignas(64) Vertices {
    std::size_t count = 0;
    SurfacePoints points;
    float wo[3][kRayBatch];
    // Of the materials.
    float diffuse[3][kRayBatch];
    std::uint32_t lit[kRayBatch];  // whether light from a source would show
    bool any_lit, any_highlit, any_emission;
    float emission[3][kRayBatch];  // set where there is any
    // Set where any shows highlights; `highlit` says which do.
    float specular[3][kRayBatch], highlight_scale[kRayBatch], shininess[kRayBatch];
    std::uint32_t highlit[kRayBatch];
    float direct[3][kRayBatch];  // light arriving straight from the lights, reflected

    // Reads the materials of all points; no light arrives yet.
    void set_materials(std::span<const Material> materials, bool highlights) noexcept;

private:
    void set_highlights(std::span<const Material> materials) noexcept;
};

}  // namespace glint
