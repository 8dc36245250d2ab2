// Light from sources with extent against closed forms: rectangles, spheres, blockers and penumbrae.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

Light ball_light(glm::vec3 center, float radius) {
    Light light;
    light.shape = Light::Shape::sphere;
    light.falloff = Light::Falloff::physical;
    light.position = center;
    light.radius = radius;
    return light;
}

// A matte white floor at y = 0 (its radiance is the irradiance) under `light`, and whatever `add` puts above.
template <class Add>
std::shared_ptr<const Scene> floor_under(const Light& light, const Add& add) {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(matte(1.0f)));
    b.scene().lights.push_back(light);
    add(b);
    return b.finish();
}
std::shared_ptr<const Scene> floor_under(const Light& light) {
    return floor_under(light, [](SceneBuilder&) {});
}

// The floor at (x, 0, z), seen at a slant from below the blockers.
Estimate irradiance(const std::shared_ptr<const Scene>& scene, double x, double z, const RenderSettings& settings = {},
                    std::uint32_t replicates = 16, std::uint64_t samples = 1024) {
    Probe probe(scene, settings);
    const glm::vec3 to_eye(0.03, 0.05, 0.02);
    return estimate_radiance(probe, glm::vec3(x, 0.0, z) + to_eye, -to_eye, replicates, samples);
}

RenderSettings hard() {
    RenderSettings s;
    s.features = without(FeatureSet::all(), {Feature::soft});
    return s;
}

TEST(AreaLight, O_ALT_01_ARectangleAboveAFloor) {
    const auto scene = floor_under(ceiling_light());
    constexpr double kRows[][3] = {
        {0, 0, .752274688}, {1, 0, .566645112}, {1, 1, .435209876}, {2, 0, .265004852}, {4, 0, .0437426483}};
    for (const auto& row : kRows) {
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::random}) {
            RenderSettings settings;
            settings.sampler = kind;
            const bool plain = kind == SamplerKind::random;
            expect_estimate(fmt::format("E_{}_{}_{}", row[0], row[1], kSamplerNames[static_cast<std::size_t>(kind)]),
                            irradiance(scene, row[0], row[1], settings, 16, plain ? 4096 : 1024), row[2]);
        }
    }
}

// The paper's soft shadow takes cosines and distance at the light's centre: what the hard light gives, and not the truth.
TEST(AreaLight, O_ALT_02_WithoutExtentTheCentreCounts) {
    const auto scene = floor_under(ceiling_light());
    constexpr double kRows[][3] = {{0, 0, 1.0}, {1, 0, .64}, {1, 1, .444444444}, {2, 0, .25}, {4, 0, .04}};
    for (const auto& row : kRows) EXPECT_NEAR(irradiance(scene, row[0], row[1], hard(), 2, 1).mean, row[2], 1e-6);
}

TEST(AreaLight, O_ALT_03_AHalfPlaneBlocker) {
    const auto scene = floor_under(ceiling_light(), [](SceneBuilder& b) {
        add_quad(b, {-1000, 1, -1000}, {1000, 0, 0}, {0, 0, 2000}, b.add_material(black()));
    });
    constexpr double kRows[][2] = {{-.75, .0414201}, {-.5, .1164128}, {0, .3761373}, {.5, .5840562}, {1, .5666451}};
    for (const auto& row : kRows) expect_estimate(fmt::format("E_{}", row[0]), irradiance(scene, row[0], 0.0), row[1]);
    EXPECT_EQ(irradiance(scene, -1.001, 0.0, {}, 2, 256).mean, 0.0);
}

TEST(AreaLight, O_ALT_04_ABallShinesAsItsDisk) {
    const auto scene = floor_under(ball_light({0, 4, 0}, 1.0f));
    expect_estimate("above", irradiance(scene, 0.0, 0.0), .196349541);
    // Off the axis: pi (r/d)^2 cos.
    expect_estimate("aside", irradiance(scene, 3.0, 0.0), kPi / 25.0 * 0.8);
}

TEST(AreaLight, O_ALT_05_ABallBehindABall) {
    const auto scene = floor_under(ball_light({0, 8, 0}, 2.0f), [](SceneBuilder& b) {
        b.add(Sphere{{0, 4, 0}, 0.5f}, b.add_material(black()));
    });
    // Strata of the radius would all err alike here, by the stratum that the blocker's rim cuts; so plain random numbers.
    RenderSettings settings;
    settings.sampler = SamplerKind::random;
    expect_estimate("E", irradiance(scene, 0.0, 0.0, settings, 16, 8192), .147262156);
}

