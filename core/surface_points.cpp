#include "core/surface_points.h"

#include "accel/isa.h"
#include "core/surface_formulas.h"

namespace glint {
namespace {

using namespace surface;

constexpr std::size_t kRun = 8;     // hits at once
constexpr std::size_t kFewest = 3;  // triangles of a run; fewer are computed one by one
static_assert(kRayBatch % kRun == 0, "a run may write behind the last point");

using Row = float[kRun];

// What points on triangles and spheres are computed from.
struct Triangles {
    Row direction[3], corner[3][3], normal[3][3], u, v;
};
struct Spheres {
    Row origin[3], direction[3], center[3], t, radius;
};

[[gnu::always_inline]] inline glm::dvec3 at(const Row (&rows)[3], std::size_t k) {
    return {static_cast<double>(rows[0][k]), static_cast<double>(rows[1][k]), static_cast<double>(rows[2][k])};
}

[[gnu::always_inline]] inline void put(const Rounded& s, SurfacePoints& points, std::size_t k) {
    points.p[0][k] = s.p.x, points.p[1][k] = s.p.y, points.p[2][k] = s.p.z;
    points.ng[0][k] = s.ng.x, points.ng[1][k] = s.ng.y, points.ng[2][k] = s.ng.z;
    points.ns[0][k] = s.ns.x, points.ns[1][k] = s.ns.y, points.ns[2][k] = s.ns.z;
    points.error[k] = s.error;
    points.error_from_afar[k] = s.error_from_afar;
    points.outside[k] = s.outside ? 1u : 0u;
}

template <bool kSmooth>
[[gnu::always_inline]] inline void on_triangles(const Triangles& in, SurfacePoints& points, std::size_t first) {
#pragma GCC ivdep
    for (std::size_t k = 0; k < kRun; ++k) {
        const double u = static_cast<double>(in.u[k]), v = static_cast<double>(in.v[k]);
        Exact e = on_triangle(at(in.corner[0], k), at(in.corner[1], k), at(in.corner[2], k), u, v);
        if constexpr (kSmooth) {
            e.ns = shading_normal(e.ng, at(in.normal[0], k), at(in.normal[1], k), at(in.normal[2], k), u, v);
        }
        put(finished(e, at(in.direction, k)), points, first + k);
    }
}

[[gnu::always_inline]] inline void on_spheres(const Spheres& in, SurfacePoints& points, std::size_t first) {
#pragma GCC ivdep
    for (std::size_t k = 0; k < kRun; ++k) {
        const glm::dvec3 d = at(in.direction, k), near = at(in.origin, k) + static_cast<double>(in.t[k]) * d;
        put(finished(on_sphere(at(in.center, k), static_cast<double>(in.radius[k]), near), d), points, first + k);
    }
}

[[gnu::target("avx2")]] void flat_triangles_avx2(const Triangles& in, SurfacePoints& points, std::size_t first) {
    on_triangles<false>(in, points, first);
}
[[gnu::target("avx2")]] void smooth_triangles_avx2(const Triangles& in, SurfacePoints& points, std::size_t first) {
    on_triangles<true>(in, points, first);
}
[[gnu::target("avx2")]] void spheres_avx2(const Spheres& in, SurfacePoints& points, std::size_t first) {
    on_spheres(in, points, first);
}

inline void gather(const std::vector<glm::vec3>& from, const std::array<std::uint32_t, 3>& index, Row (&to)[3][3],
                   std::size_t k) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const glm::vec3& v = from[index[corner]];
        to[corner][0][k] = v.x, to[corner][1][k] = v.y, to[corner][2][k] = v.z;
    }
}

