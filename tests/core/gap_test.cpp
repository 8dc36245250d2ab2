// Gaps between surfaces that an absolute offset of rays would swallow.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// The share of light that reaches a glowing ball of radius 1 through a clear shell of radius 1 + gap around it.
double seen_through_shell(float gap, float ior) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(emitter({1, 0, 0})));
    b.add(Sphere{glm::vec3(0.0f), 1.0f + gap}, b.add_material(glass(ior)));
    RenderSettings settings = centred();
    settings.features.set(Feature::reflections, false);
    Probe probe(b.finish(), settings);
    Random random(3);
    double least = 1.0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 eye = 5.0 * random.direction();
        const glm::dvec3 target = 0.9 * random.uniform() * random.direction();
        least = std::min(least, probe.radiance(glm::vec3(eye), glm::vec3(target - eye)).x);
    }
    return least;
}

TEST(Spawn, S_OFF_07_ABallCloseBehindAShellIsFound) {
    EXPECT_EQ(seen_through_shell(4e-5f, 1.0f), 1.0);
    EXPECT_EQ(seen_through_shell(4e-6f, 1.0f), 1.0);
    EXPECT_GT(seen_through_shell(4e-5f, 1.5f), 0.5);
}

TEST(Spawn, S_OFF_07_ASmallSphereDoesNotShadowItself) {
    struct Ball {
        glm::vec3 center;
        float radius;
    };
    for (const Ball& ball : {Ball{{0, .083f, .4f}, .015f}, {{278, 273, -5400}, 250}}) {
        SceneBuilder b;
        b.add(Sphere{ball.center, ball.radius}, b.add_material(matte(1.0f)));
        Light light;
        light.position = ball.center + glm::vec3(0, 0, 40 * ball.radius);
        b.scene().lights.push_back(light);
        CameraPose camera = camera_at(ball.center + glm::vec3(0, 0, 20 * ball.radius), ball.center, 6.0f);
        camera.lens_radius = 0.05f * ball.radius;
        RenderSettings settings;
        settings.features = without(FeatureSet::all(), {Feature::soft});
        const auto scene = b.finish();
        const Image shadowed = render(scene, camera, settings, {64, 64, 16}).image;
        settings.features.set(Feature::shadows, false);
        EXPECT_TRUE(same_bits(shadowed, render(scene, camera, settings, {64, 64, 16}).image));
        EXPECT_GT(mean_of(shadowed), 0.3);
    }
}

}  // namespace
}  // namespace glint
