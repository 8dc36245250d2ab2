// Refracted rays of the real integrator against closed forms: balls, slabs, shells, boxes and nested media.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// Refraction alone: every ray has one successor, so the recorded rays are one path.
RenderSettings refraction_only() {
    RenderSettings s = centred();
    s.features.set(Feature::reflections, false);
    return s;
}

// Signed angle from +z towards the axis x = 0, for a ray above it (x > 0).
double deviation(const Ray& ray) {
    return std::atan2(-static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.z));
}

// Where a ray in the plane y = 0 crosses the axis x = 0.
double crossing(const Ray& ray) {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    return o.z - o.x / d.x * d.z;
}

// The ray that leaves a ball of radius `radius` around the origin after entering parallel to +z at height h.
Ray through_ball(const std::shared_ptr<const Scene>& scene, double h, double radius, std::size_t expected_rays) {
    Probe probe(scene, refraction_only(), camera_at({0, 0, static_cast<float>(-5.0 * radius)}, glm::vec3(0.0f)));
    probe.radiance(Ray{glm::vec3(h, 0.0, -4.0 * radius), {0, 0, 1}, kInfinity});
    EXPECT_EQ(probe.rays().size(), expected_rays) << h;
    return probe.rays().back();
}

std::shared_ptr<const Scene> glass_ball(float radius) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), radius}, b.add_material(glass(1.5f)));
    return b.finish();
}

TEST(Refraction, O_REF_01_BallLensDeviationAndFocus) {
    struct Row {
        double h, focus;
    };
    for (const float radius : {1.0f, 0x1p-10f, 1000.0f}) {
        const auto scene = glass_ball(radius);
        for (const Row& row : {Row{.001, 1.4999996}, {.1, 1.4958271}, {.3, 1.4619784}, {.5, 1.3915729}, {.8, 1.2002814}}) {
            const double h =
                static_cast<double>(static_cast<float>(row.h * static_cast<double>(radius))) / static_cast<double>(radius);
            const double exact = 2.0 * (std::asin(h) - std::asin(h / 1.5));
            const Ray out = through_ball(scene, row.h * static_cast<double>(radius), static_cast<double>(radius), 3);
            EXPECT_NEAR(deviation(out) / exact, 1.0, 3e-6) << row.h;
            EXPECT_NEAR(crossing(out) / static_cast<double>(radius), row.focus, 4e-6) << row.h;
        }
    }
    EXPECT_NEAR(degrees(deviation(through_ball(glass_ball(1.0f), .1, 1.0, 3))), 3.8332335, 2e-5);
}

// The crossing point of a lens far from the origin suffers only from the rounding of its coordinates.
TEST(Refraction, O_REF_01_BallLensFarFromTheOrigin) {
    SceneBuilder b;
    b.add(Sphere{{1024.0f, 0.0f, 0.0f}, 1.0f}, b.add_material(glass(1.5f)));
    Probe probe(b.finish(), refraction_only());
    probe.radiance(Ray{{1024.5f, 0.0f, -4.0f}, {0, 0, 1}, kInfinity});
    Ray out = probe.rays().back();
    out.origin.x -= 1024.0f;
    EXPECT_NEAR(crossing(out), 1.3915729, 1e-3);
}

TEST(Refraction, O_REF_02_AHollowShellHardlyBends) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(glass(1.5f)));
    b.add(Sphere{glm::vec3(0.0f), 0.99f}, b.add_material(glass(1.0f)));
    const Ray out = through_ball(b.finish(), .1, 1.0, 5);
    EXPECT_NEAR(degrees(deviation(out)), -0.039, 5e-4);
}

TEST(Refraction, O_REF_03_ASlabShiftsAndKeepsTheDirection) {
    SceneBuilder b;
    b.add(Box{{-64, -64, 0}, {64, 64, 1}}, b.add_material(glass(1.5f)));
    Probe probe(b.finish(), refraction_only());
    constexpr double kRows[][2] = {{30, .1938138}, {45, .3291423}, {60, .5124720}};
    for (const auto& row : kRows) {
        const double i = radians(row[0]);
        const glm::vec3 d(std::sin(i), 0.0, std::cos(i));
        probe.radiance(Ray{{0, 0, -1}, d, kInfinity});
        ASSERT_EQ(probe.rays().size(), 3u);
        const glm::dvec3 in(d), out(probe.rays()[2].direction);
        EXPECT_LE(glm::length(out - in), 1e-6);
        const glm::dvec3 from(probe.rays()[2].origin - probe.rays()[0].origin);
        EXPECT_NEAR(glm::length(glm::cross(from, in)), row[1], 1e-6) << row[0];
    }
}

