// The rays a renderer asks for, by kind, made once for a scene and then traced by every competitor.
// Knows no competitor but the BVH that finds the visible points. Invariant: rays of neighbouring samples and pixels are
// neighbours; 64 rays of one sample a pixel are a tile of 8x8 pixels, 256 are one of 16x16.
#pragma once

#include <string>
#include <vector>

#include "accel/bvh.h"
#include "bench_scene.h"

namespace glint::bench {

struct RaySet {
    std::string name;
    bool any = false;  // shadow rays: is there a hit at all?
    RayOrder order = RayOrder::divergent;
    std::vector<Ray> rays;
    std::vector<RayBatch> batches;  // the same rays, structure of arrays, for those who trace many at once

    void make_batches() {
        for (std::size_t at = 0; at < rays.size(); at += kRayBatch) {
            batches.emplace_back().clear(order);
            batches.back().assign(&rays[at], static_cast<int>(std::min<std::size_t>(kRayBatch, rays.size() - at)));
        }
    }
};

// `thin`: only every thin-th tile of 16x16 pixels is traced; 1 = all.
[[nodiscard]] std::vector<RaySet> make_ray_sets(const BenchScene& scene, const Bvh& bvh, int thin);

}  // namespace glint::bench
