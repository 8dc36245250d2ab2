// The surface points of many hits at once, structure of arrays, so that a processor's vectors can compute and read them.
// Knows no light. Invariant: each is find_surface_point() of its ray and hit, to the bit.
#pragma once

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

    [[nodiscard]] SurfacePoint operator[](std::size_t k) const {
        return {vector_at(p, k), vector_at(ng, k), vector_at(ns, k), outside[k] != 0, error[k], error_from_afar[k], material[k]};
    }
    void set(std::size_t k, const SurfacePoint& s) {
        for (int i = 0; i < 3; ++i) p[i][k] = s.p[i], ng[i][k] = s.ng[i], ns[i][k] = s.ns[i];
        error[k] = s.error;
        error_from_afar[k] = s.error_from_afar;
        outside[k] = s.outside ? 1 : 0;
        material[k] = s.material;
    }
};

// Point k is that of ray and hit lanes[k]; all of these must be found.
void find_surface_points(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                         SurfacePoints& points) noexcept;

}  // namespace glint
