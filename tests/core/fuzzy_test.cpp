// Fuzzy mirrors: the lobe around the reflected ray, and that none of its light is lost.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

constexpr int kSamples = 1 << 18;

// Uniform in the unit ball, as the integrator draws it.
glm::vec3 ball_point(std::uint64_t index) {
    const Sampler sampler(SamplerKind::random, 1, 2, index, 3);
    return std::cbrt(sampler.interval(dimension::fuzz_radius)) * sphere_from_square(sampler.square(dimension::fuzz_direction));
}

std::shared_ptr<const Scene> mirror_scene(float roughness) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(mirror(1.0f, roughness));
    b.add(plane_at({0, -1, 0}, {0, 1, 0}), m);
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, m);
    b.scene().environment.kind = Environment::Kind::sky;
    return b.finish();
}

RenderSettings with_fuzz(bool on) {
    RenderSettings s;
    s.features = without(FeatureSet::all(), {Feature::soft, Feature::dof});
    s.features.set(Feature::fuzzy, on);
    return s;
}

TEST(Fuzzy, S_FUZ_01_NoRoughnessIsAMirrorToTheBit) {
    const CameraPose camera = camera_at({1, 2, 5}, glm::vec3(0.0f));
    const RenderSize size{32, 32, 4};
    const Image plain = render(mirror_scene(0.0f), camera, with_fuzz(false), size).image;
    RenderSettings forced = with_fuzz(true);
    forced.roughness = 0.0f;
    EXPECT_TRUE(same_bits(render(mirror_scene(0.0f), camera, forced, size).image, plain));
    EXPECT_TRUE(same_bits(render(mirror_scene(0.3f), camera, forced, size).image, plain));
    EXPECT_TRUE(same_bits(render(mirror_scene(0.3f), camera, with_fuzz(false), size).image, plain));
    EXPECT_FALSE(same_bits(render(mirror_scene(0.3f), camera, with_fuzz(true), size).image, plain));
    EXPECT_FALSE(plan_render(*mirror_scene(0.3f), forced, camera).has(kernel_part::fuzzy));
}

// A mirror of no roughness beside a rough one keeps its bits, though the fuzzy kernel runs.
TEST(Fuzzy, S_FUZ_01_AMirrorBesideARoughOneStaysSharp) {
    const auto scene = [](float other) {
        SceneBuilder b;
        b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(mirror(1.0f)));
        b.add(Sphere{{900, 0, 0}, 1.0f}, b.add_material(mirror(0.9f, other)));
        b.scene().environment.kind = Environment::Kind::sky;
        return b.finish();
    };
    const CameraPose camera = camera_at({0, 0, 5}, glm::vec3(0.0f));
    EXPECT_TRUE(plan_render(*scene(0.5f), with_fuzz(true), camera).has(kernel_part::fuzzy));
    EXPECT_TRUE(same_bits(render(scene(0.5f), camera, with_fuzz(true), {32, 32, 4}).image,
                          render(scene(0.0f), camera, with_fuzz(false), {32, 32, 4}).image));
}

TEST(Fuzzy, S_FUZ_02_TheLengthOfTheRaysDirectionDoesNotMatter) {
    Probe probe(mirror_scene(0.4f), with_fuzz(true));
    for (const float scale : {0x1p-20f, 0x1p-1f, 0x1p3f, 0x1p20f}) {
        for (std::uint64_t k = 0; k < 64; ++k) {
            const glm::vec3 d = glm::normalize(glm::vec3(-0.1f, -0.5f, -1.0f));
            probe.radiance(Ray{{0.3f, 2, 4}, d, kInfinity}, k);
            const std::vector<Ray> unit = probe.rays();
            probe.radiance(Ray{{0.3f, 2, 4}, scale * d, kInfinity}, k);
            ASSERT_EQ(probe.rays().size(), unit.size());
            ASSERT_GE(unit.size(), 2u);
            for (std::size_t i = 1; i < unit.size(); ++i) EXPECT_EQ(probe.rays()[i].direction, unit[i].direction);
        }
    }
}

