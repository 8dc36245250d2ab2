// Shadow rays that start at the light: they must not hit the surface they end on, nor pass what lies before it.
#include "core/shadow_origins.h"

#include <gtest/gtest.h>

#include "core/direct_light.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A unit primitive of each kind, moved to `at`.
std::shared_ptr<const Scene> single(PrimitiveKind kind, glm::vec3 at) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    switch (kind) {
        case PrimitiveKind::triangle:
            b.add_vertex(at + glm::vec3(-1, -0.5f, 0.2f));
            b.add_vertex(at + glm::vec3(1, -0.7f, -0.3f));
            b.add_vertex(at + glm::vec3(0.1f, 1, 0.4f));
            b.add_triangle(0, 1, 2, m);
            break;
        case PrimitiveKind::sphere: b.add(Sphere{at, 1.0f}, m); break;
        case PrimitiveKind::box: b.add(Box{at - glm::vec3(0.7f, 0.5f, 0.6f), at + glm::vec3(0.7f, 0.5f, 0.6f)}, m); break;
        case PrimitiveKind::cone:
            b.add(Cone{at - glm::vec3(0.2f, 0.8f, 0.1f), 0.9f, at + glm::vec3(0.2f, 0.8f, 0.1f), 0.3f}, m);
            break;
        case PrimitiveKind::plane: b.add(plane_at(glm::dvec3(at), {0.3, 1.0, -0.4}), m); break;
    }
    return b.finish();
}

// Rays from lights at 10^-3 to 10^5 units above points of a primitive `distance` from the origin, on the outside of it:
// nothing but the primitive itself could be hit.
void expect_no_self_shadow(PrimitiveKind kind) {
    for (const float distance : {0.0f, 1e3f, 1e5f}) {
        const glm::vec3 at = distance * glm::vec3(1.0f, 0.7f, -0.4f);
        const auto scene = single(kind, at);
        const Bvh accelerator(scene->geometry);
        Random random(static_cast<std::uint32_t>(kind) + 11);
        int rays = 0, from_light = 0, from_surface = 0;
        for (int i = 0; i < 12000; ++i) {
            const glm::vec3 eye(glm::dvec3(at) + 10.0 * random.direction());
            const glm::vec3 target(glm::dvec3(at) + 0.5 * random.uniform() * random.direction());
            const Ray ray{eye, glm::vec3(glm::normalize(glm::dvec3(target) - glm::dvec3(eye))), kInfinity};
            const Hit hit = accelerator.closest_hit(ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*scene, ray, hit);
            // Inside a hollow body the far side would be met rightly.
            if (!s.outside && kind != PrimitiveKind::triangle && kind != PrimitiveKind::plane) continue;
            for (int k = 0; k < 40; ++k) {
                glm::dvec3 d = random.direction();
                // Half of the lights stand low over the horizon.
                if (k % 2 == 0) d -= 0.99 * glm::dot(d, glm::dvec3(s.ng)) * glm::dvec3(s.ng);
                if (glm::dot(d, glm::dvec3(s.ng)) < 0.0) d = -d;
                const double length = std::pow(10.0, random.uniform(-3.0, 5.0));
                Light light = point_light(glm::vec3(glm::dvec3(s.p) + length * d));
                const LightSample l = sample_light(light, s.p, glm::vec2(0.5f));
                // The light's own rounding may have moved it below the horizon.
                const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(s.p);
                if (!(glm::dot(to, glm::dvec3(s.ng)) > 4.0 * 0x1p-24 * (glm::length(glm::dvec3(s.p)) + glm::length(to))))
                    continue;
                ++rays;
                from_light += accelerator.occluded(shadow_ray(light, l, s, true)) ? 1 : 0;
                from_surface += accelerator.occluded(shadow_ray(light, l, s, false)) ? 1 : 0;
            }
        }
        EXPECT_GT(rays, 100000) << distance;
        EXPECT_EQ(from_light, 0) << distance << " of " << rays;
        EXPECT_EQ(from_surface, 0) << distance << " of " << rays;
    }
}

TEST(ShadowOrigins, ATriangleNeverShadowsItself) { expect_no_self_shadow(PrimitiveKind::triangle); }
TEST(ShadowOrigins, ASphereNeverShadowsItself) { expect_no_self_shadow(PrimitiveKind::sphere); }
TEST(ShadowOrigins, ABoxNeverShadowsItself) { expect_no_self_shadow(PrimitiveKind::box); }
TEST(ShadowOrigins, AConeNeverShadowsItself) { expect_no_self_shadow(PrimitiveKind::cone); }
TEST(ShadowOrigins, APlaneNeverShadowsItself) { expect_no_self_shadow(PrimitiveKind::plane); }

// Two parallel square plates, the upper one `gap` above the lower and larger than any slanted ray needs.
std::shared_ptr<const Scene> two_plates(PrimitiveKind kind, glm::vec3 at, float gap) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    for (const float y : {0.0f, gap}) {
        const float half = y == 0.0f ? 0.5f : 3.0f;
        if (kind == PrimitiveKind::triangle)
            add_quad(b, at + glm::vec3(-half, y, -half), {0, 0, 2 * half}, {2 * half, 0, 0}, m);
        else
            b.add(Box{at + glm::vec3(-half, y, -half), at + glm::vec3(half, y, half)}, m);
    }
    return b.finish();
}

