#include "accel/bvh_kernels.h"

#include "accel/bvh_single.h"

// Compiled once per instruction set (CMakeLists.txt says with which flags).
namespace glint::GLINT_ISA {
namespace {

void closest(const BvhView& bvh, const Ray& ray, Hit& best) noexcept {
    traverse<false>(bvh, ray, best, [](BvhRef) {});
}

bool occluded(const BvhView& bvh, const Ray& ray) noexcept {
    Hit best;
    best.t = ray.t_max;
    traverse<true>(bvh, ray, best, [](BvhRef) {});
    return best.primitive != kNoPrimitive;
}

void closest_batch(const BvhView& bvh, const RayBatch& rays, HitBatch& hits) noexcept {
    for (int i = 0; i < rays.count; ++i) {
        const Ray ray{{rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                      {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]},
                      rays.t_max[i]};
        Hit best;
        best.t = hits.t[i];
        best.u = hits.u[i];
        best.v = hits.v[i];
        best.primitive = hits.primitive[i];
        closest(bvh, ray, best);
        hits.t[i] = best.t;
        hits.u[i] = best.u;
        hits.v[i] = best.v;
        hits.primitive[i] = best.primitive;
    }
}

void occluded_batch(const BvhView& bvh, const RayBatch& rays, bool* result) noexcept {
    for (int i = 0; i < rays.count; ++i) {
        if (result[i]) continue;
        const Ray ray{{rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
                      {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]},
                      rays.t_max[i]};
        result[i] = occluded(bvh, ray);
    }
}

void count_closest(const BvhView& bvh, const Ray& ray, TraversalCounts& counts) noexcept {
    Hit best;
    best.t = ray.t_max;
    ++counts.rays;
    traverse<false>(bvh, ray, best, [&](BvhRef ref) {
        if ((ref & kLeafBit) == 0) {
            ++counts.nodes;
            return;
        }
        ++counts.leaves;
    });
}

}  // namespace

const BvhKernels kernels{closest, occluded, closest_batch, occluded_batch, count_closest};

}  // namespace glint::GLINT_ISA
