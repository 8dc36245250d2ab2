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
    : geometry_(std::move(geometry)), magnitude_(geometry_->bounds().magnitude()) {}

Hit BruteForce::closest_hit(const Ray& ray) const noexcept { return query<false>(ray, *geometry_, magnitude_); }
bool BruteForce::occluded(const Ray& ray) const noexcept { return query<true>(ray, *geometry_, magnitude_).found(); }

}  // namespace glint
