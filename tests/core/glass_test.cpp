// Glass at many vertices at once: what the formulas give each vertex alone, bit for bit, in every instruction set.
#include "core/glass.h"

#include <gtest/gtest.h>

#include "core/fresnel.h"
#include "core/sampler.h"
#include "tests/core/render_picture.h"

namespace glint {
namespace {

glm::vec3 direction(std::uint32_t i, std::uint32_t what) {
    return sphere_from_square(
        {static_cast<float>(hash(i, what) >> 8) * 0x1p-24f, static_cast<float>(hash(what, i) >> 8) * 0x1p-24f});
}

void expect_glass_of_single_vertices(Fresnel fresnel) {
    static Vertices v;
    static Glass g;
    v.count = 203;
    int through = 0;
    for (std::uint32_t k = 0; k < v.count; ++k) {
        SurfacePoint s{};
        s.p = 5.0f * direction(k, 1);
        s.ng = direction(k, 2);
        s.ns = glm::normalize(s.ng + 0.4f * direction(k, 3));
        s.error = 2e-6f;
        v.points.set(k, s);
        const glm::vec3 d = direction(k, 4), wo = glm::dot(d, s.ns) > 0.0f ? d : -d;
        for (int i = 0; i < 3; ++i) v.wo[i][k] = wo[i];
        // No glass in the second run and here and there.
        g.any[k] = k % 5 == 0 || k / 8 == 1 ? 0 : 1;
        g.eta[k] = k % 4 == 0 ? 1.0 : k % 2 == 0 ? 1.0 / 1.5 : 1.7;
    }
    g.divide(fresnel, v);
    for (std::uint32_t k = 0; k < v.count; ++k) {
        if (g.any[k] == 0) continue;
        const SurfacePoint s = v.points[k];
        const auto row = [&](const float(&rows)[3][kRayBatch]) { return glm::vec3(rows[0][k], rows[1][k], rows[2][k]); };
        const glm::vec3 wo = row(v.wo);
        const double cos_i = std::min(1.0, static_cast<double>(glm::dot(wo, s.ns)));
        EXPECT_EQ(g.reflected[k],
                  fresnel == Fresnel::exact ? fresnel_dielectric(cos_i, g.eta[k]) : fresnel_schlick(cos_i, g.eta[k]));
        const bool transmits = transmitted_cos2(cos_i, g.eta[k]) > 0.0;
        EXPECT_EQ(g.transmits[k] != 0, transmits);
        if (transmits) {
            EXPECT_EQ(row(g.refracted), refract(wo, s.ns, g.eta[k]));
        }
        EXPECT_EQ(row(g.mirrored), above(reflect(wo, s.ns), s));
        EXPECT_EQ(row(g.here), spawn_origin(s, s.ng));
        EXPECT_EQ(row(g.beyond), spawn_origin(s, -s.ng));
        through += transmits ? 1 : 0;
    }
    EXPECT_GT(through, 50);
}

TEST(Glass, IsThatOfEachVertexAloneInEveryInstructionSet) {
    for_each_isa([](Isa) {
        expect_glass_of_single_vertices(Fresnel::exact);
        expect_glass_of_single_vertices(Fresnel::schlick);
    });
}

}  // namespace
}  // namespace glint
