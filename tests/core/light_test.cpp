// Local light: the Blinn-Phong highlight, where shadow rays go and where none is cast.
#include "core/light.h"

#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A floor at y = 0 of the given material under the given lights.
template <class Add>
std::shared_ptr<const Scene> floor_scene(const Material& material, const std::vector<Light>& lights, const Add& add) {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(material));
    b.scene().lights = lights;
    add(b);
    return b.finish();
}
std::shared_ptr<const Scene> floor_scene(const Material& material, const std::vector<Light>& lights) {
    return floor_scene(material, lights, [](SceneBuilder&) {});
}

glm::dvec3 look_down(Probe& probe, double x = 0.0) { return probe.radiance(glm::vec3(x, 0.5, 0.0), {0, -1, 0}); }

TEST(Highlight, O_BPH_01_TheLobesEnergySeenAlongTheNormal) {
    struct Row {
        float exponent;
        double energy;
    };
    for (const Row& row : {Row{1, 2.8602849}, {10, 1.5006715}, {50, .4475203}, {100, .2369225}, {1000, .0249826}}) {
        Probe probe(floor_scene(highlight(1.0f, row.exponent), {sun({0, 1, 0})}), centred());
        constexpr int kSteps = 4000;
        double sum = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            const double theta = 0.5 * kPi * (i + 0.5) / kSteps;
            probe.plan.lights[0].direction = glm::vec3(-std::sin(theta), -std::cos(theta), 0.0);
            sum += look_down(probe).x * 2.0 * kPi * std::sin(theta) * std::cos(theta);
        }
        const double s = static_cast<double>(row.exponent);
        EXPECT_NEAR(8.0 * kPi * (std::exp2(-s / 2.0) + s) / ((s + 2.0) * (s + 4.0)), row.energy, 6e-8);
        // pow of a float cosine near 1 loses about `exponent` roundings.
        EXPECT_NEAR(sum * 0.5 * kPi / kSteps / row.energy, 1.0, 1e-6 + 3e-8 * s) << s;
    }
}

TEST(Highlight, S_BPH_01_ALightBelowTheHorizonGivesNothingAndCostsNothing) {
    Material both = highlight(1.0f, 2.0f);
    both.diffuse = glm::vec3(1.0f);
    // n.l = -0.1 while the half vector is well above the surface.
    const glm::dvec3 l(std::sqrt(0.99), -0.1, 0.0);
    Probe probe(floor_scene(both, {sun(l)}), centred());
    const glm::vec3 wo(-0.2f, std::sqrt(0.96f), 0.0f);
    ASSERT_GT(glm::dot(glm::normalize(glm::dvec3(wo) + l), glm::dvec3(0, 1, 0)), 0.6);
    EXPECT_EQ(probe.radiance(wo, -wo), glm::dvec3(0.0));
    EXPECT_EQ(probe.counts().shadow, 0u);
}

TEST(Highlight, S_BPH_02_GrazingLightAndBackfacingNormalsStayFinite) {
    Material both = highlight(1.0f, 50.0f);
    both.diffuse = glm::vec3(1.0f);
    for (const double grazing : {1e-7, 1e-12, 0.0, -1e-12, -1e-7}) {
        Probe probe(floor_scene(both, {sun({1.0, grazing, 0.0})}), centred());
        const double light = look_down(probe).x;
        EXPECT_TRUE(light >= 0.0 && light < 1e-6) << light;
        if (grazing <= 0.0) {
            EXPECT_EQ(light, 0.0);
            EXPECT_EQ(probe.counts().shadow, 0u);
        }
    }
    // A triangle whose vertex normals lean over so far that the eye is behind them.
    SceneBuilder b;
    const glm::vec3 leaning(0.0f, 0.05f, -1.0f);
    for (const glm::vec3 v : {glm::vec3(-1, 0, 1), glm::vec3(1, 0, 1), glm::vec3(0, 0, -2)}) b.add_vertex(v, leaning);
    b.add_triangle(0, 1, 2, b.add_material(both));
    for (const double angle : {-80., -40., 0., 40., 80.})
        b.scene().lights.push_back(sun({0.0, std::cos(radians(angle)), std::sin(radians(angle))}));
    Probe probe(b.finish(), centred());
    for (double angle = -85.0; angle <= 85.0; angle += 5.0) {
        const glm::vec3 wo(0.0, std::cos(radians(angle)), std::sin(radians(angle)));
        const double light = probe.radiance(wo, -wo).x;
        EXPECT_TRUE(light >= 0.0 && std::isfinite(light)) << angle;
    }
}

