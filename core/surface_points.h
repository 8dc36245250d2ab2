// The surface points of many hits at once, structure of arrays, so that a processor's vectors can compute and read them.
// Knows no light. Invariant: each is find_surface_point() of its ray and hit, to the bit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "accel/ray_batch.h"
#include "core/surface_point.h"

namespace glint {

// Three rows are the components of vectors.
using Rows = float[3][kRayBatch];
[[nodiscard, gnu::always_inline]] inline glm::vec3 vector_at(const Rows& rows, std::size_t k) {
    return {rows[0][k], rows[1][k], rows[2][k]};
}
[[gnu::always_inline]] inline void set_vector(Rows& rows, std::size_t k, glm::vec3 v) {
    rows[0][k] = v.x, rows[1][k] = v.y, rows[2][k] = v.z;
}

// The fields of SurfacePoint.
struct alignas(64) SurfacePoints {
    float p[3][kRayBatch], ng[3][kRayBatch], ns[3][kRayBatch];
    float error[kRayBatch], error_from_afar[kRayBatch];
    std::uint32_t outside[kRayBatch], material[kRayBatch];
    // Whether any point may have a lift. If not, the rows below say nothing: no lifts, and every horizon is `ng`.
    bool smooth = false;
    float lift[3][kRayBatch], horizon[3][kRayBatch], bend[kRayBatch];

    [[nodiscard]] const Rows& horizons() const { return smooth ? horizon : ng; }
    [[nodiscard]] SurfacePoint operator[](std::size_t k) const {
        SurfacePoint s{vector_at(p, k), vector_at(ng, k),   vector_at(ns, k), outside[k] != 0,
                       error[k],        error_from_afar[k], material[k]};
        if (smooth) s.lift = vector_at(lift, k), s.bend = bend[k];
        return s;
    }
    // To be called before the first point with a lift is set. What had been set up to here has none.
    void become_smooth() {
        if (smooth) return;
        smooth = true;
        set_flat(0, kRayBatch);
    }
    // To be called for points whose other fields are set, where they have no lift.
    void set_flat(std::size_t first, std::size_t n) {
        if (!smooth) return;
        for (int i = 0; i < 3; ++i) {
            std::fill_n(lift[i] + first, n, 0.0f);
            std::copy_n(ng[i] + first, n, horizon[i] + first);
        }
        std::fill_n(bend + first, n, 0.0f);
    }
    void set(std::size_t k, const SurfacePoint& s) {
        for (int i = 0; i < 3; ++i) p[i][k] = s.p[i], ng[i][k] = s.ng[i], ns[i][k] = s.ns[i];
        error[k] = s.error;
        error_from_afar[k] = s.error_from_afar;
        outside[k] = s.outside ? 1 : 0;
        material[k] = s.material;
        if (s.lift != glm::vec3(0.0f)) become_smooth();
        if (!smooth) return;
        set_vector(lift, k, s.lift);
        bend[k] = s.bend;
        set_vector(horizon, k, glint::horizon(s));
    }
};

// Point k is that of ray and hit lanes[k]; all of these must be found.
void find_surface_points(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                         SurfacePoints& points) noexcept;

}  // namespace glint
