// How light divides at the glass among the vertices of a wave, and the two rays that may go on from each.
// Knows no branches and no media: the ratio of the indices is handed in. Invariant: each vertex gets what the formulas of
// fresnel.h and surface_point.h give it alone, to the bit.
#pragma once

#include <cstdint>

#include "accel/ray_batch.h"
#include "core/settings.h"
#include "core/vertices.h"

namespace glint {

struct alignas(64) Glass {
    // To be set: of each vertex whether it is of glass, and then the index on the ray's side over that beyond.
    std::uint32_t any[kRayBatch];
    double eta[kRayBatch];

    // Found where there is glass. Both origins, that of the reflected and that of the refracted ray.
    double reflected[kRayBatch];  // the part of the light
    std::uint32_t transmits[kRayBatch];
    float mirrored[3][kRayBatch], refracted[3][kRayBatch];
    float here[3][kRayBatch], beyond[3][kRayBatch];

    void divide(Fresnel fresnel, const Vertices& vertices) noexcept;
};

}  // namespace glint