TEST(Highlight, S_BPH_03_NoHalfVectorAndExtremeExponentsStayFinite) {
    for (const float exponent : {0.0f, 0.5f, 1.0f, 50.0f, 1e4f, 1e6f}) {
        for (const glm::dvec3 l : {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(1, 1e-7, 0), glm::dvec3(1, 1, 0)}) {
            Probe probe(floor_scene(highlight(1.0f, exponent), {sun(l)}), centred());
            const double light = look_down(probe).x;
            EXPECT_TRUE(light >= 0.0 && light <= 1.0) << exponent << ' ' << light;
            if (l.y == 1.0 && l.x == 0.0) {
                EXPECT_EQ(light, 1.0) << exponent;
            }
            if (exponent == 0.0f && l.y > 0.0) {
                EXPECT_EQ(light, 1.0);
            }
        }
    }
}

std::shared_ptr<const Scene> plate_over_floor(double y0, double y1) {
    return floor_scene(matte(1.0f), {point_light({0, 2, 0})}, [=](SceneBuilder& b) {
        b.add(Box{glm::vec3(-50, y0, -50), glm::vec3(50, y1, 50)}, b.add_material(black()));
    });
}

TEST(Shadow, S_SHD_01_OnlyWhatStandsBeforeTheLightShadows) {
    struct Row {
        double y0, y1;
        bool lit;
    };
    // Behind the light, before it, and touching it from the receiver's side: thick and thin.
    for (const Row& row : {Row{3, 3, true},
                           {3, 4, true},
                           {2.001, 2.001, true},
                           {1, 1, false},
                           {0.9, 1.1, false},
                           {1.9, 2, false},
                           {1.999, 1.999, false}}) {
        Probe probe(plate_over_floor(row.y0, row.y1), centred());
        for (double x = -7.0; x < 7.0; x += 0.173) {
            const double exact = row.lit ? 2.0 / std::sqrt(x * x + 4.0) : 0.0;
            ASSERT_NEAR(probe.radiance(glm::vec3(x, 0.01, 0.0), {0, -1, 0}).x, exact, 1e-6)
                << row.y0 << ' ' << row.y1 << ' ' << x;
        }
    }
}

// A plate in which the light lies exactly: rounding would leave it lit in a third of the pixels.
TEST(Shadow, S_SHD_01_APlateThroughTheLightIsDarkEverywhere) {
    for (const PrimitiveKind kind : {PrimitiveKind::triangle, PrimitiveKind::box, PrimitiveKind::plane}) {
        for (const float h : {2.0f, 1.7f, 0.013f, 1234.5f}) {
            Probe probe(floor_scene(matte(1.0f), {point_light({0.1f * h, h, 0.3f * h})},
                                    [&](SceneBuilder& b) {
                                        const std::uint32_t m = b.add_material(black());
                                        if (kind == PrimitiveKind::triangle)
                                            add_quad(b, {-2 * h, h, -2 * h}, {0, 0, 4 * h}, {4 * h, 0, 0}, m);
                                        if (kind == PrimitiveKind::box) b.add(Box{{-50 * h, h, -50 * h}, {50 * h, h, 50 * h}}, m);
                                        if (kind == PrimitiveKind::plane) b.add(plane_at({0, h, 0}, {0, 1, 0}), m);
                                    }),
                        centred());
            for (double x = -1.9; x < 1.9; x += 0.0073) {
                const glm::vec3 eye(x * static_cast<double>(h), 0.01 * static_cast<double>(h), 0.0);
                ASSERT_EQ(probe.radiance(eye, {0, -1, 0}).x, 0.0) << static_cast<int>(kind) << ' ' << h << ' ' << x;
            }
        }
    }
}

TEST(Shadow, S_SHD_02_ALightAtTheHitPointIsFinite) {
    for (const auto falloff : {Light::Falloff::none, Light::Falloff::physical}) {
        for (const float height : {0.0f, 1e-30f, 1e-20f, 1e-19f, 1e-10f}) {
            Probe probe(floor_scene(matte(0.5f), {point_light({0, height, 0}, falloff)}), centred());
            const double light = look_down(probe).x;
            EXPECT_TRUE(std::isfinite(light) && light >= 0.0) << height;
            if (height < 1e-19f) {
                EXPECT_EQ(light, 0.0);
            }
        }
    }
}

