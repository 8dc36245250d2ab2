// Settings that trade work for error: a cut-off by weight, points a light, one branch at glass. What each may do to a picture.
#include <gtest/gtest.h>

#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

std::shared_ptr<const Scene> corridor(float rho) {
    SceneBuilder b;
    Material m = mirror(rho);
    m.emission = glm::vec3(1.0f);
    const std::uint32_t wall = b.add_material(m);
    b.add(plane_at({0, 0, 1}, {0, 0, -1}), wall);
    b.add(plane_at({0, 0, -1}, {0, 0, 1}), wall);
    return b.finish();
}

// P-05 of the catalogue: a branch below tau loses at most tau times the light along it, and says so.
TEST(Cutoff, ACorridorLosesAtMostTheCutoffAndTellsHowMuch) {
    for (const float rho : {0.5f, 0.9f}) {
        for (const float tau : {0.1f, 0.01f, 0.001f}) {
            RenderSettings settings = centred();
            settings.depth = 1000;
            settings.cutoff = tau;
            Probe probe(corridor(rho), settings);
            const double whole = 1.0 / (1.0 - static_cast<double>(rho));
            const double lost = 1.0 - probe.radiance({0, 0, 0}, {0, 0, 1}).x / whole;
            EXPECT_GT(lost, 0.0);
            EXPECT_LE(lost, static_cast<double>(tau) * (1.0 + 1e-6));
            EXPECT_EQ(probe.counts().weight_cut, 1u);
            EXPECT_NEAR(probe.counts().weight_cut_weight, lost, 1e-6);
            EXPECT_EQ(probe.counts().depth_cut, 0u);
        }
    }
}

TEST(Cutoff, ZeroCutsNothing) {
    RenderSettings settings = centred();
    settings.depth = 100;
    Probe probe(corridor(0.9f), settings);
    (void)probe.radiance({0, 0, 0}, {0, 0, 1});
    EXPECT_EQ(probe.counts().weight_cut, 0u);
    EXPECT_EQ(probe.counts().depth_cut, 1u);
}

// A glass ball in front of a glowing wall, under a sky of another colour: every branch sees something.
std::shared_ptr<const Scene> ball_of_glass() {
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1.0f}, b.add_material(glass(1.5f)));
    b.add(plane_at({0, 0, -3}, {0, 0, 1}), b.add_material(emitter(1.0f)));
    b.scene().environment.color = glm::vec3(0.25f);
    return b.finish();
}

TEST(OneBranch, HasTheMeanOfBoth) {
    RenderSettings settings;
    settings.depth = 6;
    RenderSettings one = settings;
    one.glass = GlassBranches::one;
    const auto scene = ball_of_glass();
    Probe both(scene, settings), chosen(scene, one);
    for (const float x : {0.1f, 0.6f, 0.93f}) {
        const glm::vec3 eye(x, 0.05f, 4.0f), towards(0, 0, -1);
        const double exact = both.radiance(eye, towards).x;
        expect_estimate(fmt::format("one_branch_{}", x), estimate_radiance(chosen, eye, towards), exact);
    }
}

TEST(OneBranch, FollowsAtMostOneRayASurface) {
    RenderSettings one;
    one.depth = 6;
    one.glass = GlassBranches::one;
    Probe probe(ball_of_glass(), one);
    for (std::uint64_t k = 0; k < 64; ++k) {
        (void)probe.radiance({0.93f, 0.05f, 4.0f}, {0, 0, -1}, k);
        EXPECT_LE(probe.rays().size(), 7u);
    }
}

// Where only one of the rays is wanted there is nothing to choose, and what is removed is not made up for.
TEST(OneBranch, IsNoChoiceWhereOneIsSwitchedOff) {
    const auto scene = load_scene("builtin:glass,what=ball");
    Picture p;
    p.spp = 2;
    p.settings.features = without(FeatureSet::all(), {Feature::reflections});
    const Image expected = render_picture(scene, p);
    p.settings.glass = GlassBranches::one;
    EXPECT_EQ(differing_pixels(expected, render_picture(scene, p)), 0u);
}

