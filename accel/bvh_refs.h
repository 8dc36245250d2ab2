// Bounds of primitives as the builders want them. Invariant: those of Geometry::bounds().
#pragma once

#include "accel/bvh_split.h"

namespace glint {

// Adds no id twice: calls use(i, id) for the primitives from first to last - 1 of all bounded ones, in ascending order of ids.
template <class Use>
void for_primitives(const Geometry& geometry, std::size_t first, std::size_t last, const Use& use) {
    std::size_t begin = 0;
    for (const auto kind : {PrimitiveKind::triangle, PrimitiveKind::sphere, PrimitiveKind::box, PrimitiveKind::cone}) {
        const std::size_t end = begin + geometry.count(kind);
        for (std::size_t i = std::max(begin, first); i < std::min(end, last); ++i)
            use(i, make_id(kind, static_cast<std::uint32_t>(i - begin)));
        begin = end;
    }
}

inline BuildRef make_ref(const Geometry& geometry, PrimitiveId id) {
    BuildRef r;
    if (kind_of(id) == PrimitiveKind::triangle) {
        const std::array<std::uint32_t, 3>& t = geometry.triangles[index_of(id)];
        const glm::vec3 &a = geometry.vertices[t[0]], &b = geometry.vertices[t[1]], &c = geometry.vertices[t[2]];
        for (int axis = 0; axis < 3; ++axis) {
            r.lo[axis] = std::min(std::min(a[axis], b[axis]), c[axis]);
            r.hi[axis] = std::max(std::max(a[axis], b[axis]), c[axis]);
        }
    } else {
        const Aabb box = geometry.bounds(id);
        for (int axis = 0; axis < 3; ++axis) r.lo[axis] = box.lo[axis], r.hi[axis] = box.hi[axis];
    }
    r.id = id;
    r.weight = 1.0f;
    return r;
}

// One for each bounded primitive, in ascending order of ids.
[[nodiscard]] inline BuildRefs make_refs(const Geometry& geometry, const ParallelFor& parallel_for) {
    BuildRefs refs(geometry.bounded_count());
    parallel_for(chunks_of(refs.size()), [&](std::size_t i) {
        for_primitives(geometry, i * kChunk, (i + 1) * kChunk,
                       [&](std::size_t at, PrimitiveId id) { refs[at] = make_ref(geometry, id); });
    });
    return refs;
}

}  // namespace glint
