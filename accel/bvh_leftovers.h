// Rays of groups that did not share a dominant axis, gathered anew by axis and sign: where a bundle straddles a diagonal,
// neighbours differ in nothing else. Invariant: every ray added is handed out once, with its place in the batch it came from.
#pragma once

#include <cmath>

#include "accel/ray_batch.h"
#include "accel/simd.h"

namespace glint::GLINT_ISA {

class Leftovers {
public:
    void add(const RayBatch& rays, int first, int count) noexcept {
        for (int i = first; i < first + count; ++i) {
            const float x = std::fabs(rays.direction[0][i]), y = std::fabs(rays.direction[1][i]),
                        z = std::fabs(rays.direction[2][i]);
            const int axis = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
            const int key = 2 * axis + (rays.direction[axis][i] > 0.0f ? 1 : 0);
            index_[key][count_[key]++] = static_cast<std::uint16_t>(i);
        }
    }
    // Calls trace(batch, index, count) for the rays of each key.
    template <class Trace>
    void hand_out(const RayBatch& rays, Trace trace) const noexcept {
        for (int key = 0; key < kKeys; ++key) {
            const int n = count_[key];
            if (n == 0) continue;
            RayBatch batch;
            batch.count = n;
            batch.order = RayOrder::coherent;
            for (int k = 0; k < n; ++k) {
                const int i = index_[key][k];
                for (int axis = 0; axis < 3; ++axis) {
                    batch.origin[axis][k] = rays.origin[axis][i];
                    batch.direction[axis][k] = rays.direction[axis][i];
                }
                batch.t_max[k] = rays.t_max[i];
            }
            trace(batch, index_[key], n);
        }
    }

private:
    static constexpr int kKeys = 6;
    std::uint16_t index_[kKeys][kRayBatch];
    int count_[kKeys] = {};
};

}  // namespace glint::GLINT_ISA
