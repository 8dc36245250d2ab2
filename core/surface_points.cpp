#include "core/surface_points.h"

#include "accel/isa.h"
#include "core/corner_rows.h"
#include "core/surface_formulas.h"

namespace glint {
namespace {

using namespace surface;

constexpr std::size_t kRun = kCornerRun;  // hits at once
constexpr std::size_t kFewest = 3;        // triangles of a run; fewer are computed one by one
static_assert(kRayBatch % kRun == 0, "a run may write behind the last point");

using Row = float[kRun];

// What points on triangles and spheres are computed from.
struct alignas(32) Triangles {
    CornerRows corner, normal;
    Row direction[3], u, v;
};
struct Spheres {
    Row origin[3], direction[3], center[3], t, radius;
};

[[gnu::always_inline]] inline glm::dvec3 at(const Row (&rows)[3], std::size_t k) {
    return {static_cast<double>(rows[0][k]), static_cast<double>(rows[1][k]), static_cast<double>(rows[2][k])};
}

template <bool kSmooth>
[[gnu::always_inline]] inline void put(const Rounded& s, SurfacePoints& points, std::size_t k) {
    set_vector(points.p, k, s.p);
    set_vector(points.ng, k, s.ng);
    set_vector(points.ns, k, s.ns);
    points.error[k] = s.error;
    points.error_from_afar[k] = s.error_from_afar;
    points.outside[k] = s.outside ? 1u : 0u;
    if constexpr (kSmooth) {
        set_vector(points.lift, k, s.lift);
        points.bend[k] = s.bend;
        set_vector(points.horizon, k, horizon(s.ng, s.ns, s.lift));
    }
}

template <bool kSmooth>
[[gnu::always_inline]] inline void on_triangles(const Triangles& in, SurfacePoints& points, std::size_t first) {
#pragma GCC ivdep
    for (std::size_t k = 0; k < kRun; ++k) {
        const double u = static_cast<double>(in.u[k]), v = static_cast<double>(in.v[k]);
        const glm::dvec3 a = at(in.corner[0], k), b = at(in.corner[1], k), c = at(in.corner[2], k), d = at(in.direction, k);
        Exact e = on_triangle(a, b, c, u, v);
        if constexpr (kSmooth) {
            const glm::dvec3 na = at(in.normal[0], k), nb = at(in.normal[1], k), nc = at(in.normal[2], k);
            e.ns = shading_normal(e.ng, na, nb, nc, u, v);
            e.lift = tangent_lift(e, d, u, v, a, b, c, na, nb, nc);
            e.bend = bend(e.ng, na, nb, nc);
        }
        put<kSmooth>(finished(e, d), points, first + k);
    }
}

[[gnu::always_inline]] inline void on_spheres(const Spheres& in, SurfacePoints& points, std::size_t first) {
#pragma GCC ivdep
    for (std::size_t k = 0; k < kRun; ++k) {
        const glm::dvec3 d = at(in.direction, k), near = at(in.origin, k) + static_cast<double>(in.t[k]) * d;
        put<false>(finished(on_sphere(at(in.center, k), static_cast<double>(in.radius[k]), near), d), points, first + k);
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

// The numbers of a run of rays, which are mostly neighbours; behind the last it stands again.
inline void read(const float* from, std::span<const std::uint32_t> lanes, Row& to) {
    if (lanes.size() == kRun && lanes.back() - lanes.front() == kRun - 1) {
        std::copy_n(from + lanes.front(), kRun, to);
    } else {
        for (std::size_t k = 0; k < kRun; ++k) to[k] = from[lanes[std::min(k, lanes.size() - 1)]];
    }
}

// Asks memory for what the hit triangles are made of, all at once rather than one after the other; says whether all are such.
// Inlined, since GCC drops calls of functions that only prefetch.
[[gnu::always_inline]] inline bool fetch_triangles(const Scene& scene, const HitBatch& hits,
                                                   std::span<const std::uint32_t> lanes) {
    const Geometry& g = *scene.geometry;
    const auto& materials = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)];
    std::size_t triangles = 0;
    for (const std::uint32_t lane : lanes) {
        if (kind_of(hits.primitive[lane]) != PrimitiveKind::triangle) continue;
        const std::uint32_t i = index_of(hits.primitive[lane]);
        __builtin_prefetch(&g.triangles[i]);
        __builtin_prefetch(&materials[i]);
        ++triangles;
    }
    if (triangles == 0) return false;
    for (const std::uint32_t lane : lanes) {
        if (kind_of(hits.primitive[lane]) != PrimitiveKind::triangle) continue;
        for (const std::uint32_t v : g.triangles[index_of(hits.primitive[lane])]) __builtin_prefetch(&g.vertices[v]);
    }
    return triangles == lanes.size();
}

// How many of the hits are on primitives of this kind.
std::size_t count(const HitBatch& hits, std::span<const std::uint32_t> lanes, PrimitiveKind kind) {
    std::size_t n = 0;
    for (const std::uint32_t lane : lanes) n += kind_of(hits.primitive[lane]) == kind ? 1 : 0;
    return n;
}

// Up to kRun hits, of which those on triangles are set, at least one; the others get numbers without meaning.
void set_triangles(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                   SurfacePoints& points, std::size_t first) {
    const Geometry& g = *scene.geometry;
    const std::uint32_t* material = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)].data();
    // Where there is no triangle, another one of the run is read.
    std::uint32_t triangle[kRun], some = 0;
    for (const std::uint32_t lane : lanes) {
        if (kind_of(hits.primitive[lane]) == PrimitiveKind::triangle) some = index_of(hits.primitive[lane]);
    }
    for (std::size_t k = 0; k < kRun; ++k) {
        const PrimitiveId id = hits.primitive[lanes[std::min(k, lanes.size() - 1)]];
        triangle[k] = kind_of(id) == PrimitiveKind::triangle ? index_of(id) : some;
        points.material[first + k] = material[triangle[k]];
    }
    Triangles in;
    read_corners_avx2(g.vertices, g.triangles, triangle, in.corner);
    for (int axis = 0; axis < 3; ++axis) read(rays.direction[axis], lanes, in.direction[axis]);
    read(hits.u, lanes, in.u);
    read(hits.v, lanes, in.v);
    if (scene.normals.empty()) {
        flat_triangles_avx2(in, points, first);
        return points.set_flat(first, kRun);
    }
    read_corners_avx2(scene.normals, g.triangles, triangle, in.normal);
    points.become_smooth();
    smooth_triangles_avx2(in, points, first);
}