TEST(Refraction, O_REF_04_OnTheAxisOfABallOnlyFresnelDims) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(glass(1.5f)));
    b.scene().environment.kind = Environment::Kind::cube;
    for (CubeFace& face : b.scene().environment.faces) face = {1, 1, {0, 0, 0}};
    b.scene().environment.faces[4] = {1, 1, {255, 255, 255}};  // what +z looks at
    const auto scene = b.finish();
    const auto white = static_cast<double>(scene->environment.radiance({0, 0, 1}).x);
    ASSERT_GT(white, 0.9);
    ASSERT_EQ(scene->environment.radiance({0, 0, -1}).x, 0.0f);
    const auto seen = [&](int depth) {
        RenderSettings settings = centred();
        settings.depth = depth;
        Probe probe(scene, settings, camera_at({0, 0, -5}, glm::vec3(0.0f)));
        return probe.radiance({0, 0, -5}, {0, 0, 1}).x / white;
    };
    EXPECT_NEAR(seen(2), .9216, 1e-6);
    EXPECT_NEAR(seen(64), .9230769, 1e-6);
}

TEST(Refraction, S_REF_02_ASphereHitFromInsideTurnsNormalAndIndex) {
    const auto scene = glass_ball(1.0f);
    Probe probe(scene, refraction_only(), camera_at({0, 0, 0.5f}, {0, 0, 5}));
    // From z = 1/2 towards +x the surface is met at sin i = 1/2; Snell gives sin t = 3/4.
    probe.radiance(Ray{{0, 0, 0.5f}, {1, 0, 0}, kInfinity});
    ASSERT_EQ(probe.rays().size(), 2u);
    const glm::dvec3 n(std::sqrt(0.75), 0.0, 0.5), out(probe.rays()[1].direction);
    EXPECT_NEAR(glm::length(glm::cross(n, out)), 0.75, 1e-6);
    EXPECT_GT(glm::dot(n, out), 0.0);
}

// The winding says where the glass is: a mesh wound inwards is a bubble, as a ball of air is.
TEST(Refraction, S_REF_02_AFlippedMeshInGlassIsABubble) {
    const auto path = [](bool flipped) {
        SceneBuilder b;
        const std::uint32_t outer = b.add_material(glass(1.5f));
        b.add(Box{glm::vec3(-2.0f), glm::vec3(2.0f)}, outer);
        if (flipped)
            add_mesh_box(b, glm::vec3(-1.0f), glm::vec3(1.0f), outer, true);
        else
            add_mesh_box(b, glm::vec3(-1.0f), glm::vec3(1.0f), b.add_material(glass(1.0f)));
        Probe probe(b.finish(), refraction_only());
        probe.radiance({-0.7f, 0.2f, -5.0f}, {0.1f, 0.05f, 1.0f});
        EXPECT_EQ(probe.rays().size(), 5u);
        return probe.rays().back();
    };
    const Ray air = path(false), bubble = path(true);
    EXPECT_LE(glm::length(air.origin - bubble.origin), 1e-5f);
    EXPECT_LE(glm::length(air.direction - bubble.direction), 1e-6f);
}

TEST(Refraction, S_REF_02_WindingDoesNotChangeOpaqueAndMirrorMeshes) {
    const auto picture = [](bool flipped) {
        SceneBuilder b;
        add_mesh_box(b, {-1.5f, -0.5f, -0.5f}, {-0.5f, 0.5f, 0.5f}, b.add_material(matte(0.7f)), flipped);
        add_mesh_box(b, {0.5f, -0.5f, -0.5f}, {1.5f, 0.5f, 0.5f}, b.add_material(mirror(0.9f)), flipped);
        Light light;
        light.position = {1, 4, 3};
        b.scene().lights.push_back(light);
        b.scene().environment.color = {0.2f, 0.3f, 0.4f};
        return render(b.finish(), camera_at({1, 1, 5}, glm::vec3(0.0f)), centred(), {}).image;
    };
    EXPECT_TRUE(same_bits(picture(false), picture(true)));
}

// Seen from inside a box of glass: the weight of the reflection at the face of a box of water in it.
TEST(Refraction, S_REF_05_WaterInGlassReflectsAsWaterInGlass) {
    SceneBuilder b;
    b.add(Box{glm::vec3(-100.0f), glm::vec3(100.0f)}, b.add_material(glass(1.5f)));
    b.add(Box{{-50, -50, 0}, {50, 50, 50}}, b.add_material(glass(1.33f)));
    const auto scene = b.finish();
    const CameraPose camera = camera_at({0, 0, -1}, glm::vec3(0.0f));
    RenderSettings settings = centred();
    settings.depth = 0;
    settings.features.set(Feature::refractions, false);
    Probe reflected(scene, settings, camera);
    reflected.radiance({0, 0, -1}, {0, 0, 1});
    EXPECT_NEAR(reflected.counts().depth_cut_weight, .0036085, 5e-8);

    settings = refraction_only();
    settings.depth = 1;
    for (const double offset : {-1e-4, 1e-4}) {
        const double angle = radians(62.4573 + offset);
        Probe transmitted(scene, settings, camera);
        transmitted.radiance({0, 0, -1}, glm::vec3(std::sin(angle), 0.0, std::cos(angle)));
        EXPECT_EQ(transmitted.counts().refraction, offset < 0.0 ? 1u : 0u);
    }
}

