// Bounds of primitives as the builders want them. Invariant: those of Geometry::bounds().
#pragma once

#include "accel/bvh_split.h"

namespace glint {

// Calls use(i, id) for the primitives from first to last - 1 of all bounded ones, in ascending order of ids.
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

// x, y, z and 0, without reading behind the last vertex.
inline __m128 load_vertex(const glm::vec3& v) {
    const __m128 xy = _mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(&v.x));
    return _mm_movelh_ps(xy, _mm_load_ss(&v.z));
}

// Asks for a triangle's indices, or for the vertices when those are there: in the order of a tree neither lies behind the last.
inline void fetch_indices(const Geometry& geometry, PrimitiveId id) {
    if (kind_of(id) == PrimitiveKind::triangle) _mm_prefetch(geometry.triangles.data() + index_of(id), _MM_HINT_T0);
}
inline void fetch_vertices(const Geometry& geometry, PrimitiveId id) {
    if (kind_of(id) != PrimitiveKind::triangle) return;
    for (const std::uint32_t v : geometry.triangles[index_of(id)]) _mm_prefetch(geometry.vertices.data() + v, _MM_HINT_T0);
}

inline Box4 bounds_of(const Geometry& geometry, PrimitiveId id) {
    if (kind_of(id) == PrimitiveKind::triangle) {
        const std::array<std::uint32_t, 3>& t = geometry.triangles[index_of(id)];
        const __m128 a = load_vertex(geometry.vertices[t[0]]), b = load_vertex(geometry.vertices[t[1]]);
        const __m128 c = load_vertex(geometry.vertices[t[2]]);
        return {_mm_min_ps(_mm_min_ps(a, b), c), _mm_max_ps(_mm_max_ps(a, b), c)};
    }
    const Aabb box = geometry.bounds(id);
    return {load_vertex(box.lo), load_vertex(box.hi)};
}

// Put together in registers: four bytes stored into sixteen would hold up whoever loads them.
inline BuildRef make_ref(const Box4& box, std::uint32_t id, float weight) {
    const __m128 corner = _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0));
    const __m128i id4 = _mm_cvtsi32_si128(static_cast<int>(id)), weight4 = _mm_castps_si128(_mm_set_ss(weight));
    BuildRef r;
    _mm_store_ps(r.lo, _mm_or_ps(_mm_and_ps(box.lo, corner), _mm_castsi128_ps(_mm_slli_si128(id4, 12))));
    _mm_store_ps(r.hi, _mm_or_ps(_mm_and_ps(box.hi, corner), _mm_castsi128_ps(_mm_slli_si128(weight4, 12))));
    return r;
}

// One for each bounded primitive, in ascending order of ids.
[[nodiscard]] inline BuildRefs make_refs(const Geometry& geometry, const ParallelFor& parallel_for) {
    BuildRefs refs(geometry.bounded_count());
    parallel_for(chunks_of(refs.size()), [&](std::size_t i) {
        for_primitives(geometry, i * kChunk, (i + 1) * kChunk,
                       [&](std::size_t at, PrimitiveId id) { refs[at] = make_ref(bounds_of(geometry, id), id, 1.0f); });
    });
    return refs;
}

}  // namespace glint
