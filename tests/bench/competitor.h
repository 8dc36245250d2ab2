// One way to trace rays, and where its answers go.
// Knows no clock. Invariant: answers of ray i of a set lie in block i / kRayBatch, lane i % kRayBatch, whoever gave them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accel/accelerator.h"
#include "ray_set.h"

namespace glint::bench {

struct Answers {
    std::vector<HitBatch> hits;
    std::vector<OccludedBatch> occluded;

    explicit Answers(std::size_t rays) : hits((rays + kRayBatch - 1) / kRayBatch), occluded(hits.size()) {}
    [[nodiscard]] Hit hit(std::size_t i) const { return hits[i / kRayBatch][static_cast<int>(i % kRayBatch)]; }
    [[nodiscard]] bool is_occluded(std::size_t i) const { return occluded[i / kRayBatch][i % kRayBatch]; }
};

// A block of at most kRayBatch rays, as they lie in memory: one struct a ray for those who trace one at a time (and streams),
// structure of arrays for packets and batches. From there each packs what it needs, inside the timing.
struct Block {
    std::span<const Ray> rays;
    const RayBatch& batch;
    HitBatch& hits;
    OccludedBatch& occluded;
};

class Competitor {
public:
    enum class Role { embree_single, embree_robust, embree_wide, bvh_single, bvh_batch, bvh_fast_tree, grid };

    Competitor(std::string name, Role role) : name_(std::move(name)), role_(role) {}
    virtual ~Competitor() = default;
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] Role role() const { return role_; }
    [[nodiscard]] bool is_glint() const { return role_ >= Role::bvh_single; }

    // Called by a thread before and after it traces, inside the timing (Embree wants denormals flushed to zero).
    virtual void begin_thread() const {}
    virtual void end_thread() const {}
    // Any number of consecutive blocks of one set.
    virtual void closest(RayOrder order, std::span<Block> blocks) const = 0;
    virtual void occluded(RayOrder order, std::span<Block> blocks) const = 0;

private:
    std::string name_;
    Role role_;
};

using Competitors = std::vector<std::unique_ptr<Competitor>>;

// Blocks [first, last) of a set, ready for closest() or occluded().
[[nodiscard]] std::vector<Block> make_blocks(const RaySet& set, Answers& answers, std::size_t first, std::size_t last);
void trace(const Competitor& competitor, const RaySet& set, Answers& answers);  // all of it, on this thread

[[nodiscard]] Competitors glint_competitors(std::shared_ptr<const Bvh> bvh, std::shared_ptr<const Bvh> fast_tree,
                                            std::shared_ptr<const UniformGrid> grid);
[[nodiscard]] Competitors embree_competitors(const Geometry& geometry);

}  // namespace glint::bench
