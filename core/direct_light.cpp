#include "core/direct_light.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "accel/isa.h"
#include "core/light_formulas.h"
#include "core/ranks.h"

namespace glint {
namespace {

using namespace light_formulas;

constexpr std::size_t kRun = kRunOfVertices;

// How a light is sampled: each with a loop of its own; the rare ones point by point.
enum class Source { plain, plain_physical, spread, quad, physical_quad, physical_sphere, other };

Source source_of(const Light& light) {
    const bool physical = light.falloff == Light::Falloff::physical;
    switch (light.shape) {
        case Light::Shape::point:
            if (!physical) return light.has_area() ? Source::spread : Source::plain;
            // A point that shines alike in all directions, however far.
            if (!light.has_area() && light.cos_outer < -1.0f && !(light.range > 0.0f)) return Source::plain_physical;
            break;
        case Light::Shape::quad: return physical ? Source::physical_quad : Source::quad;
        case Light::Shape::sphere: return physical ? Source::physical_sphere : Source::other;
        case Light::Shape::directional: break;
    }
    return Source::other;
}

template <Source kSource>
[[gnu::always_inline]] inline LightSample sample(const Light& light, glm::vec3 p, glm::vec2 u) {
    if constexpr (kSource == Source::plain) return plain_point<false>(light, p);
    if constexpr (kSource == Source::plain_physical) return plain_point<true>(light, p);
    if constexpr (kSource == Source::spread) return everywhere_alike(light, spread_point(light, u), p);
    if constexpr (kSource == Source::quad) return everywhere_alike(light, quad_point(light, u), p);
    if constexpr (kSource == Source::physical_quad) return physical_quad(light, p, u);
    if constexpr (kSource == Source::physical_sphere) return physical_sphere(light, p, u);
    return sample_light(light, p, u);
}

// Kinds of shadow rays, likewise.
enum class Cast { from_light, to_infinity, to_point, to_quad, to_sphere };

Cast cast_of(const Light& light, bool starts_at_light) {
    if (starts_at_light) return Cast::from_light;
    if (light.shape == Light::Shape::directional) return Cast::to_infinity;
    if (!light.has_area()) return Cast::to_point;
    return light.shape == Light::Shape::sphere ? Cast::to_sphere : Cast::to_quad;
}

}  // namespace

// The loops over a run of vertices; always inlined into a function for an instruction set.
struct DirectLightLoops {
    template <Source kSource>
    [[gnu::always_inline]] static inline void sample_run(DirectLight& d, const Light& light, const Vertices& v,
                                                         std::size_t first) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + kRun; ++k) {
            const LightSample s = sample<kSource>(light, vector_at(v.points.p, k), glm::vec2(d.u[0][k], d.u[1][k]));
            set_vector(d.wi_, k, s.wi);
            if constexpr (kSource != Source::plain && kSource != Source::plain_physical) set_vector(d.point_, k, s.point);
            set_vector(d.light_, k, s.arriving);
        }
    }

    // Leaves the cosines of the highlights, 0 where none shows.
    [[gnu::always_inline]] static inline void highlight_run(DirectLight& d, const Vertices& v, std::size_t first) {
        const Rows& horizon = v.points.horizons();
#pragma GCC ivdep
        for (std::size_t k = first; k < first + kRun; ++k) {
            const glm::vec3 wi = vector_at(d.wi_, k), h = vector_at(v.wo, k) + wi;
            const float h2 = glm::dot(h, h);
            const float n_h = glm::dot(vector_at(v.points.ns, k), h) / std::sqrt(h2);
            const bool shows = (v.highlit[k] != 0) & (h2 > 0.0f) & (n_h > 0.0f) &
                               (glm::dot(vector_at(v.points.ns, k), wi) > 0.0f) & (glm::dot(vector_at(horizon, k), wi) > 0.0f);
            d.highlight_[k] = shows ? n_h : 0.0f;
        }
    }

    template <bool kHighlights>
    [[gnu::always_inline]] static inline void reflect_run(DirectLight& d, const Vertices& v, std::size_t first) {
        const Rows& horizon = v.points.horizons();
#pragma GCC ivdep
        for (std::size_t k = first; k < first + kRun; ++k) {
            const glm::vec3 wi = vector_at(d.wi_, k);
            const float n_l = glm::dot(vector_at(v.points.ns, k), wi);
            // Both terms need the light above the surface; a highlight on the dark side is a classic slip.
            const bool above = (n_l > 0.0f) & (glm::dot(vector_at(horizon, k), wi) > 0.0f) & (v.lit[k] != 0);
            glm::vec3 reflectance = vector_at(v.diffuse, k) * n_l;
            if constexpr (kHighlights) reflectance += vector_at(v.specular, k) * d.highlight_[k];
            const glm::vec3 light = where(above, vector_at(d.light_, k) * reflectance);
            set_vector(d.light_, k, light);
            d.shows_[k] = (light.x != 0.0f) | (light.y != 0.0f) | (light.z != 0.0f) ? ~0u : 0u;
        }
    }

    template <Source kSource>
    [[gnu::always_inline]] static inline void reflect(DirectLight& d, const Light& of, const Vertices& v) {
        const Light light = of;  // a copy that no store can change: its fields stay in registers
        for (std::size_t first = 0; first < v.count; first += kRun) {
            sample_run<kSource>(d, light, v, first);
            if (!v.any_highlit) {
                reflect_run<false>(d, v, first);
                continue;
            }
            highlight_run(d, v, first);
            for (std::size_t k = first; k < first + kRun; ++k) {
                if (d.highlight_[k] > 0.0f) d.highlight_[k] = v.highlight_scale[k] * std::pow(d.highlight_[k], v.shininess[k]);
            }
            reflect_run<true>(d, v, first);
        }
    }

    [[gnu::always_inline]] static inline void reflect(DirectLight& d, Source source, const Light& light, const Vertices& v) {
        switch (source) {
            case Source::plain: return reflect<Source::plain>(d, light, v);
            case Source::plain_physical: return reflect<Source::plain_physical>(d, light, v);
            case Source::spread: return reflect<Source::spread>(d, light, v);
            case Source::quad: return reflect<Source::quad>(d, light, v);
            case Source::physical_quad: return reflect<Source::physical_quad>(d, light, v);
            case Source::physical_sphere: return reflect<Source::physical_sphere>(d, light, v);
            case Source::other: return reflect<Source::other>(d, light, v);
        }
    }
    [[gnu::target("avx2")]] static void reflect_avx2(DirectLight& d, Source source, const Light& light, const Vertices& v) {
        reflect(d, source, light, v);
    }

    // The rays of a run, see shadow_ray(), in the vertices' places.
    template <Cast kCast>
    [[gnu::always_inline]] static inline void cast_run(const DirectLight& d, const Light& light, const SurfacePoints& points,
                                                       std::size_t first, RayBatch& rays) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + kRun; ++k) {
            SurfacePoint s;
            s.p = vector_at(points.p, k);
            s.ng = vector_at(points.ng, k);
            s.error = points.error[k];
            s.error_from_afar = points.error_from_afar[k];
            if constexpr (kCast == Cast::from_light) {
                set_vector(rays.direction, k, direction_to(s, light.position));
                continue;
            }
            const glm::vec3 origin = spawn_origin(s, s.ng);
            set_vector(rays.origin, k, origin);
            if constexpr (kCast == Cast::to_infinity) {
                set_vector(rays.direction, k, vector_at(d.wi_, k));
                continue;
            }
            const glm::vec3 direction = (kCast == Cast::to_point ? light.position : vector_at(d.point_, k)) - origin;
            set_vector(rays.direction, k, direction);
            rays.t_max[k] = kCast == Cast::to_point    ? reach_of_point(light, origin, direction)
                            : kCast == Cast::to_sphere ? reach_of_sphere(light, origin, direction)
                                                       : reach_of_quad(light, origin, direction);
        }
    }

    template <Cast kCast>
    [[gnu::always_inline]] static inline void cast(const DirectLight& d, const Light& light, const Vertices& v,
                                                   const Ranks& ranks, RayBatch& rays) {
        for (std::size_t first = 0; first < v.count; first += kRun) {
            if (ranks.mask(first / kRun) != 0) cast_run<kCast>(d, light, v.points, first, rays);
        }
    }
    [[gnu::always_inline]] static inline void cast(const DirectLight& d, Cast kind, const Light& light, const Vertices& v,
                                                   const Ranks& ranks, RayBatch& rays) {
        switch (kind) {
            case Cast::from_light: return cast<Cast::from_light>(d, light, v, ranks, rays);
            case Cast::to_infinity: return cast<Cast::to_infinity>(d, light, v, ranks, rays);
            case Cast::to_point: return cast<Cast::to_point>(d, light, v, ranks, rays);
            case Cast::to_quad: return cast<Cast::to_quad>(d, light, v, ranks, rays);
            case Cast::to_sphere: return cast<Cast::to_sphere>(d, light, v, ranks, rays);
        }
    }
    [[gnu::target("avx2")]] static void cast_avx2(const DirectLight& d, Cast kind, const Light& light, const Vertices& v,
                                                  const Ranks& ranks, RayBatch& rays) {
        cast(d, kind, light, v, ranks, rays);
    }

    // arrives: all bits or none.
    [[gnu::always_inline]] static inline void add(const DirectLight& d, const std::uint32_t* arrives, Vertices& v) {
        for (int i = 0; i < 3; ++i) {
#pragma GCC ivdep
            for (std::size_t k = 0; k < whole_runs(v.count); ++k) {
                v.direct[i][k] += std::bit_cast<float>(std::bit_cast<std::uint32_t>(d.light_[i][k]) & arrives[k]);
            }
        }
    }
    [[gnu::target("avx2")]] static void add_avx2(const DirectLight& d, const std::uint32_t* arrives, Vertices& v) {
        add(d, arrives, v);
    }
};

