// What one worker keeps between batches of samples, so that tracing allocates nothing once it runs.
// Knows nothing of what the fields mean to whoever fills them; radiance.h does.
#pragma once

#include <array>
#include <cstdint>

#include "accel/ray_batch.h"
#include "core/branch_stacks.h"
#include "core/direct_light.h"
#include "core/error_estimate.h"
#include "core/glass.h"
#include "core/medium_stack.h"
#include "core/ray_counts.h"
#include "core/sampler.h"
#include "core/shadow_origins.h"
#include "core/vertices.h"

namespace glint {

// A camera ray and the random numbers of everything that grows from it.
struct CameraSample {
    Ray ray;
    Sampler sampler;
};

// Samples on their way, structure of arrays: of each the sum of its light so far and what goes with the ray it follows, which
// has the same place in a batch of rays.
struct alignas(64) Lanes {
    std::size_t count = 0;
    std::uint32_t pixel[kRayBatch], index[kRayBatch];  // of its Sampler
    std::uint32_t sample[kRayBatch];                   // its place among the answers
    std::uint32_t waiting[kRayBatch];                  // the top of its stack of branches that come later
    float sum[3][kRayBatch];
    float throughput[3][kRayBatch];
    std::uint32_t path[kRayBatch];  // see Branch
    int bounces[kRayBatch];

    [[nodiscard]] Sampler sampler(SamplerKind kind, std::size_t lane) const { return {kind, pixel[lane], index[lane]}; }
    void add_light(std::size_t lane, glm::vec3 light) {
        for (int i = 0; i < 3; ++i) sum[i][lane] += throughput[i][lane] * light[i];
    }
    // Moves what belongs to a sample, but not the ray it follows and what goes with that.
    void move_sample(std::size_t from, std::size_t to) {
        pixel[to] = pixel[from];
        index[to] = index[from];
        sample[to] = sample[from];
        waiting[to] = waiting[from];
        for (int i = 0; i < 3; ++i) sum[i][to] = sum[i][from];
    }
};

struct Workspace {
    RayCounts counts;
    Doublings doublings{};  // what doubling the samples changed, for the error estimate
    ShadowOrigins shadow_origins;
    std::uint64_t prepared_for = ~std::uint64_t{0};  // the generation whose lights they are of
    BranchStacks stacks;
    Lanes lanes;
    std::array<MediumStack, kRayBatch> media;         // what the ray of each lane travels in, where there is glass
    std::array<MediumStack, kRayBatch> media_beyond;  // what is behind each vertex of glass
    Glass glass;
    RayBatch rays, shadow_rays;  // rays: of the lanes
    HitBatch hits;
    OccludedBatch blocked, lifts_blocked;
    // Where rays have met surfaces, and of which lanes.
    Vertices vertices;
    std::array<std::uint32_t, kRayBatch> met;
    DirectLight direct_light;
    // The random numbers that vertices ask for.
    alignas(64) std::uint32_t pixels[kRayBatch], indices[kRayBatch], dimensions[kRayBatch];
};

}  // namespace glint
