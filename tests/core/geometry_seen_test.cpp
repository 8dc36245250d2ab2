// What geometry alone says about a picture: the horizon, mirror images, coincident surfaces, and edges that two triangles share.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint {
namespace {

using namespace test;

TEST(Horizon, S_PLN_02_ExactlyTheLowerHalfIsThePlane) {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(emitter(1.0f)));
    const auto scene = b.finish();
    for (const auto& [width, height] : {std::pair(64, 64), std::pair(33, 50), std::pair(8, 8192)}) {
        for (const float angle : {20.0f, 60.0f, 120.0f}) {
            const Image image = render(scene, camera_at({0, 1, 0}, {1, 1, -3}, angle), centred(), {width, height}).image;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) ASSERT_EQ(image.at(x, y).x, y >= height / 2 ? 1.0f : 0.0f) << x << ' ' << y;
            }
        }
    }
}

// The nearest row to the horizon looks at points at 10^4 and more: none may shadow itself.
TEST(Horizon, S_PLN_02_NoAcneFarAway) {
    for (const float roughness : {0.0f, 0.3f}) {
        SceneBuilder b;
        Material floor = mirror(0.5f, roughness);
        floor.diffuse = glm::vec3(1.0f);
        b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(floor));
        b.scene().lights = {sun({0.3, 1, 0.2}), sun({1, 0.01, -1})};
        b.scene().environment.color = glm::vec3(0.25f);
        const auto scene = b.finish();
        RenderSettings settings = centred();
        settings.features.set(Feature::fuzzy, roughness > 0.0f);
        const CameraPose camera = camera_at({0, 1, 0}, {1, 1, -3}, 90.0f);
        const Rendered shadowed = render(scene, camera, settings, {8, 32768});
        settings.features.set(Feature::shadows, false);
        EXPECT_TRUE(same_bits(shadowed.image, render(scene, camera, settings, {8, 32768}).image)) << roughness;
        // Each reflected ray leaves for the sky.
        EXPECT_EQ(shadowed.progress.rays.reflection, 8u * 16384u);
    }
}

// Balls and triangles of a colour each, behind the camera; seen in a mirror, or standing where the mirror shows them.
std::shared_ptr<const Scene> menagerie(glm::dvec3 n, bool with_mirror) {
    SceneBuilder b;
    Random random(3);
    const auto place = [&](glm::dvec3 p) { return glm::vec3(with_mirror ? p : p - 2.0 * glm::dot(p, n) * n); };
    const glm::dvec3 x = glm::normalize(glm::cross(n, glm::dvec3(0.3, 1.0, 0.2))), y = glm::cross(n, x);
    for (int i = 0; i < 240; ++i) {
        const std::uint32_t m = b.add_material(emitter(static_cast<float>(i + 1)));
        const glm::dvec3 p = random.uniform(8, 14) * n + random.uniform(-6, 6) * x + random.uniform(-6, 6) * y;
        if (i % 2 == 0) {
            b.add(Sphere{place(p), static_cast<float>(random.uniform(0.4, 1.2))}, m);
        } else {
            const std::uint32_t first = b.add_vertex(place(p));
            b.add_vertex(place(p + 2.0 * random.direction())), b.add_vertex(place(p + 2.0 * random.direction()));
            b.add_triangle(first, first + 1, first + 2, m);
        }
    }
    if (with_mirror) b.add(plane_at(glm::dvec3(0.0), n), b.add_material(mirror(1.0f)));
    return b.finish();
}

TEST(MirrorImage, O_SNE_01_AnObjectInAPlaneMirrorIsTheObjectAtTheReflectedPlace) {
    for (const glm::dvec3 n :
         {glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 2, 2)), glm::normalize(glm::dvec3(-3, 0.1, 1))}) {
        const CameraPose camera = camera_at(glm::vec3(6.0 * n), glm::vec3(0.0f), 50.0f);
        const Image seen = render(menagerie(n, true), camera, centred(), {256, 256}).image;
        const Image there = render(menagerie(n, false), camera, centred(), {256, 256}).image;
        int equal = 0, things = 0;
        for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
            equal += seen.pixels[i] == there.pixels[i] ? 1 : 0;
            things += there.pixels[i].x > 0.0f ? 1 : 0;
        }
        note("equal", equal / 65536.0);
        EXPECT_GT(things, 10000);
        EXPECT_GE(equal, 65536 * 0.999);
    }
}