// Without jitter, lens, area or fuzz the choice is the only thing random, so the samples may not be cut down to one.
TEST(OneBranch, IsRandomByItself) {
    const auto scene = load_scene("builtin:glass,what=ball");
    Picture p;
    p.spp = 4;
    p.settings.features = FeatureSet::whitted();
    p.settings.glass = GlassBranches::one;
    Progress progress;
    (void)render_picture(scene, p, &progress);
    EXPECT_EQ(progress.spp_min, 4);
}

double irradiance_error(const std::shared_ptr<const Scene>& scene, int light_samples, std::uint64_t samples) {
    RenderSettings settings;
    settings.light_samples = light_samples;
    Probe probe(scene, settings);
    const glm::vec3 to_eye(0.03f, 0.05f, 0.02f);
    return estimate_radiance(probe, glm::vec3(0.4f, 0.0f, 0.3f) + to_eye, -to_eye, 64, samples).standard_error;
}

std::shared_ptr<const Scene> half_hidden_light() {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(matte(1.0f)));
    b.add(Box{{-0.2f, 1.0f, -0.2f}, {0.4f, 1.1f, 0.4f}}, b.add_material(black()));
    b.scene().lights.push_back(ceiling_light());
    return b.finish();
}

TEST(LightSamples, AreAsGoodAsThatManyMoreSamplesAndHaveTheSameMean) {
    const auto scene = half_hidden_light();
    // All points of a pixel's samples are one sequence: 4 x 16 and 1 x 64 are the same points, to rounding.
    RenderSettings four;
    four.light_samples = 4;
    Probe one(scene), many(scene, four);
    const glm::vec3 to_eye(0.03f, 0.05f, 0.02f), eye = glm::vec3(0.4f, 0.0f, 0.3f) + to_eye;
    double sum = 0.0, expected = 0.0;
    for (std::uint64_t k = 0; k < 64; ++k) expected += one.radiance(eye, -to_eye, k).x / 64.0;
    for (std::uint64_t k = 0; k < 16; ++k) sum += many.radiance(eye, -to_eye, k).x / 16.0;
    EXPECT_NEAR(sum, expected, 1e-6 * expected);
    EXPECT_LT(irradiance_error(scene, 4, 4), 0.6 * irradiance_error(scene, 1, 4));
}

TEST(LightSamples, CostOnlyWhereALightHasArea) {
    const auto scene = load_scene("builtin:balls,level=1");
    Picture p;
    p.spp = 2;
    p.settings.features = FeatureSet::whitted();
    const Image expected = render_picture(scene, p);
    p.settings.light_samples = 8;
    EXPECT_EQ(differing_pixels(expected, render_picture(scene, p)), 0u);
}

// One picture for every thread count, accelerator and instruction set, here too.
TEST(Approximations, S_DET_01_HaveTheSameBitsEverywhere) {
    const auto scene = load_scene("builtin:glass,what=nested");
    Picture p;
    p.width = p.height = 32;
    p.spp = 3;
    p.settings.features = FeatureSet::all();
    p.settings.glass = GlassBranches::one;
    p.settings.light_samples = 3;
    p.settings.cutoff = 0.01f;
    p.accelerator = AcceleratorKind::none;
    p.threads = 1;
    const Image expected = render_picture(scene, p);
    for (const AcceleratorKind kind : {AcceleratorKind::grid, AcceleratorKind::bvh}) {
        p.accelerator = kind;
        p.threads = 3;
        for_each_isa([&](Isa isa) {
            EXPECT_EQ(differing_pixels(expected, render_picture(scene, p)), 0u) << kIsaNames[static_cast<std::size_t>(isa)];
        });
    }
}

}  // namespace
}  // namespace glint