TEST(Shadow, S_SHD_02_CoincidentLightsAddAndBlackOnesCostNothing) {
    Light dark = point_light({0, 2, 0});
    dark.emission = glm::vec3(0.0f);
    const Light lamp = point_light({1, 2, 0});
    Probe one(floor_scene(matte(0.5f), {lamp}), centred()), two(floor_scene(matte(0.5f), {lamp, dark, lamp}), centred());
    EXPECT_EQ(2.0 * look_down(one).x, look_down(two).x);
    EXPECT_EQ(two.counts().shadow, 2u);
}

TEST(Shadow, S_OFF_05_LightsAtSurfacesAreLitDarkOrDefined) {
    // Just above the surface: lit, from straight below the light to far aside.
    Probe above(floor_scene(matte(1.0f), {point_light({0, 1e-3f, 0})}), centred());
    for (const double x : {0.0, 1e-4, 1e-2, 1.0, 30.0}) {
        EXPECT_NEAR(look_down(above, x).x / (1e-3 / std::hypot(1e-3, static_cast<double>(static_cast<float>(x)))), 1.0, 1e-4)
            << x;
    }
    // Exactly on it: no cosine anywhere, so no light and no shadow ray.
    Probe on(floor_scene(matte(1.0f), {point_light({0, 0, 0})}), centred());
    for (const double x : {0.0, 1e-4, 1.0}) EXPECT_EQ(look_down(on, x).x, 0.0);
    EXPECT_EQ(on.counts().shadow, 0u);
    // Inside an opaque ball: the floor outside is dark, and so is the ball itself.
    Probe inside(floor_scene(matte(1.0f), {point_light({0, 2, 0})},
                             [](SceneBuilder& b) {
                                 b.add(Sphere{{0, 2, 0}, 0.5f}, b.add_material(matte(1.0f)));
                             }),
                 centred());
    for (const double x : {0.1, 1.0, 5.0}) EXPECT_EQ(look_down(inside, x).x, 0.0);
    EXPECT_EQ(inside.radiance({0, 5, 0}, {0.02f, -1, 0.01f}).x, 0.0);
}

TEST(Shadow, NoShadowRayWhereTheLightCannotContribute) {
    const auto shadow_rays = [](const Material& material, const Light& light) {
        Probe probe(floor_scene(material, {light}), centred());
        look_down(probe);
        return probe.counts().shadow;
    };
    const Light lamp = point_light({0, 2, 0}, Light::Falloff::physical);
    EXPECT_EQ(shadow_rays(matte(1.0f), lamp), 1u);
    EXPECT_EQ(shadow_rays(highlight(1.0f, 5.0f), lamp), 1u);
    EXPECT_EQ(shadow_rays(black(), lamp), 0u);
    EXPECT_EQ(shadow_rays(glass(1.5f), lamp), 0u);
    Light spot = lamp;
    spot.direction = {1, 0, 0};
    spot.cos_inner = 0.9f, spot.cos_outer = 0.8f;
    EXPECT_EQ(shadow_rays(matte(1.0f), spot), 0u);
    Light short_range = lamp;
    short_range.range = 1.5f;
    EXPECT_EQ(shadow_rays(matte(1.0f), short_range), 0u);
    Light quad = lamp;
    quad.shape = Light::Shape::quad;
    quad.edge1 = {0, 0, 1}, quad.edge2 = {1, 0, 0};  // faces up
    EXPECT_EQ(shadow_rays(matte(1.0f), quad), 0u);
    std::swap(quad.edge1, quad.edge2);
    EXPECT_EQ(shadow_rays(matte(1.0f), quad), 1u);
    Material red = matte(0.0f);
    red.diffuse.x = 1.0f;
    Light blue = lamp;
    blue.emission = {0, 0, 1};
    EXPECT_EQ(shadow_rays(red, blue), 0u);
    RenderSettings unshadowed = centred();
    unshadowed.features.set(Feature::shadows, false);
    Probe off(floor_scene(matte(1.0f), {lamp}), unshadowed);
    EXPECT_GT(look_down(off).x, 0.0);
    EXPECT_EQ(off.counts().shadow, 0u);
}

}  // namespace
}  // namespace glint