void DirectLight::reflect(const Light& light, const Vertices& vertices) noexcept {
    const Source source = source_of(light);
    if (isa_in_use() == Isa::baseline) return DirectLightLoops::reflect(*this, source, light, vertices);
    DirectLightLoops::reflect_avx2(*this, source, light, vertices);
}

void DirectLight::cast(const Light& light, bool starts_at_light, const Vertices& vertices, RayBatch& rays) noexcept {
    const Ranks ranks(shows_, vertices.count);
    rays_ = ranks.kept();
    lifts_ = 0;
    rays.count = static_cast<int>(rays_);
    if (rays_ == 0) return;
    const Cast kind = cast_of(light, starts_at_light);
    isa_in_use() == Isa::baseline ? DirectLightLoops::cast(*this, kind, light, vertices, ranks, rays)
                                  : DirectLightLoops::cast_avx2(*this, kind, light, vertices, ranks, rays);
    for (int axis = 0; axis < 3; ++axis) {
        ranks.close(rays.direction[axis]);
        if (starts_at_light) {
            std::fill_n(rays.origin[axis], rays_, light.position[axis]);
        } else {
            ranks.close(rays.origin[axis]);
        }
    }
    if (kind == Cast::from_light || kind == Cast::to_infinity) {
        std::fill_n(rays.t_max, rays_, kind == Cast::from_light ? 1.0f : kInfinity);
    } else {
        ranks.close(rays.t_max);
    }
    std::iota(vertex_, vertex_ + vertices.count, 0u);
    ranks.close(vertex_);
    if (vertices.points.smooth) cast_to_lifted(light, starts_at_light, vertices, rays);
}

