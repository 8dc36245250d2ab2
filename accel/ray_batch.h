// Many rays at once, structure of arrays, so that an accelerator can trace them together.
// Knows no accelerator. Invariant: the answers are those of one ray at a time, bit for bit; the order only says how to go
// about it and may be wrong at the cost of speed alone.
#pragma once

#include <xmmintrin.h>

#include <array>
#include <cstdint>

#include "accel/ray.h"

namespace glint {

constexpr int kRayBatch = 256;

enum class RayOrder {
    common_origin,  // all rays start at one point, neighbours in the batch at similar angles: a camera, a point light
    coherent,       // neighbours in the batch start and point alike: lenses, area lights, first reflections
    divergent,      // nothing in common
};

struct alignas(64) RayBatch {
    float origin[3][kRayBatch];
    float direction[3][kRayBatch];
    float t_max[kRayBatch];
    int count = 0;
    RayOrder order = RayOrder::divergent;

    void clear(RayOrder o) {
        count = 0;
        order = o;
    }
    void set(std::size_t i, const Ray& ray) {
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis][i] = ray.origin[axis];
            direction[axis][i] = ray.direction[axis];
        }
        t_max[i] = ray.t_max;
    }
    // Precondition: count < kRayBatch.
    void push(const Ray& ray) { set(static_cast<std::size_t>(count++), ray); }
    // The batch is n <= kRayBatch rays in a row: push() for all of them, four at a time.
    void assign(const Ray* rays, int n) {
        static_assert(sizeof(Ray) == 28, "two overlapping loads of four floats read a ray");
        int i = 0;
        for (; i + 4 <= n; i += 4) {
            __m128 a[4], b[4];
            for (int k = 0; k < 4; ++k) {
                a[k] = _mm_loadu_ps(&rays[i + k].origin.x);
                b[k] = _mm_loadu_ps(&rays[i + k].direction.x);
            }
            _MM_TRANSPOSE4_PS(a[0], a[1], a[2], a[3]);
            _MM_TRANSPOSE4_PS(b[0], b[1], b[2], b[3]);
            for (int k = 0; k < 3; ++k) {
                _mm_store_ps(origin[k] + i, a[k]);
                _mm_store_ps(direction[k] + i, b[k]);
            }
            _mm_store_ps(t_max + i, b[3]);
        }
        count = i;
        for (; i < n; ++i) push(rays[i]);
    }
    [[nodiscard]] Ray operator[](int i) const {
        return {{origin[0][i], origin[1][i], origin[2][i]}, {direction[0][i], direction[1][i], direction[2][i]}, t_max[i]};
    }
};

struct alignas(64) HitBatch {
    float t[kRayBatch], u[kRayBatch], v[kRayBatch];
    PrimitiveId primitive[kRayBatch];

    void set(int i, const Hit& hit) {
        t[i] = hit.t;
        u[i] = hit.u;
        v[i] = hit.v;
        primitive[i] = hit.primitive;
    }
    [[nodiscard]] Hit operator[](int i) const { return {t[i], u[i], v[i], primitive[i]}; }
};

using OccludedBatch = std::array<bool, kRayBatch>;

// What an accelerator without a way of its own does: one ray after the other.
template <class A>
void closest_hits_one_by_one(const A& accelerator, const RayBatch& rays, HitBatch& hits) noexcept {
    for (int i = 0; i < rays.count; ++i) hits.set(i, accelerator.closest_hit(rays[i]));
}
template <class A>
void occluded_one_by_one(const A& accelerator, const RayBatch& rays, OccludedBatch& result) noexcept {
    for (int i = 0; i < rays.count; ++i) result[static_cast<std::size_t>(i)] = accelerator.occluded(rays[i]);
}

}  // namespace glint