// Skipping the primitive that a ray leaves would not help against its double, and would lose the far side of a ball.
TEST(Coincident, S_OFF_06_TwoTrianglesInOnePlaceAreLeftTogether) {
    for (const float distance : {0.0f, 1e3f, 1e5f}) {
        SceneBuilder b;
        const std::uint32_t m = b.add_material(matte(1.0f));
        const glm::vec3 at = distance * glm::vec3(1.0f, 0.7f, -0.4f);
        b.add_vertex(at + glm::vec3(-1, -0.5f, 0.2f)), b.add_vertex(at + glm::vec3(1, -0.7f, -0.3f));
        b.add_vertex(at + glm::vec3(0.1f, 1, 0.4f));
        b.add_triangle(0, 1, 2, m), b.add_triangle(0, 1, 2, m), b.add_triangle(2, 1, 0, m);
        const auto scene = b.finish();
        const BruteForce accelerator(scene->geometry);
        Random random(6);
        int rays = 0;
        for (int i = 0; i < 10000; ++i) {
            const glm::vec3 eye(glm::dvec3(at) + 10.0 * random.direction());
            const Ray ray{eye, at + glm::vec3(0.2 * random.direction()) - eye};
            const Hit hit = accelerator.closest_hit(ray);
            if (!hit.found()) continue;
            ASSERT_NE(index_of(hit.primitive), 1u) << "of two the first";
            const SurfacePoint s = surface_point(*scene, ray, hit);
            for (int k = 0; k < 10; ++k, ++rays) {
                glm::dvec3 d = random.direction();
                if (glm::dot(d, glm::dvec3(s.ng)) < 0.0) d = -d;
                ASSERT_FALSE(accelerator.occluded({spawn_origin(s, s.ng), glm::vec3(d)}));
                ASSERT_FALSE(accelerator.occluded({spawn_origin(s, -s.ng), -glm::vec3(d)}));
            }
        }
        EXPECT_GT(rays, 50000);
    }
}

TEST(Coincident, S_OFF_06_ABallIsMetAgainFromInside) {
    SceneBuilder b;
    b.add(Sphere{{1, 2, 3}, 1.5f}, b.add_material(glass(1.5f)));
    const auto scene = b.finish();
    const BruteForce accelerator(scene->geometry);
    Random random(7);
    for (int i = 0; i < 100000; ++i) {
        const glm::vec3 eye(glm::dvec3(1, 2, 3) + 5.0 * random.direction());
        const Ray ray{eye, glm::vec3(1, 2, 3) + glm::vec3(random.direction()) - eye};
        const Hit hit = accelerator.closest_hit(ray);
        ASSERT_TRUE(hit.found());
        const SurfacePoint s = surface_point(*scene, ray, hit);
        glm::dvec3 d = random.direction();
        if (glm::dot(d, glm::dvec3(s.ng)) > -0.1) d -= (glm::dot(d, glm::dvec3(s.ng)) + 0.3) * glm::dvec3(s.ng);
        const Hit again = accelerator.closest_hit({spawn_origin(s, -s.ng), glm::vec3(d)});
        ASSERT_EQ(again.primitive, hit.primitive);
        const double chord = -2.0 * glm::dot(glm::dvec3(s.p) - glm::dvec3(1, 2, 3), d) / glm::dot(d, d);
        ASSERT_NEAR(static_cast<double>(again.t), chord, 1e-4);
    }
}

// A ray through the diagonal of a face may hit both triangles there, and may come out through a diagonal again. Whoever counted
// hits would lose track of the inside: the last ray would then not be parallel to the first.
TEST(SharedEdge, S_TRI_15_GlassIsEnteredAndLeftByTheSideNotByCounting) {
    SceneBuilder b;
    add_mesh_box(b, glm::vec3(-1.0f), glm::vec3(1.0f), b.add_material(glass(1.5f)));
    b.scene().environment.color = glm::vec3(1.0f);
    RenderSettings settings = centred();
    settings.features.set(Feature::reflections, false);
    Probe probe(b.finish(), settings);
    Random random(15);
    for (int i = 0; i < 20000; ++i) {
        // Points of the diagonals of the face z = 1, and directions to leave through the face z = -1.
        const double s = random.uniform(-0.45, 0.45);
        const glm::vec3 at(s, i % 2 == 0 ? s : -s, 1.0);
        const glm::vec3 d(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), -1.0f);
        const glm::vec3 eye = at - 2.0f * d;
        const double seen = probe.radiance(eye, at - eye).x;
        ASSERT_EQ(probe.rays().size(), 3u) << fmt::format("{} {} {} -> {} {} {}", eye.x, eye.y, eye.z, d.x, d.y, d.z);
        const glm::dvec3 first(probe.rays().front().direction), last(probe.rays().back().direction);
        ASSERT_LE(glm::length(glm::cross(first, last)), 1e-6) << s;
        ASSERT_GT(seen, 0.88);
    }
}

}  // namespace
}  // namespace glint