// Few: where a facet turns away and the rounded surface does not yet. Their rays are replaced.
void DirectLight::cast_to_lifted(const Light& light, bool starts_at_light, const Vertices& vertices, RayBatch& rays) noexcept {
    const SurfacePoints& points = vertices.points;
    LightSample l;
    l.at_infinity = light.shape == Light::Shape::directional;
    for (std::uint32_t n = 0; n < rays_; ++n) {
        const std::uint32_t k = vertex_[n];
        l.wi = vector_at(wi_, k);
        if (!is_low(l.wi, vector_at(points.ng, k), vector_at(points.lift, k), points.bend[k])) continue;
        l.point = light.has_area() ? vector_at(point_, k) : light.position;
        rays.set(n, shadow_ray(light, l, points[k], starts_at_light));
        lift_[lifts_++] = n;
    }
}

bool DirectLight::cast_lifts(const OccludedBatch& blocked, const Vertices& vertices, RayBatch& rays) noexcept {
    rays.clear(RayOrder::coherent);
    const std::size_t lifted_points = std::exchange(lifts_, 0);
    for (std::size_t i = 0; i < lifted_points; ++i) {
        const std::uint32_t n = lift_[i];
        if (blocked[n]) continue;
        lift_[lifts_++] = n;
        rays.push(lift_ray(vertices.points[vertex_[n]]));
    }
    return lifts_ > 0;
}

void DirectLight::block(const OccludedBatch& lifts, OccludedBatch& blocked) const noexcept {
    for (std::size_t i = 0; i < lifts_; ++i) blocked[lift_[i]] = lifts[i];
}

void DirectLight::add(const OccludedBatch& blocked, Vertices& vertices) const noexcept {
    alignas(64) std::uint32_t arrives[kRayBatch] = {};
    for (std::size_t n = 0; n < rays_; ++n) arrives[vertex_[n]] = blocked[n] ? 0u : ~0u;
    if (isa_in_use() == Isa::baseline) return DirectLightLoops::add(*this, arrives, vertices);
    DirectLightLoops::add_avx2(*this, arrives, vertices);
}

void DirectLight::add(Vertices& vertices) const noexcept {
    if (isa_in_use() == Isa::baseline) return DirectLightLoops::add(*this, shows_, vertices);
    DirectLightLoops::add_avx2(*this, shows_, vertices);
}

}  // namespace glint
