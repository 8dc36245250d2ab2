// Direct light of many vertices at once: what the formulas give each vertex alone, bit for bit, for every kind of light and in
// every instruction set.
#include "core/direct_light.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "core/sampler.h"
#include "tests/core/render_picture.h"

namespace glint {
namespace {

float uniform(std::uint32_t i, std::uint32_t what) { return static_cast<float>(hash(i, what) >> 8) * 0x1p-24f; }
glm::vec3 direction(std::uint32_t i, std::uint32_t what) { return sphere_from_square({uniform(i, what), uniform(i, what + 1)}); }

std::vector<Material> some_materials() {
    std::vector<Material> materials(4);
    materials[0].diffuse = {0.8f, 0.3f, 0.0f}, materials[0].specular = glm::vec3(0.0f);
    materials[1].diffuse = {0.2f, 0.3f, 0.5f}, materials[1].specular = {0.7f, 0.6f, 0.5f}, materials[1].shininess = 31.0f;
    materials[2].diffuse = materials[2].specular = glm::vec3(0.0f);
    materials[3].diffuse = glm::vec3(0.0f), materials[3].highlight_scale = 3.5f, materials[3].emission = {1.0f, 2.0f, 3.0f};
    return materials;
}

std::vector<Light> all_kinds_of_lights() {
    std::vector<Light> lights(10);
    for (Light& light : lights) {
        light.position = {1.0f, 2.0f, -0.5f};
        light.emission = {3.0f, 0.0f, 7.0f};
        light.falloff = Light::Falloff::physical;
    }
    lights[0].falloff = Light::Falloff::none;
    lights[2].range = 2.5f;
    lights[2].cos_inner = 0.9f, lights[2].cos_outer = 0.2f;
    lights[3].shape = Light::Shape::directional;
    lights[3].direction = glm::normalize(glm::vec3(0.3f, -1.0f, 0.2f));
    for (std::size_t i = 4; i < 8; ++i) lights[i].edge1 = {0.7f, 0.1f, 0.0f}, lights[i].edge2 = {0.0f, 0.2f, 0.9f};
    lights[4].falloff = lights[6].falloff = lights[8].falloff = Light::Falloff::none;
    lights[6].shape = lights[7].shape = Light::Shape::quad;
    lights[8].shape = lights[9].shape = Light::Shape::sphere;
    lights[8].radius = lights[9].radius = 0.8f;
    return lights;
}

// Points around the lights, some in them and one at their middle; stretches of one material, and all mixed. Where they are
// smooth, half have a lift, some of these downwards.
void set_vertices(std::size_t n, std::span<const Material> materials, bool smooth, Vertices& v) {
    v.count = n;
    v.points.smooth = false;
    for (std::uint32_t k = 0; k < n; ++k) {
        SurfacePoint s;
        s.p = glm::vec3(1.0f, 2.0f, -0.5f) + (k % 7 == 0 ? 0.5f : 4.0f) * uniform(k, 1) * direction(k, 2);
        if (k == 5) s.p = {1.0f, 2.0f, -0.5f};
        s.ng = direction(k, 4);
        s.ns = glm::normalize(s.ng + 0.3f * direction(k, 6));
        s.error = 1e-6f;
        s.error_from_afar = 8e-7f;
        s.outside = true;
        s.material = k < 40 ? 1 : hash(k) % static_cast<std::uint32_t>(materials.size());
        if (smooth && k % 2 == 1) {
            s.lift = 0.1f * glm::normalize(s.ng + 1.5f * direction(k, 12));
            s.bend = 0.9f;
        }
        v.points.set(k, s);
        const glm::vec3 wo = direction(k, 8);
        for (int i = 0; i < 3; ++i) v.wo[i][k] = wo[i];
    }
}

void expect_same_bits(glm::vec3 a, glm::vec3 b) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i]));
}

