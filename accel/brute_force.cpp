#include "accel/brute_force.h"

#include <utility>

namespace glint {
namespace {

// Stops at the first hit where any will do.
template <PrimitiveKind kind, bool any>
void test_all(const PreparedRay& ray, const Geometry& g, Hit& best) noexcept {
    const auto n = static_cast<std::uint32_t>(g.count(kind));
    for (std::uint32_t i = 0; i < n && !(any && best.found()); ++i) intersect<kind>(ray, g, i, best);
}

template <bool any>
Hit query(const Ray& ray, const Geometry& g, float magnitude) noexcept {
    const PreparedRay prepared(ray, magnitude);
    Hit best = begin_query(prepared, g);
    if (!prepared.usable) return best;
    test_all<PrimitiveKind::triangle, any>(prepared, g, best);
    test_all<PrimitiveKind::sphere, any>(prepared, g, best);
    test_all<PrimitiveKind::box, any>(prepared, g, best);
    test_all<PrimitiveKind::cone, any>(prepared, g, best);
    return best;
}

}  // namespace

BruteForce::BruteForce(std::shared_ptr<const Geometry> geometry)
    : geometry_(std::move(geometry)), magnitude_(geometry_->own_bounds().magnitude()) {
    for (const Prototype& prototype : geometry_->prototypes) prototypes_.emplace_back(prototype.geometry);
}

Hit BruteForce::closest_hit(const Ray& ray) const noexcept {
    Hit best = query<false>(ray, *geometry_, magnitude_);
    for (const Instance& instance : geometry_->instances) {
        Hit hit = prototypes_[instance.prototype].closest_hit(object_ray(instance.object_from_world, ray, best.t));
        if (!hit.found()) continue;
        hit.primitive = instance.first_id + geometry_->prototypes[instance.prototype].geometry->rank(hit.primitive);
        if (hit.t < best.t || hit.primitive < best.primitive) best = hit;
    }
    return best;
}

bool BruteForce::occluded(const Ray& ray) const noexcept {
    if (query<true>(ray, *geometry_, magnitude_).found()) return true;
    for (const Instance& instance : geometry_->instances) {
        if (prototypes_[instance.prototype].occluded(object_ray(instance.object_from_world, ray, ray.t_max))) return true;
    }
    return false;
}

}  // namespace glint
