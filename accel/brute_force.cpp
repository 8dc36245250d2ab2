#include "accel/brute_force.h"

#include <utility>

namespace glint {
namespace {

constexpr PrimitiveKind kBounded[] = {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone};

}  // namespace

BruteForce::BruteForce(std::shared_ptr<const Geometry> geometry)
    : geometry_(std::move(geometry)), magnitude_(geometry_->bounds().magnitude()) {}

Hit BruteForce::closest_hit(const Ray& ray) const noexcept {
    const PreparedRay prepared(ray, magnitude_);
    Hit best = begin_query(prepared, *geometry_);
    if (!prepared.usable) return best;
    for (const PrimitiveKind kind : kBounded) {
        const auto n = static_cast<std::uint32_t>(geometry_->count(kind));
        for (std::uint32_t i = 0; i < n; ++i) intersect(prepared, *geometry_, make_id(kind, i), best);
    }
    return best;
}

bool BruteForce::occluded(const Ray& ray) const noexcept {
    const PreparedRay prepared(ray, magnitude_);
    Hit best = begin_query(prepared, *geometry_);
    if (!prepared.usable) return false;
    for (const PrimitiveKind kind : kBounded) {
        const auto n = static_cast<std::uint32_t>(geometry_->count(kind));
        for (std::uint32_t i = 0; i < n && !best.found(); ++i) intersect(prepared, *geometry_, make_id(kind, i), best);
    }
    return best.found();
}

}  // namespace glint
