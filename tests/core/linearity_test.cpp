// Pictures are linear in lights and albedo: what single lights give adds up, and a factor may sit on either side.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// Three balls and a floor under some of four lights, with all that local light and mirrors do.
std::shared_ptr<const Scene> lit_scene(const std::vector<Light>& lights, float albedo = 0.5f, float brightness = 1.0f) {
    Material floor = matte(albedo), ball = matte(albedo);
    ball.specular = glm::vec3(0.5f * albedo);
    ball.shininess = 30.0f;
    ball.mirror = glm::vec3(0.25f);
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(floor));
    b.scene().lights = lights;
    const std::uint32_t m = b.add_material(ball);
    for (int i = -1; i <= 1; ++i) b.add(Sphere{{1.4f * static_cast<float>(i), 0.7f, 0.3f * static_cast<float>(i)}, 0.6f}, m);
    for (Light& light : b.scene().lights) light.emission *= brightness;
    return b.finish();
}

std::vector<Light> four_lights() {
    std::vector<Light> lights{point_light({2, 4, 3}), point_light({-3, 2, 1}, Light::Falloff::physical), sun({1, 3, -1}),
                              point_light({0, 5, 0}, Light::Falloff::physical)};
    lights[3].direction = {0, -1, 0};
    lights[3].cos_inner = 0.95f, lights[3].cos_outer = 0.8f;
    return lights;
}

TEST(Linearity, S_MET_06_PicturesOfSingleLightsSumToThePictureOfAll) {
    const CameraPose camera = camera_at({0, 2, 6}, {0, 0.5f, 0});
    const std::vector<Light> lights = four_lights();
    const Image all = render(lit_scene(lights), camera, centred(), {}).image;
    std::vector<glm::vec3> sum(all.pixels.size(), glm::vec3(0.0f));
    for (const Light& light : lights) {
        const Image one = render(lit_scene({light}), camera, centred(), {}).image;
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one.pixels[i];
    }
    double lit = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        lit += static_cast<double>(sum[i].x);
        ASSERT_NEAR(sum[i].x, all.pixels[i].x, 4.0f * 0x1p-23f * sum[i].x) << i;
    }
    EXPECT_GT(lit, 100.0);
}

TEST(Linearity, S_MET_07_AlbedoTimesCEqualsLightTimesC) {
    const CameraPose camera = camera_at({0, 2, 6}, {0, 0.5f, 0});
    RenderSettings settings = centred();
    settings.features.set(Feature::reflections, false);
    const Image reference = render(lit_scene(four_lights()), camera, settings, {}).image;
    for (const float c : {2.0f, 1.7f, 0.3f}) {
        const Image scaled = render(lit_scene(four_lights(), 0.5f * c, 1.0f / c), camera, settings, {}).image;
        for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
            const float expected = reference.pixels[i].x;
            // Powers of two commute with every rounding.
            if (c == 2.0f)
                ASSERT_EQ(scaled.pixels[i].x, expected) << i;
            else
                ASSERT_NEAR(scaled.pixels[i].x, expected, 2.0f * 0x1p-23f * expected) << i;
        }
    }
}

}  // namespace
}  // namespace glint