TEST(Fuzzy, S_FUZ_03_TheShareBelowTheSurfaceIsThatOfABall) {
    const glm::vec3 n(0, 0, 1), no_surface(0.0f);
    struct Row {
        double elevation, share;
    };
    constexpr double kRho = 0.3;
    for (const Row& row : {Row{5, .28824}, {10, .11436}, {30, 0}}) {
        const double h = std::min(1.0, std::sin(radians(row.elevation)) / kRho);
        EXPECT_NEAR((1.0 - h) * (1.0 - h) * (2.0 + h) / 4.0, row.share, 5e-5);
        const glm::vec3 r(std::cos(radians(row.elevation)), 0.0, std::sin(radians(row.elevation)));
        int below = 0;
        for (int i = 0; i < kSamples; ++i) {
            const glm::vec3 offset = ball_point(static_cast<std::uint64_t>(i));
            const glm::vec3 free = fuzzy_direction(r, no_surface, static_cast<float>(kRho), offset);
            const glm::vec3 kept = fuzzy_direction(r, n, static_cast<float>(kRho), offset);
            below += free.z < 0.0f ? 1 : 0;
            // The policy: mirrored back across the tangent plane, everything else as it was.
            ASSERT_EQ(kept, glm::vec3(free.x, free.y, std::abs(free.z)));
        }
        const double share = static_cast<double>(below) / kSamples;
        note(fmt::format("share_{}", row.elevation), share);
        EXPECT_NEAR(share, row.share, 3.0 * std::sqrt(row.share * (1.0 - row.share) / kSamples) + 1e-9);
    }
}

TEST(Fuzzy, S_FUZ_04_MeanAndLargestDeviation) {
    const glm::vec3 r(0, 0, 1);
    constexpr double kRows[][2] = {{.1, .998}, {.3, .982}, {.5, .95}, {1, .8}};
    for (const auto& row : kRows) {
        double sum = 0.0, squares = 0.0, least = 1.0;
        for (int i = 0; i < kSamples; ++i) {
            const glm::dvec3 d(
                fuzzy_direction(r, glm::vec3(0.0f), static_cast<float>(row[0]), ball_point(static_cast<std::uint64_t>(i))));
            ASSERT_NEAR(glm::length(d), 1.0, 2e-7);
            sum += d.z, squares += d.z * d.z;
            least = std::min(least, d.z);
        }
        const double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
        note(fmt::format("cos_{}", row[0]), mean);
        EXPECT_NEAR(mean, row[1], 3.0 * error) << row[0];
        EXPECT_NEAR(1.0 - row[0] * row[0] / 5.0, row[1], 1e-12);
        EXPECT_GE(least, std::cos(std::asin(row[0])) - 1e-6) << row[0];
    }
}

TEST(Fuzzy, S_FUZ_05_AZeroSumGivesTheReflectedDirection) {
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 r(random.direction());
        EXPECT_EQ(fuzzy_direction(r, r, 1.0f, -r), r);
        // Almost zero: still a unit vector.
        const glm::dvec3 d(fuzzy_direction(r, r, 1.0f, -r * (1.0f - 0x1p-23f)));
        EXPECT_NEAR(glm::length(d), 1.0, 2e-7);
    }
}

TEST(Fuzzy, S_FUZ_06_AWhiteFurnaceLosesNothing) {
    for (const float rho : {0.1f, 0.3f, 1.0f}) {
        SceneBuilder b;
        b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(mirror(1.0f, rho)));
        b.scene().environment.color = glm::vec3(1.0f);
        const Rendered r = render(b.finish(), camera_at({0, 0, 3}, glm::vec3(0.0f)), with_fuzz(true), {32, 32, 16});
        for (const glm::vec3& p : r.image.pixels) ASSERT_EQ(p, glm::vec3(1.0f)) << rho;
        EXPECT_EQ(r.progress.rays.depth_cut, 0u);
        EXPECT_GT(r.progress.rays.reflection, 1000u);
    }
}

}  // namespace
}  // namespace glint
