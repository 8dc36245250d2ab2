#include "core/glass.h"

#include <algorithm>

#include "accel/isa.h"
#include "core/fresnel.h"

namespace glint {
namespace {

constexpr std::size_t kRun = kRunOfVertices;

template <Fresnel kFresnel>
[[gnu::always_inline]] inline void divide_run(Glass& g, const SurfacePoints& points, const Rows& outwards, std::size_t first) {
#pragma GCC ivdep
    for (std::size_t k = first; k < first + kRun; ++k) {
        SurfacePoint s;
        s.p = vector_at(points.p, k);
        s.ng = vector_at(points.ng, k);
        s.ns = vector_at(points.ns, k);
        s.error = points.error[k];
        const glm::vec3 wo = vector_at(outwards, k);
        const double eta = g.eta[k], cos_i = std::min(1.0, static_cast<double>(glm::dot(wo, s.ns)));
        g.reflected[k] = kFresnel == Fresnel::exact ? fresnel_dielectric(cos_i, eta) : fresnel_schlick(cos_i, eta);
        g.transmits[k] = transmitted_cos2(cos_i, eta) > 0.0 ? 1u : 0u;
        set_vector(g.refracted, k, refract(wo, s.ns, eta));
        set_vector(g.mirrored, k, above(reflect(wo, s.ns), s));
        set_vector(g.here, k, spawn_origin(s, s.ng));
        set_vector(g.beyond, k, spawn_origin(s, -s.ng));
    }
}

template <Fresnel kFresnel>
[[gnu::always_inline]] inline void divide_all(Glass& g, const Vertices& v) {
    for (std::size_t first = 0; first < v.count; first += kRun) {
        std::uint32_t any = 0;
        for (std::size_t k = first; k < std::min(v.count, first + kRun); ++k) any |= g.any[k];
        if (any != 0) divide_run<kFresnel>(g, v.points, v.wo, first);
    }
}
[[gnu::always_inline]] inline void divide_by(Glass& g, Fresnel fresnel, const Vertices& v) {
    fresnel == Fresnel::exact ? divide_all<Fresnel::exact>(g, v) : divide_all<Fresnel::schlick>(g, v);
}
[[gnu::target("avx2")]] void divide_avx2(Glass& g, Fresnel fresnel, const Vertices& v) { divide_by(g, fresnel, v); }

}  // namespace

void Glass::divide(Fresnel fresnel, const Vertices& vertices) noexcept {
    isa_in_use() == Isa::baseline ? divide_by(*this, fresnel, vertices) : divide_avx2(*this, fresnel, vertices);
}

}  // namespace glint
