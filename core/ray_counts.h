// What a render did, counted: rays by kind and everything that would otherwise be lost from sight.
#pragma once

#include <cstdint>

namespace glint {

struct RayCounts {
    std::uint64_t camera = 0, shadow = 0, reflection = 0, refraction = 0;
    std::uint64_t non_finite = 0;   // samples rejected because they were NaN or infinite
    std::uint64_t depth_cut = 0;    // branches that the depth limit cut off
    double depth_cut_weight = 0.0;  // the sum of their weights (largest channel)
    std::uint64_t weight_cut = 0;   // branches that were not followed for their small weight
    double weight_cut_weight = 0.0;

    [[nodiscard]] std::uint64_t total() const { return camera + shadow + reflection + refraction; }
    // About how long they take, in shadow rays: a camera ray brings its sample's sums, those after a bounce go every way.
    [[nodiscard]] std::uint64_t work() const { return 2 * camera + shadow + 2 * (reflection + refraction); }
    RayCounts& operator+=(const RayCounts& o) {
        camera += o.camera;
        shadow += o.shadow;
        reflection += o.reflection;
        refraction += o.refraction;
        non_finite += o.non_finite;
        depth_cut += o.depth_cut;
        depth_cut_weight += o.depth_cut_weight;
        weight_cut += o.weight_cut;
        weight_cut_weight += o.weight_cut_weight;
        return *this;
    }
};

}  // namespace glint