void expect_light_of_single_vertices(const Light& light, bool highlights, bool at_light, bool smooth, std::size_t n) {
    static Vertices v;
    static DirectLight direct;
    static RayBatch rays;
    const std::vector<Material> materials = some_materials();
    set_vertices(n, materials, smooth, v);
    v.set_materials(materials, highlights);
    for (std::uint32_t k = 0; k < n; ++k) direct.u[0][k] = uniform(k, 10), direct.u[1][k] = uniform(k, 11);
    direct.reflect(light, v);
    rays.clear(RayOrder::divergent);
    direct.cast(light, at_light, v, rays);
    OccludedBatch blocked{};
    for (std::size_t i = 0; i < blocked.size(); ++i) blocked[i] = i % 3 == 1;
    OccludedBatch blocked_too = blocked, lifts_blocked{};
    static RayBatch lifts;
    if (direct.cast_lifts(blocked, v, lifts)) {
        for (std::size_t i = 0; i < lifts_blocked.size(); ++i) lifts_blocked[i] = i % 5 == 2;
        direct.block(lifts_blocked, blocked_too);
    } else {
        EXPECT_EQ(lifts.count, 0);
    }
    direct.add(blocked_too, v);
    int ray = 0, lit = 0, lift = 0;
    for (std::uint32_t k = 0; k < n; ++k) {
        const SurfacePoint s = v.points[k];
        const Material& m = materials[s.material];
        const LightSample l = sample_light(light, s.p, {direct.u[0][k], direct.u[1][k]});
        const bool shiny = highlights && m.has_highlight();
        glm::vec3 expected = reflected_light(l, s, m, {v.wo[0][k], v.wo[1][k], v.wo[2][k]}, shiny);
        if (expected != glm::vec3(0.0f)) {
            ASSERT_LT(ray, rays.count);
            const Ray one = shadow_ray(light, l, s, at_light), many = rays[ray];
            expect_same_bits(many.origin, one.origin);
            expect_same_bits(many.direction, one.direction);
            EXPECT_EQ(std::bit_cast<std::uint32_t>(many.t_max), std::bit_cast<std::uint32_t>(one.t_max));
            bool seen = !blocked[static_cast<std::size_t>(ray++)];
            if (seen && is_low(l.wi, s)) {
                ASSERT_LT(lift, lifts.count);
                expect_same_bits(lifts[lift].origin, lift_ray(s).origin);
                expect_same_bits(lifts[lift].direction, lift_ray(s).direction);
                EXPECT_EQ(lifts[lift].t_max, 1.0f);
                seen = !lifts_blocked[static_cast<std::size_t>(lift++)];
            }
            if (!seen) expected = glm::vec3(0.0f);
            ++lit;
        }
        expect_same_bits({v.direct[0][k], v.direct[1][k], v.direct[2][k]}, expected);
    }
    EXPECT_EQ(ray, rays.count);
    EXPECT_EQ(lift, lifts.count);
    EXPECT_GT(lit, n > 100 ? 10 : -1);
    EXPECT_GT(lift, smooth && n > 200 ? 3 : -1);
}

TEST(DirectLight, IsThatOfEachVertexAloneForEveryKindOfLightAndInstructionSet) {
    for_each_isa([](Isa) {
        for (const Light& light : all_kinds_of_lights()) {
            for (const std::size_t n : {1u, 7u, 8u, 131u, 256u}) {
                for (const bool smooth : {false, true}) {
                    expect_light_of_single_vertices(light, true, false, smooth, n);
                    expect_light_of_single_vertices(light, false, false, smooth, n);
                    if (light.is_true_point()) expect_light_of_single_vertices(light, true, true, smooth, n);
                }
            }
        }
    });
}

TEST(DirectLight, WithoutShadowsAllOfItArrives) {
    static Vertices v;
    static DirectLight direct;
    const std::vector<Material> materials = some_materials();
    set_vertices(100, materials, true, v);
    v.set_materials(materials, true);
    const Light light = all_kinds_of_lights()[0];
    direct.reflect(light, v);
    direct.add(v);
    direct.add(v);
    for (std::size_t k = 0; k < v.count; ++k) {
        const SurfacePoint s = v.points[k];
        const glm::vec3 one = reflected_light(sample_light(light, s.p, glm::vec2(0.5f)), s, materials[s.material],
                                              {v.wo[0][k], v.wo[1][k], v.wo[2][k]}, materials[s.material].has_highlight());
        expect_same_bits({v.direct[0][k], v.direct[1][k], v.direct[2][k]}, one + one);
    }
}

TEST(Vertices, KnowWhetherAnyIsLitHighlitOrShines) {
    static Vertices v;
    const std::vector<Material> materials = some_materials();
    const auto set = [&](std::uint32_t material, bool highlights) {
        v.count = 3;
        for (std::uint32_t& m : v.points.material) m = material;
        v.set_materials(materials, highlights);
    };
    set(0, true);
    EXPECT_TRUE(v.any_lit && !v.any_highlit && !v.any_emission);
    set(1, true);
    EXPECT_TRUE(v.any_lit && v.any_highlit && !v.any_emission);
    set(1, false);
    EXPECT_TRUE(v.any_lit && !v.any_highlit);
    set(2, true);
    EXPECT_FALSE(v.any_lit);
    set(3, false);
    EXPECT_TRUE(!v.any_lit && v.any_emission);
    EXPECT_EQ(v.emission[2][2], 3.0f);
}

}  // namespace
}  // namespace glint
