#include "accel/instance_level.h"

#include <algorithm>
#include <utility>

#include "accel/uniform_grid.h"

namespace glint {
namespace {

float largest(glm::vec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

// A ray that is not finite is none in any space.
bool finite(const Ray& ray) { return largest(ray.origin) < kInfinity && largest(ray.direction) < kInfinity; }

float largest_origin(const RayBatch& rays) {
    float most = 0.0f;
    for (const auto& axis : rays.origin) {
        for (int i = 0; i < rays.count; ++i) most = std::max(most, std::abs(axis[i]));
    }
    return most;
}

// Up to so many rays are not worth a batch.
constexpr int kFewRays = 3;

}  // namespace

const InstanceKernels& instance_kernels_for(Isa isa) {
    switch (isa) {
        case Isa::avx512: return isa_avx512::instance_kernels;
        case Isa::avx2: return isa_avx2::instance_kernels;
        case Isa::baseline: break;
    }
    return isa_baseline::instance_kernels;
}

template <class A>
InstanceLevel<A>::InstanceLevel(std::shared_ptr<const Geometry> world, const ParallelFor& parallel_for, Isa isa,
                                const MakeAccelerator& make)
    : world_(std::move(world)), boxes_(*world_, parallel_for), kernels_(&instance_kernels_for(isa)) {
    below_.reserve(world_->prototypes.size());
    for (const Prototype& prototype : world_->prototypes) {
        const auto count = [&](PrimitiveKind kind) { return static_cast<std::uint32_t>(prototype.geometry->count(kind)); };
        const std::uint32_t triangles = count(PrimitiveKind::triangle), spheres = triangles + count(PrimitiveKind::sphere);
        below_.push_back({make(prototype.geometry), {0, triangles, spheres, spheres + count(PrimitiveKind::box)}});
    }
}

template <class A>
std::shared_ptr<const InstanceLevel<A>> InstanceLevel<A>::build(std::shared_ptr<const Geometry> world,
                                                                const ParallelFor& parallel_for, Isa isa,
                                                                const MakeAccelerator& make) {
    if (world->instances.empty()) return nullptr;
    return std::shared_ptr<const InstanceLevel>(new InstanceLevel(std::move(world), parallel_for, isa, make));
}

// Calls visit(instance) for all that the ray may hit up to `limit`, and for all there are where boxes cannot tell.
template <class A>
template <class Visit>
void InstanceLevel<A>::for_each(const Ray& ray, const float& limit, Visit visit) const noexcept {
    const auto call = [](void* self, std::uint32_t i, const std::uint16_t*, int) noexcept { (*static_cast<Visit*>(self))(i); };
    const InstanceVisitor visitor{&visit, call};
    if (kernels_->walk_one(boxes_.view(), ray, boxes_.magnitude_for(largest(ray.origin)), &limit, visitor)) return;
    if (!(ray.t_max > 0.0f) || !finite(ray)) return;
    for (std::uint32_t i = 0; i < world_->instances.size(); ++i) visit(i);
}

// The same with visit(instance, rays' places, their number).
template <class A>
template <class Visit>
void InstanceLevel<A>::for_each(const RayBatch& rays, const float* limit, Visit visit) const noexcept {
    const auto call = [](void* self, std::uint32_t i, const std::uint16_t* places, int count) noexcept {
        (*static_cast<Visit*>(self))(i, places, count);
    };
    const InstanceVisitor visitor{&visit, call};
    std::uint16_t unusable[kRayBatch];
    const int left_out =
        kernels_->walk(boxes_.view(), rays, boxes_.magnitude_for(largest_origin(rays)), limit, visitor, unusable);
    for (int k = 0; k < left_out; ++k) {
        const Ray ray = rays[unusable[k]];
        if (!(ray.t_max > 0.0f) || !finite(ray)) continue;
        for (std::uint32_t i = 0; i < world_->instances.size(); ++i) visit(i, unusable + k, 1);
    }
}

template <class A>
void InstanceLevel<A>::keep(const Instance& instance, const Hit& found, Hit& best) const noexcept {
    if (!found.found()) return;
    const std::uint32_t* first_rank = below_[instance.prototype].first_rank;
    const PrimitiveId id =
        instance.first_id + first_rank[static_cast<std::size_t>(kind_of(found.primitive))] + index_of(found.primitive);
    if (found.t < best.t || id < best.primitive) best = {found.t, found.u, found.v, id};
}

template <class A>
void InstanceLevel<A>::closest_hit(const Ray& ray, Hit& best) const noexcept {
    for_each(ray, best.t, [&](std::uint32_t i) {
        const Instance& instance = world_->instances[i];
        const Ray own = object_ray(instance.object_from_world, ray, best.t);
        keep(instance, below_[instance.prototype].accelerator.closest_hit(own), best);
    });
}

template <class A>
bool InstanceLevel<A>::occluded(const Ray& ray) const noexcept {
    float limit = ray.t_max;
    bool found = false;
    for_each(ray, limit, [&](std::uint32_t i) {
        const Instance& instance = world_->instances[i];
        if (found || !below_[instance.prototype].accelerator.occluded(object_ray(instance.object_from_world, ray, ray.t_max)))
            return;
        found = true;
        limit = -1.0f;  // no box is entered any more
    });
    return found;
}

template <class A>
void InstanceLevel<A>::closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept {
    for_each(rays, hits.t, [&](std::uint32_t i, const std::uint16_t* places, int count) {
        const Instance& instance = world_->instances[i];
        const A& below = below_[instance.prototype].accelerator;
        const auto keep_at = [&](int place, const Hit& found) {
            Hit best = hits[place];
            keep(instance, found, best);
            hits.set(place, best);
        };
        if (count <= kFewRays) {
            for (int k = 0; k < count; ++k) {
                const int at = places[k];
                keep_at(at, below.closest_hit(object_ray(instance.object_from_world, rays[at], hits.t[at])));
            }
            return;
        }
        RayBatch own;
        HitBatch found;
        kernels_->to_object(instance.object_from_world, rays, places, count, hits.t, own);
        below.closest_hits(own, found);
        for (int k = 0; k < count; ++k) {
            if (found.primitive[k] != kNoPrimitive) keep_at(places[k], found[k]);
        }
    });
}

template <class A>
void InstanceLevel<A>::occluded(const RayBatch& rays, OccludedBatch& result) const noexcept {
    // Where there is a hit already no box is entered any more.
    alignas(64) float limit[kRayBatch];
    for (int i = 0; i < rays.count; ++i) limit[i] = result[static_cast<std::size_t>(i)] ? -1.0f : rays.t_max[i];
    for_each(rays, limit, [&](std::uint32_t i, const std::uint16_t* places, int count) {
        const Instance& instance = world_->instances[i];
        const A& below = below_[instance.prototype].accelerator;
        const auto keep_at = [&](std::size_t place, bool found) {
            if (!found) return;
            result[place] = true;
            limit[place] = -1.0f;
        };
        if (count <= kFewRays) {
            for (int k = 0; k < count; ++k) {
                const int at = places[k];
                if (limit[at] < 0.0f) continue;
                keep_at(places[k], below.occluded(object_ray(instance.object_from_world, rays[at], rays.t_max[at])));
            }
            return;
        }
        RayBatch own;
        OccludedBatch found;
        kernels_->to_object(instance.object_from_world, rays, places, count, rays.t_max, own);
        below.occluded(own, found);
        for (int k = 0; k < count; ++k) keep_at(places[k], found[static_cast<std::size_t>(k)]);
    });
}

template <class A>
std::size_t InstanceLevel<A>::memory_bytes() const {
    std::size_t bytes = boxes_.memory_bytes();
    for (const Below& b : below_) bytes += sizeof(Below) + b.accelerator.memory_bytes();
    return bytes;
}

template <class A>
void InstanceLevel<A>::count_traversal(const Ray& ray, Hit best, TraversalCounts& counts) const noexcept {
    for_each(ray, best.t, [&](std::uint32_t i) {
        const Instance& instance = world_->instances[i];
        const A& below = below_[instance.prototype].accelerator;
        RayBatch own;
        own.clear(RayOrder::divergent);
        own.push(object_ray(instance.object_from_world, ray, best.t));
        const TraversalCounts c = below.count_traversal(own);
        counts.nodes += c.nodes;
        counts.leaves += c.leaves;
        counts.primitives += c.primitives;
        keep(instance, below.closest_hit(own[0]), best);
    });
}

template class InstanceLevel<Bvh>;
template class InstanceLevel<UniformGrid>;

}  // namespace glint
