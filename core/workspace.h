// What one worker keeps between batches of samples, so that tracing allocates nothing once it runs.
// Knows nothing of what the fields mean to whoever fills them; radiance.h does.
#pragma once

#include <array>

#include "accel/ray_batch.h"
#include "core/branch_stacks.h"
#include "core/material.h"
#include "core/ray_counts.h"
#include "core/sampler.h"
#include "core/shadow_origins.h"
#include "core/surface_point.h"

namespace glint {

// A camera ray and the random numbers of everything that grows from it.
struct CameraSample {
    Ray ray;
    Sampler sampler;
};

// One sample on its way: the sum of its light so far and the branch it follows next.
struct Lane {
    Sampler sampler;
    glm::vec3 sum{0.0f};
    std::uint32_t top = BranchStacks::kEmpty;
    std::uint32_t sample = 0;  // its place in the batch
};

// Where a lane's branch has met a surface.
struct Vertex {
    SurfacePoint s;
    glm::vec3 wo;
    const Material* material;
    bool highlight, lit;  // whether the material shows highlights, or any light of a source
    glm::vec3 direct;     // light arriving straight from the lights, reflected
    std::uint32_t lane;
};

struct Workspace {
    RayCounts counts;
    ShadowOrigins shadow_origins;
    std::uint64_t prepared_for = ~std::uint64_t{0};  // the generation whose lights they are of
    BranchStacks stacks;
    std::vector<Lane> lanes;
    std::vector<Vertex> vertices;
    RayBatch rays, shadow_rays;
    HitBatch hits;
    OccludedBatch blocked;
    // What each shadow ray carries, and the vertex it is for.
    std::array<glm::vec3, kRayBatch> shadow_light;
    std::array<std::uint32_t, kRayBatch> shadow_vertex;
};

}  // namespace glint