TEST(AreaLight, S_ALT_01_FarNearAndInsideABall) {
    // 1 - cos of the cone would cancel at 10^4 radii.
    for (const double d : {1e2, 1e4, 1e6}) {
        const auto scene = floor_under(ball_light({0, static_cast<float>(d), 0}, 1.0f));
        const double exact = kPi / (d * d);
        EXPECT_NEAR(irradiance(scene, 0.0, 0.0, {}, 2, 4096).mean / exact, 1.0, 2e-4) << d;
    }
    const Light unit = ball_light({0, 1, 0}, 1.0f);
    for (const float height : {-1e-3f, 0.0f, 0x1p-24f, 0.5f, 1.0f}) {
        const LightSample s = sample_light(unit, {0, height, 0}, {0.3f, 0.7f});
        EXPECT_TRUE(std::isfinite(s.arriving.x) && std::isfinite(s.wi.x) && std::isfinite(s.point.x)) << height;
        if (height >= 0.0f) {
            EXPECT_EQ(s.arriving.x, 0.0f) << height;
        } else {
            // Just outside, the cone is almost the hemisphere: 2 pi (1 - cos) with sin = r / d.
            EXPECT_NEAR(static_cast<double>(s.arriving.x), 2.0 * kPi * (1.0 - std::sqrt(1.0 - 1.0 / (1.001 * 1.001))), 2e-4);
        }
    }
}

// One point of the light for each sample of the pixel means what 256 x 256 points for one receiver mean.
TEST(AreaLight, S_ALT_02_OnePointASampleMeansWhatManyPointsDo) {
    const Light light = ceiling_light();
    const auto scene = floor_under(light, [](SceneBuilder& b) {
        b.add(Sphere{{0.3f, 1, 0.2f}, 0.35f}, b.add_material(black()));
    });
    const BruteForce blockers(scene->geometry);
    for (const double x : {-0.4, 0.1, 0.6}) {
        constexpr int kPoints = 256;
        const glm::vec3 receiver(x, 0, 0);
        double exact = 0.0;
        for (int i = 0; i < kPoints * kPoints; ++i) {
            const glm::dvec2 u((i % kPoints + 0.5) / kPoints, (i / kPoints + 0.5) / kPoints);
            const LightSample s = sample_light(light, receiver, glm::vec2(u));
            const bool dark = blockers.occluded({receiver + glm::vec3(0, 1e-4f, 0), s.point - receiver, 0.999f});
            if (!dark) exact += static_cast<double>(s.arriving.x * s.wi.y) / (kPoints * kPoints);
        }
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::random}) {
            RenderSettings settings;
            settings.sampler = kind;
            const Estimate e = irradiance(scene, x, 0.0, settings, 32, kind == SamplerKind::random ? 4096 : 1024);
            EXPECT_LE(e.standard_error, .004 * exact) << x;
            EXPECT_NEAR(e.mean, exact, 3.0 * e.standard_error + 2e-4 * exact) << x << ' ' << static_cast<int>(kind);
        }
    }
}

TEST(AreaLight, S_ALT_01_SamplesOfABallLieOnItAndFaceTheReceiver) {
    Random random(3);
    for (const float scale : {1e-6f, 1.0f, 1e6f}) {
        const Light light = ball_light(glm::vec3(1, 2, 3) * scale, scale);
        for (int i = 0; i < 20000; ++i) {
            const glm::vec3 receiver(glm::dvec3(light.position) +
                                     random.direction() * (random.uniform(1.001, 5.0) * static_cast<double>(scale)));
            const LightSample s = sample_light(light, receiver, {random.uniform(), random.uniform()});
            const glm::dvec3 n = (glm::dvec3(s.point) - glm::dvec3(light.position)) / static_cast<double>(scale);
            ASSERT_NEAR(glm::length(n), 1.0, 4e-6);
            ASSERT_LE(glm::dot(n, glm::dvec3(s.wi)), 1e-3);
            const glm::dvec3 to(s.point - receiver);
            ASSERT_NEAR(glm::dot(glm::normalize(to), glm::dvec3(s.wi)), 1.0, 1e-6);
        }
    }
}