TEST(Refraction, S_REF_05_NestedSlabsObeySnellAtEveryFace) {
    SceneBuilder b;
    b.add(Box{{-100, -100, 0}, {100, 100, 4}}, b.add_material(glass(1.5f)));
    b.add(Box{{-90, -90, 1}, {90, 90, 3}}, b.add_material(glass(1.33f)));
    b.add(Box{{-80, -80, 1.5f}, {80, 80, 2.5f}}, b.add_material(glass(1.0f)));
    Probe probe(b.finish(), refraction_only());
    probe.radiance(Ray{{0, 0, -1}, {0.6f, 0, 0.8f}, kInfinity});
    constexpr double kIndex[] = {1.0, 1.5, 1.33, 1.0, 1.33, 1.5, 1.0};
    ASSERT_EQ(probe.rays().size(), std::size(kIndex));
    for (std::size_t i = 0; i < std::size(kIndex); ++i) {
        EXPECT_NEAR(static_cast<double>(probe.rays()[i].direction.x) * kIndex[i], 0.6, 1e-6) << i;
    }
}

// Boxes that touch lose the air of no thickness between them; what must not happen is light from nowhere.
TEST(Refraction, S_REF_05_TouchingFacesStayFinite) {
    SceneBuilder b;
    b.add(Box{{-1, -1, 0}, {1, 1, 1}}, b.add_material(glass(1.5f)));
    b.add(Box{{-1, -1, 1}, {1, 1, 2}}, b.add_material(glass(1.33f)));
    b.scene().environment.color = glm::vec3(1.0f);
    RenderSettings settings = centred();
    settings.depth = 12;
    const Rendered r = render(b.finish(), camera_at({1, 2, -5}, {0, 0, 1}), settings, {});
    EXPECT_EQ(r.progress.rays.non_finite, 0u);
    for (const glm::vec3& p : r.image.pixels) EXPECT_TRUE(p.x > 0.0f && p.x < 1.0f + 1e-5f) << p.x;
}

TEST(Refraction, S_REF_06_TheCameraMayStandInGlass) {
    const auto leaving_angle = [](const std::shared_ptr<const Scene>& scene) {
        Probe probe(scene, refraction_only(), camera_at({0, 0, 0.5f}, {0, 0, 5}));
        probe.radiance(Ray{{0, 0, 0.5f}, {0.5f, 0, std::sqrt(0.75f)}, kInfinity});
        EXPECT_EQ(probe.rays().size(), 2u);
        return static_cast<double>(probe.rays().back().direction.x);
    };
    SceneBuilder slab;
    slab.add(Box{{-64, -64, 0}, {64, 64, 1}}, slab.add_material(glass(1.5f)));
    EXPECT_NEAR(leaving_angle(slab.finish()), 0.75, 1e-6);
    // A mesh around the camera is not looked for, but its first face tells.
    SceneBuilder mesh;
    add_mesh_box(mesh, {-64, -64, 0}, {64, 64, 1}, mesh.add_material(glass(1.5f)));
    EXPECT_NEAR(leaving_angle(mesh.finish()), 0.75, 1e-6);
    // In water in glass: the next medium is the glass, not air.
    SceneBuilder nested;
    nested.add(Box{glm::vec3(-64.0f), glm::vec3(64.0f)}, nested.add_material(glass(1.5f)));
    nested.add(Box{{-32, -32, 0}, {32, 32, 1}}, nested.add_material(glass(1.33f)));
    Probe probe(nested.finish(), refraction_only(), camera_at({0, 0, 0.5f}, {0, 0, 5}));
    probe.radiance(Ray{{0, 0, 0.5f}, {0.5f, 0, std::sqrt(0.75f)}, kInfinity});
    ASSERT_EQ(probe.rays().size(), 3u);
    EXPECT_NEAR(static_cast<double>(probe.rays()[1].direction.x), 0.5 * 1.33 / 1.5, 1e-6);
    EXPECT_NEAR(static_cast<double>(probe.rays()[2].direction.x), 0.5 * 1.33, 1e-6);
}

TEST(Refraction, S_REF_07_RaysLeaveABoxParallelToTheirEntry) {
    SceneBuilder b;
    b.add(Box{{-1, -1, -1}, {1, 1, 1}}, b.add_material(glass(1.5f)));
    Probe probe(b.finish(), refraction_only());
    Random random(7);
    int through = 0;
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 target(random.uniform(-1, 1), random.uniform(-1, 1), -1.0);
        const glm::vec3 origin(random.uniform(-3, 3), random.uniform(-3, 3), -4.0);
        probe.radiance(origin, target - origin);
        // Three rays and a way out through the face opposite the entry.
        if (probe.rays().size() != 3 || probe.rays()[2].origin.z < 1.0f) continue;
        ++through;
        worst = std::max(worst, glm::length(glm::dvec3(probe.rays()[2].direction) - glm::dvec3(probe.rays()[0].direction)));
    }
    EXPECT_GT(through, 5000);
    EXPECT_LE(worst, 1e-6);
}

}  // namespace
}  // namespace glint