// A thousandth of a unit; where coordinates reach 13, a little more than their 14 * 128 * 2^-24.
TEST(ShadowOrigins, NoLightLeaksThroughAThinWall) {
    for (const PrimitiveKind kind : {PrimitiveKind::triangle, PrimitiveKind::box}) {
        for (const float place : {0.0f, 10.0f}) {
            const glm::vec3 at(place, 0.5f * place, -place);
            const float gap = place == 0.0f ? 1e-3f : 2e-3f;
            const auto scene = two_plates(kind, at, gap);
            const Bvh accelerator(scene->geometry);
            Random random(3);
            int rays = 0, leaks = 0, at_light = 0;
            for (int i = 0; i < 40000; ++i) {
                // A point of the lower plate as a ray from straight above would report it.
                const glm::vec3 p = at + glm::vec3(random.uniform(-0.5, 0.5), 5e-4, random.uniform(-0.5, 0.5));
                const Ray down{p, glm::vec3(0, -1, 0), kInfinity};
                const Hit hit = accelerator.closest_hit(down);
                ASSERT_TRUE(hit.found());
                const SurfacePoint s = surface_point(*scene, down, hit);
                const double length = std::pow(10.0, random.uniform(-2.5, 5.0));
                glm::dvec3 d = random.direction();
                d.y = std::max(std::abs(d.y), 0.5);
                const std::vector<Light> lights{point_light(glm::vec3(glm::dvec3(s.p) + length * glm::normalize(d)))};
                if (lights[0].position.y <= at.y + 1.01f * gap) continue;
                ShadowOrigins origins;
                origins.decide(scene->geometry, lights, accelerator);
                const LightSample l = sample_light(lights[0], s.p, glm::vec2(0.5f));
                ++rays;
                at_light += origins.at_light(0) ? 1 : 0;
                leaks += accelerator.occluded(shadow_ray(lights[0], l, s, origins.at_light(0))) ? 0 : 1;
            }
            EXPECT_GT(rays, 30000);
            EXPECT_GT(at_light, rays / 3);
            EXPECT_LT(at_light, rays);
            EXPECT_EQ(leaks, 0) << static_cast<int>(kind) << ' ' << place;
        }
    }
}

// A ball on a floor: the shadow reaches the point of contact.
TEST(ShadowOrigins, AContactShadowIsClosed) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    b.add(Box{{-20, -1, -20}, {20, 0, 20}}, m);
    b.add(Sphere{{0, 1, 0}, 1.0f}, m);
    const auto scene = b.finish();
    const Bvh accelerator(scene->geometry);
    for (const float height : {3.0f, 30.0f, 1000.0f}) {
        const Light light = point_light({0.3f * height, height, 0.1f * height});
        for (double x = -0.5; x <= 0.5; x += 1e-4) {
            const Ray down{glm::vec3(x, 1e-7, 0.0), {0, -1, 0}, kInfinity};
            const Hit hit = accelerator.closest_hit(down);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*scene, down, hit);
            const LightSample l = sample_light(light, s.p, glm::vec2(0.5f));
            ASSERT_TRUE(accelerator.occluded(shadow_ray(light, l, s, true))) << height << ' ' << x;
        }
    }
}

// Where a surface passes through the light, or the light is so far away that rounding would show, rays start at the surface.
TEST(ShadowOrigins, OnlyFreeNearTruePointsStartRays) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    b.add(Sphere{{0, 0, 0}, 1.0f}, m);
    b.add(Box{{-2, 2, -2}, {2, 2, 2}}, m);
    b.add(plane_at({0, -3, 0}, {0.2, 1, 0.1}), m);
    add_quad(b, {-2, 0, -2}, {0, 4, 0}, {4, 4, 0}, m);
    const auto scene = b.finish();
    std::vector<Light> lights{point_light({0, 1.5f, 0}), point_light({0, 2, 0}),   point_light({0, 1, 0}),
                              point_light({0, -3, 0}),   point_light({0, 200, 0}), point_light({0, 300, 0}),
                              point_light({0.3f, 4, 0}), sun({0, 1, 0}),           point_light({0, 1.5f, 0})};
    lights[8].edge1 = {1, 0, 0}, lights[8].edge2 = {0, 0, 1};
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, scene->geometry);
        ShadowOrigins origins;
        std::visit([&](const auto& a) { origins.decide(scene->geometry, lights, a); }, *accelerator);
        const bool expected[] = {true, false, false, false, true, true, true, false, false};
        for (std::size_t i = 0; i < lights.size(); ++i) EXPECT_EQ(origins.at_light(i), expected[i]) << i;
        // Beyond 128 times the largest coordinate, 8.
        lights[5].position.y = 2000;
        std::visit([&](const auto& a) { origins.decide(scene->geometry, lights, a); }, *accelerator);
        EXPECT_FALSE(origins.at_light(5));
        lights[5].position.y = 300;
    }
}

}  // namespace
}  // namespace glint
