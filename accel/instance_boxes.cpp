#include "accel/instance_level.h"

namespace glint {
namespace {

// The errors between the world and an instance's space, in units of the padding: that of the tests below (40 units of 2^-24 and
// 5 of their own arithmetic), one for each rounding of origin and direction, one for all of double. 48 of 60.
constexpr double kObjectPadding = 1.5 * static_cast<double>(kPadding);

}  // namespace

InstanceBoxes::InstanceBoxes(const Geometry& world, const ParallelFor& parallel_for) {
    const double magnitude = static_cast<double>(world.bounds().magnitude());
    near_origin_ = 2.0 * magnitude;
    Geometry boxes;
    boxes.boxes.resize(world.instances.size());
    std::vector<double> bends(world.instances.size());
    constexpr std::size_t kChunk = 4096;
    parallel_for((world.instances.size() + kChunk - 1) / kChunk, [&](std::size_t t) {
        for (std::size_t i = t * kChunk; i < std::min(world.instances.size(), (t + 1) * kChunk); ++i) {
            const Instance& instance = world.instances[i];
            const AffineMap& in = instance.object_from_world;
            const AffineMap out = inverse(in);
            bends[i] = in.growth() * out.growth();
            const double reach = in.growth() * near_origin_ + in.shift() +
                                 static_cast<double>(world.prototypes[instance.prototype].bounds.magnitude());
            const Aabb box = world.instance_bounds(instance);
            for (int k = 0; k < 3; ++k) {
                const auto& r = out.row[k];
                const double pad = kObjectPadding * reach * (std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2]));
                boxes.boxes[i].lo[k] = std::nextafter(static_cast<float>(static_cast<double>(box.lo[k]) - pad), -kInfinity);
                boxes.boxes[i].hi[k] = std::nextafter(static_cast<float>(static_cast<double>(box.hi[k]) + pad), kInfinity);
            }
        }
    });
    for (const double bend : bends) most_bend_ = std::max(most_bend_, bend);
    tree_ = build_bvh(boxes, parallel_for);
    view_ = tree_.view(boxes);
    view_.geometry = nullptr;  // the boxes are in the leaves
}

// Beyond near_origin_ the boxes lack what the error grows by, which is at most the greatest bend times the distance; the
// kernels pad by kPadding for each unit of what they are told.
float InstanceBoxes::magnitude_for(float largest_coordinate) const noexcept {
    const double beyond = static_cast<double>(largest_coordinate) - near_origin_;
    const double more = beyond > 0.0 ? kObjectPadding / static_cast<double>(kPadding) * most_bend_ * beyond : 0.0;
    return static_cast<float>(static_cast<double>(view_.magnitude) + more);
}

}  // namespace glint
