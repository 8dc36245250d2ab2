#include "core/scene_origin.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

// Beyond so many sizes a scene lies far out: three bits of a float are lost there, as they are to a camera at that distance.
constexpr double kFar = 8.0;
// Each move finds the centre to 23 bits more, and a double has 53.
constexpr int kMostMoves = 4;

double largest(glm::dvec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

glm::dvec3 centre_of(const Aabb& box) { return 0.5 * (glm::dvec3(box.lo) + glm::dvec3(box.hi)); }

// The sum of the sides: unlike the longest one it grows at least as fast as the centre moves when the box grows.
double size_of(const Aabb& box) {
    const glm::dvec3 sides = glm::dvec3(box.hi) - glm::dvec3(box.lo);
    return sides.x + sides.y + sides.z;
}

}  // namespace

bool lies_near(const Aabb& extent) { return !extent.empty() && largest(centre_of(extent)) <= kFar * size_of(extent); }

Aabb extent_of(const Geometry& geometry, const Aabb& marked) {
    Aabb extent = marked;
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone}) {
        const auto n = static_cast<std::uint32_t>(geometry.count(kind));
        for (std::uint32_t i = 0; i < n && !lies_near(extent); ++i) extent.grow(geometry.bounds(make_id(kind, i)));
    }
    for (const Instance& instance : geometry.instances) {
        if (lies_near(extent)) break;
        extent.grow(geometry.instance_bounds(instance));
    }
    return extent;
}

glm::dvec3 origin_shift(const Aabb& extent) {
    if (extent.empty() || lies_near(extent)) return glm::dvec3(0.0);
    const glm::dvec3 centre = centre_of(extent);
    // What has shrunk to a point may be as large as floats are apart there.
    const double size = std::max(size_of(extent), largest(centre) * 0x1p-23);
    const double step = std::ldexp(1.0, std::ilogb(size) + 1);
    return step * glm::floor(centre / step + 0.5);
}

bool SceneOrigin::suits(const Aabb& extent) {
    const glm::dvec3 shift = origin_shift(extent);
    if (shift == glm::dvec3(0.0) || moves_ == kMostMoves) return true;
    world_ += shift;
    ++moves_;
    return false;
}

}  // namespace glint
