#include "accel/bvh.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "accel/instance_level.h"

namespace glint {
namespace {

// Widths of a span in leaves up to which its frustum alone is faster than packets.
constexpr float kTriangleSpan = 2.0f, kSphereSpan = 6.0f;

}  // namespace

const BvhKernels& bvh_kernels(Isa isa) {
    switch (isa) {
        case Isa::avx512: return isa_avx512::kernels;
        case Isa::avx2: return isa_avx2::kernels;
        case Isa::baseline: break;
    }
    return isa_baseline::kernels;
}

void intersect_alone(const Ray& ray, float magnitude, const Geometry& geometry, PrimitiveId id, Hit& best) noexcept {
    intersect(PreparedRay(ray, magnitude), geometry, id, best);
}

BvhView BvhTree::view(const Geometry& geometry) const {
    static std::atomic<std::uint64_t> trees{0};
    BvhView view;
    if (units.empty()) return view;
    view.tree = ++trees;
    view.units = units.front().bytes;
    view.bytes = units.size() * sizeof(Unit);
    view.geometry = &geometry;
    for (int i = 0; i < 3; ++i) {
        view.lo[i] = bounds.lo[i];
        view.hi[i] = bounds.hi[i];
    }
    view.magnitude = bounds.magnitude();
    view.only_triangles = geometry.bounded_count() == geometry.triangles.size();
    view.frustum_extent = leaf_extent * (2 * geometry.spheres.size() > geometry.bounded_count() ? kSphereSpan : kTriangleSpan);
    return view;
}

Bvh::Bvh(std::shared_ptr<const Geometry> geometry, const ParallelFor& parallel_for, Isa isa, BuildQuality quality)
    : geometry_(std::move(geometry)),
      tree_(build_bvh(*geometry_, parallel_for, quality)),
      view_(tree_.view(*geometry_)),
      has_planes_(!geometry_->planes.empty()),
      kernels_(&bvh_kernels(isa)),
      instances_(InstanceLevel<Bvh>::build(
          geometry_, parallel_for, isa,
          [&](std::shared_ptr<const Geometry> prototype) { return Bvh(std::move(prototype), parallel_for, isa, quality); })),
      tree_alone_(view_.units != nullptr && !has_planes_ && instances_ == nullptr) {}

Hit Bvh::closest_of_all(const Ray& ray) const noexcept {
    Hit best;
    best.t = ray.t_max;
    if (has_planes_) best = begin_query(PreparedRay(ray, view_.magnitude), *geometry_);
    if (view_.units != nullptr) kernels_->closest(view_, ray, best);
    if (instances_ != nullptr) instances_->closest_hit(ray, best);
    return best;
}

bool Bvh::occluded_by_any(const Ray& ray) const noexcept {
    if (has_planes_ && begin_query(PreparedRay(ray, view_.magnitude), *geometry_).found()) return true;
    if (view_.units != nullptr && kernels_->occluded(view_, ray)) return true;
    return instances_ != nullptr && instances_->occluded(ray);
}

void Bvh::closest_hits(const RayBatch& rays, HitBatch& hits) const noexcept {
    if (has_planes_) {
        for (int i = 0; i < rays.count; ++i) hits.set(i, begin_query(PreparedRay(rays[i], view_.magnitude), *geometry_));
    } else {
        std::copy_n(rays.t_max, rays.count, hits.t);
        std::fill_n(hits.u, rays.count, 0.0f);
        std::fill_n(hits.v, rays.count, 0.0f);
        std::fill_n(hits.primitive, rays.count, kNoPrimitive);
    }
    if (view_.units != nullptr) kernels_->closest_batch(view_, rays, hits);
    if (instances_ != nullptr) instances_->closest_hits(rays, hits);
}

void Bvh::occluded(const RayBatch& rays, OccludedBatch& result) const noexcept {
    for (int i = 0; i < rays.count; ++i) {
        result[static_cast<std::size_t>(i)] =
            has_planes_ && begin_query(PreparedRay(rays[i], view_.magnitude), *geometry_).found();
    }
    if (view_.units != nullptr) kernels_->occluded_batch(view_, rays, result.data());
    if (instances_ != nullptr) instances_->occluded(rays, result);
}

std::size_t Bvh::memory_bytes() const {
    return tree_.units.size() * sizeof(BvhTree::Unit) + (instances_ != nullptr ? instances_->memory_bytes() : 0);
}

TraversalCounts Bvh::count_traversal(const RayBatch& rays) const noexcept {
    TraversalCounts counts;
    for (int i = 0; i < rays.count && view_.units != nullptr; ++i) kernels_->count_closest(view_, rays[i], counts);
    for (int i = 0; i < rays.count && instances_ != nullptr; ++i) {
        Hit best;
        best.t = rays.t_max[i];
        if (view_.units != nullptr) kernels_->closest(view_, rays[i], best);
        instances_->count_traversal(rays[i], best, counts);
    }
    return counts;
}

}  // namespace glint
