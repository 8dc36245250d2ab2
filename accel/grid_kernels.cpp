#include "accel/grid_kernels.h"

#include "accel/grid_walk.h"

// Compiled once per instruction set (CMakeLists.txt says with which flags).
namespace glint::GLINT_ISA {
namespace {

void closest(const GridView& grid, const Ray& ray, Hit& best) noexcept {
    walk_grid<false>(grid, ray, best, [](std::uint32_t, bool) {});
}

bool occluded(const GridView& grid, const Ray& ray) noexcept {
    Hit best;
    best.t = ray.t_max;
    walk_grid<true>(grid, ray, best, [](std::uint32_t, bool) {});
    return best.primitive != kNoPrimitive;
}

void count_closest(const GridView& grid, const Ray& ray, TraversalCounts& counts) noexcept {
    Hit best;
    best.t = ray.t_max;
    ++counts.rays;
    walk_grid<false>(grid, ray, best, [&](std::uint32_t, bool block) { ++(block ? counts.leaves : counts.nodes); });
}

}  // namespace

const GridKernels grid_kernels{closest, occluded, count_closest};

}  // namespace glint::GLINT_ISA