// The same of hits that are all on spheres.
void set_spheres(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                 SurfacePoints& points, std::size_t first) {
    const std::uint32_t* material = scene.material_of[static_cast<std::size_t>(PrimitiveKind::sphere)].data();
    Spheres in;
    for (std::size_t k = 0; k < kRun; ++k) {
        const std::uint32_t i = index_of(hits.primitive[lanes[std::min(k, lanes.size() - 1)]]);
        const Sphere& sphere = scene.geometry->spheres[i];
        for (int axis = 0; axis < 3; ++axis) in.center[axis][k] = sphere.center[axis];
        in.radius[k] = sphere.radius;
        points.material[first + k] = material[i];
    }
    for (int axis = 0; axis < 3; ++axis) {
        read(rays.origin[axis], lanes, in.origin[axis]);
        read(rays.direction[axis], lanes, in.direction[axis]);
    }
    read(hits.t, lanes, in.t);
    spheres_avx2(in, points, first);
    points.set_flat(first, kRun);
}

}  // namespace

void find_surface_points(const Scene& scene, const RayBatch& rays, const HitBatch& hits, std::span<const std::uint32_t> lanes,
                         SurfacePoints& points) noexcept {
    const bool vectors = isa_in_use() != Isa::baseline;
    points.smooth = false;
    const bool all_triangles = vectors && fetch_triangles(scene, hits, lanes);
    for (std::size_t first = 0; first < lanes.size(); first += kRun) {
        const auto run = lanes.subspan(first, std::min(kRun, lanes.size() - first));
        std::size_t triangles = 0;
        if (all_triangles && run.size() >= kFewest) {
            set_triangles(scene, rays, hits, run, points, first);
            continue;
        }
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