// The paper's square around a point light: its mean visibility, a straight edge at height 1 below a light at height 2.
TEST(AreaLight, O_SHD_01_APenumbraIsAsWideAsTheClosedForm) {
    Light light;
    light.position = {0, 2, 0};
    light.edge1 = {2, 0, 0};
    light.edge2 = {0, 0, 2};
    const auto blocked = floor_under(light, [](SceneBuilder& b) {
        add_quad(b, {-1000, 1, -1000}, {1000, 0, 0}, {0, 0, 2000}, b.add_material(black()));
    });
    const auto open = floor_under(light);
    // Falloff `none` keeps the receiver's cosine; light points at x' are seen past the edge when x' > -x.
    for (const double x : {-.9, -.5, 0., .5, .9}) {
        const auto lit_from = [x](double from) {
            constexpr int kSteps = 400;
            double sum = 0.0;
            for (int i = 0; i < kSteps * kSteps; ++i) {
                const double lx = from + (1.0 - from) * (i % kSteps + .5) / kSteps, lz = -1.0 + 2.0 * (i / kSteps + .5) / kSteps;
                sum += 2.0 / std::sqrt((lx - x) * (lx - x) + lz * lz + 4.0);
            }
            return sum / (kSteps * kSteps) * (1.0 - from) / 2.0;
        };
        expect_estimate(fmt::format("open_{}", x), irradiance(open, x, 0.0), lit_from(-1.0));
        expect_estimate(fmt::format("blocked_{}", x), irradiance(blocked, x, 0.0), lit_from(-x));
    }
    EXPECT_EQ(irradiance(blocked, -1.0005, 0.0, {}, 2, 1024).mean, 0.0);
    const Estimate beyond = irradiance(blocked, 1.0005, 0.0, {}, 2, 1024), clear = irradiance(open, 1.0005, 0.0, {}, 2, 1024);
    EXPECT_EQ(beyond.mean, clear.mean);
}

// The lamp's own surface ends the shadow rays, wherever the scene lies and however large it is.
TEST(AreaLight, S_SHD_03_ALampDoesNotShadowItself) {
    for (const float scale : {0x1p-20f, 1.0f, 0x1p20f}) {
        Light quad = ceiling_light();
        quad.position *= scale, quad.edge1 *= scale, quad.edge2 *= scale;
        const auto with_quad = floor_under(
            quad, [&](SceneBuilder& b) { add_quad(b, quad.position, quad.edge1, quad.edge2, b.add_material(emitter(1.0f))); });
        const Light ball = ball_light({0, 4 * scale, 0}, scale);
        const auto with_ball = floor_under(ball, [&](SceneBuilder& b) {
            b.add(Sphere{ball.position, ball.radius}, b.add_material(emitter(1.0f)));
        });
        for (const double x : {0., .7, 3., 50.}) {
            const glm::vec3 at = glm::vec3(x, 0, 0.2) * scale, to_eye = glm::vec3(.03, .05, .02) * scale;
            for (const auto& [lamp, light] : {std::pair(with_quad, quad), std::pair(with_ball, ball)}) {
                Probe own(lamp), bare(floor_under(light));
                double with_lamp = 0.0, without_lamp = 0.0;
                for (std::uint64_t k = 0; k < 4096; ++k) {
                    with_lamp += own.radiance(at + to_eye, -to_eye, k).x;
                    without_lamp += bare.radiance(at + to_eye, -to_eye, k).x;
                }
                EXPECT_EQ(with_lamp, without_lamp) << scale << ' ' << x << ' ' << light.radius;
            }
        }
    }
}

// A panel much larger than its distance: its triangles' hits are only as precise as its far corners.
TEST(AreaLight, S_SHD_03_ALargePanelCloseAboveDoesNotShadowItself) {
    Light panel = ceiling_light();
    for (const float height : {1.0f, 0.01f}) {
        panel.position = {-50, height, -50};
        panel.edge1 = {100, 0, 0}, panel.edge2 = {0, 0, 100};
        const auto scene = floor_under(panel, [&](SceneBuilder& b) {
            add_quad(b, panel.position, panel.edge1, panel.edge2, b.add_material(emitter(1.0f)));
        });
        Probe own(scene), bare(floor_under(panel));
        const glm::vec3 at(0.1f, 0, 0.2f), to_eye = glm::vec3(.03, .05, .02) * (0.1f * height);
        for (std::uint64_t k = 0; k < 4096; ++k) {
            ASSERT_EQ(own.radiance(at + to_eye, -to_eye, k), bare.radiance(at + to_eye, -to_eye, k)) << height << ' ' << k;
        }
    }
}

TEST(AreaLight, S_SHD_03_TheLightsOwnPlaneAndBackGetNothing) {
    for (const glm::vec3 receiver : {glm::vec3(3, 2, 0), glm::vec3(0, 2, 0), glm::vec3(0.5f, 3, 0.2f)}) {
        const LightSample s = sample_light(ceiling_light(), receiver, {0.25f, 0.75f});
        EXPECT_EQ(s.arriving, glm::vec3(0.0f));
    }
}

}  // namespace
}  // namespace glint
