// What one worker keeps between batches of samples, so that tracing allocates nothing once it runs.
// Knows nothing of what the fields mean to whoever fills them; radiance.h does.
#pragma once

#include <array>
#include <span>

#include "accel/ray_batch.h"
#include "core/branch_stacks.h"
#include "core/material.h"
#include "core/ray_counts.h"
#include "core/sampler.h"
#include "core/shadow_origins.h"
#include "core/surface_points.h"

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

// What goes on where a lane's branch has met a surface; the point itself is apart.
struct Vertex {
    glm::vec3 wo;
    const Material* material;
    bool highlight, lit;  // whether the material shows highlights, or any light of a source
    glm::vec3 direct;     // light arriving straight from the lights, reflected
};

// Up to one item a lane; items keep their old contents until they are written.
template <class T>
class PerLane {
public:
    void clear() { size_ = 0; }
    T& add() { return items_[size_++]; }
    [[nodiscard]] std::span<const T> all() const { return {items_.data(), size_}; }
    // Drops all but the first n.
    void keep(std::size_t n) { size_ = n; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    T& operator[](std::size_t i) { return items_[i]; }
    T* begin() { return items_.data(); }
    T* end() { return items_.data() + size_; }

private:
    std::array<T, kRayBatch> items_;
    std::size_t size_ = 0;
};

struct Workspace {
    RayCounts counts;
    ShadowOrigins shadow_origins;
    std::uint64_t prepared_for = ~std::uint64_t{0};  // the generation whose lights they are of
    BranchStacks stacks;
    PerLane<Lane> lanes;
    // Where branches have met surfaces: of which lanes, and what is there. All three have the same order.
    PerLane<std::uint32_t> met;
    SurfacePoints points;
    PerLane<Vertex> vertices;
    RayBatch rays, shadow_rays;
    HitBatch hits;
    OccludedBatch blocked;
    // What each shadow ray carries, and the vertex it is for.
    std::array<glm::vec3, kRayBatch> shadow_light;
    std::array<std::uint32_t, kRayBatch> shadow_vertex;
};

}  // namespace glint