// Asks memory for what the hit triangles are made of, all at once rather than one after the other.
// Inlined, since GCC drops calls of functions that only prefetch.
[[gnu::always_inline]] inline void fetch_triangles(const Scene& scene, const HitBatch& hits,
                                                   std::span<const std::uint32_t> lanes) {
    const Geometry& g = *scene.geometry;
    const auto& materials = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)];
    for (const std::uint32_t lane : lanes) {
        if (kind_of(hits.primitive[lane]) != PrimitiveKind::triangle) continue;
        const std::uint32_t i = index_of(hits.primitive[lane]);
        __builtin_prefetch(&g.triangles[i]);
        __builtin_prefetch(&materials[i]);
    }
}
[[gnu::always_inline]] inline void fetch_corners(const Scene& scene, const HitBatch& hits, std::span<const std::uint32_t> lanes) {
    const Geometry& g = *scene.geometry;
    for (const std::uint32_t lane : lanes) {
        if (kind_of(hits.primitive[lane]) != PrimitiveKind::triangle) continue;
        for (const std::uint32_t v : g.triangles[index_of(hits.primitive[lane])]) __builtin_prefetch(&g.vertices[v]);
    }
}

// How many of the hits are on primitives of this kind.
std::size_t count(const HitBatch& hits, std::span<const std::uint32_t> lanes, PrimitiveKind kind) {
    std::size_t n = 0;
    for (const std::uint32_t lane : lanes) n += kind_of(hits.primitive[lane]) == kind ? 1 : 0;
    return n;
}

// Up to kRun hits, of which those on triangles are set; the others get numbers without meaning.
void set_triangles(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                   SurfacePoints& points, std::size_t first) {
    const Geometry& g = *scene.geometry;
    const bool smooth = !scene.normals.empty();
    Triangles in{};
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        const std::uint32_t lane = lanes[k];
        if (kind_of(hits.primitive[lane]) != PrimitiveKind::triangle) continue;
        const std::uint32_t i = index_of(hits.primitive[lane]);
        gather(g.vertices, g.triangles[i], in.corner, k);
        if (smooth) gather(scene.normals, g.triangles[i], in.normal, k);
        for (int axis = 0; axis < 3; ++axis) in.direction[axis][k] = rays.direction[axis][lane];
        in.u[k] = hits.u[lane];
        in.v[k] = hits.v[lane];
        points.material[first + k] = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)][i];
    }
    smooth ? smooth_triangles_avx2(in, points, first) : flat_triangles_avx2(in, points, first);
}

// The same of hits that are all on spheres.
void set_spheres(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                 SurfacePoints& points, std::size_t first) {
    Spheres in{};
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        const std::uint32_t lane = lanes[k], i = index_of(hits.primitive[lane]);
        const Sphere& sphere = scene.geometry->spheres[i];
        for (int axis = 0; axis < 3; ++axis) {
            in.origin[axis][k] = rays.origin[axis][lane];
            in.direction[axis][k] = rays.direction[axis][lane];
            in.center[axis][k] = sphere.center[axis];
        }
        in.t[k] = hits.t[lane];
        in.radius[k] = sphere.radius;
        points.material[first + k] = scene.material_of[static_cast<std::size_t>(PrimitiveKind::sphere)][i];
    }
    spheres_avx2(in, points, first);
}

}  // namespace

void find_surface_points(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                         SurfacePoints& points) noexcept {
    const bool vectors = isa_in_use() != Isa::baseline;
    if (vectors) {
        fetch_triangles(scene, hits, lanes);
        fetch_corners(scene, hits, lanes);
    }
    for (std::size_t first = 0; first < lanes.size(); first += kRun) {
        const auto run = lanes.subspan(first, std::min(kRun, lanes.size() - first));
        std::size_t triangles = 0;
        if (vectors) {
            if (count(hits, run, PrimitiveKind::sphere) == run.size()) {
                set_spheres(scene, rays, hits, run, points, first);
                continue;
            }
            triangles = count(hits, run, PrimitiveKind::triangle);
            if (triangles >= kFewest) set_triangles(scene, rays, hits, run, points, first);
            if (triangles == run.size() && triangles >= kFewest) continue;
        }
        for (std::size_t k = 0; k < run.size(); ++k) {
            const Ray ray = rays[static_cast<int>(run[k])];
            const Hit hit = hits[static_cast<int>(run[k])];
            if (triangles >= kFewest && kind_of(hit.primitive) == PrimitiveKind::triangle) continue;
            points.set(first + k, surface_point(scene, ray, hit));
        }
    }
}

}  // namespace glint
