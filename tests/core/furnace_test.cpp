// Where all light is known in advance: corridors of mirrors, furnaces, and a glass ball between a white and a black sky.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// Two facing mirrors that glow: each bounce adds rho times the one before.
std::shared_ptr<const Scene> corridor(float rho, float emission) {
    SceneBuilder b;
    Material m = mirror(rho);
    m.emission = glm::vec3(emission);
    const std::uint32_t wall = b.add_material(m);
    b.add(plane_at({0, 0, 1}, {0, 0, -1}), wall);
    b.add(plane_at({0, 0, -1}, {0, 0, 1}), wall);
    return b.finish();
}

TEST(Furnace, O_DEP_01_ACorridorLosesRhoToTheDepthPlusOne) {
    struct Row {
        float rho;
        int depth;
        double lost;
    };
    constexpr Row kRows[] = {{.5f, 0, .5}, {.5f, 5, .0156}, {.5f, 10, .000488}, {.9f, 5, .531}, {.9f, 10, .314}, {.9f, 15, .185}};
    for (const Row& row : kRows) {
        const auto rho = static_cast<double>(row.rho);
        RenderSettings settings = centred();
        settings.depth = row.depth;
        Probe probe(corridor(row.rho, 2.0f), settings);
        const double seen = probe.radiance({0, 0, 0}, {0, 0, 1}).x / (2.0 / (1.0 - rho));
        const double lost = std::pow(rho, row.depth + 1);
        EXPECT_NEAR(1.0 - seen, lost, 1e-6) << row.rho << ' ' << row.depth;
        EXPECT_NEAR(lost / row.lost, 1.0, 2e-3);
        // What the limit cut off is counted with its weight, at every depth.
        EXPECT_EQ(probe.counts().depth_cut, 1u) << row.depth;
        EXPECT_NEAR(probe.counts().depth_cut_weight, lost, 1e-6) << row.depth;
    }
}

TEST(Furnace, S_DEP_01_TenThousandBouncesNeedNoStack) {
    RenderSettings settings = centred();
    settings.depth = 10000;
    Probe probe(corridor(1.0f, 1.0f), settings);
    EXPECT_EQ(probe.radiance({0, 0, 0}, {0, 0, 1}).x, 10001.0);
    EXPECT_EQ(probe.counts().reflection, 10000u);
}

// What the limit cuts off is black and told, and never replaced by the background: it would look like light.
TEST(Furnace, S_DEP_02_CutBranchesAreBlackAndReported) {
    for (const bool clear : {false, true}) {
        for (const int depth : {0, 1, 2}) {
            SceneBuilder b;
            const std::uint32_t m = b.add_material(clear ? glass(1.5f) : mirror(0.8f));
            if (clear)
                b.add(Sphere{{0, 0, 0}, 1.0f}, m);
            else
                for (const double side : {-1.0, 1.0}) b.add(plane_at({0, 0, side}, {0, 0, -side}), m);
            b.scene().environment.color = glm::vec3(1.0f);
            RenderSettings settings = centred();
            settings.depth = depth;
            Probe probe(b.finish(), settings);
            const double seen = clear ? probe.radiance({0.3f, 0.2f, 4}, {0, 0, -1}).x : probe.radiance({0, 0, 0}, {0, 0, 1}).x;
            const RayCounts& counts = probe.counts();
            EXPECT_GT(counts.depth_cut, 0u);
            // Mirrors alone see no sky; glass sees what its uncut branches carry, and the rest is told.
            if (!clear) {
                EXPECT_EQ(seen, 0.0) << depth;
                EXPECT_NEAR(counts.depth_cut_weight, std::pow(0.8, depth + 1), 1e-6);
            } else {
                EXPECT_NEAR(seen + counts.depth_cut_weight, 1.0, 1e-6) << depth;
                EXPECT_LT(seen, depth == 0 ? 1e-9 : 0.97);
            }
        }
    }
}

// A ray that meets the unit ball of glass at the angle of incidence `angle`, in a white furnace.
double glass_ball_in_furnace(double angle, int depth, RayCounts* counts = nullptr) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(glass(1.5f)));
    b.scene().environment.color = glm::vec3(1.0f);
    RenderSettings settings = centred();
    settings.depth = depth;
    Probe probe(b.finish(), settings);
    const double seen = probe.radiance(Ray{glm::vec3(std::sin(radians(angle)), 0.0, 4.0), {0, 0, -1}, kInfinity}).x;
    if (counts != nullptr) *counts = probe.counts();
    return seen;
}

TEST(Furnace, O_DEP_02_AClearSphereCutAfterKInternalHits) {
    struct Row {
        double angle;
        int hits;
        double seen;
    };
    constexpr Row kRows[] = {{0, 1, .9616}, {0, 2, .998464}, {80, 1, .762610}, {80, 2, .907963}, {80, 3, .964317}};
    for (const Row& row : kRows) {
        RayCounts counts;
        // The way in is bounce 1, so the light of internal hit K leaves as bounce K + 1.
        const double seen = glass_ball_in_furnace(row.angle, row.hits + 1, &counts);
        EXPECT_NEAR(seen, row.seen, 2e-6) << row.angle << ' ' << row.hits;
        EXPECT_NEAR(seen + counts.depth_cut_weight, 1.0, 1e-6);
    }
}

// Largest deviation from 1 in units of the last place of 1.
double ulps_from_one(const Image& image) {
    double worst = 0.0;
    for (const glm::vec3& p : image.pixels) worst = std::max(worst, std::abs(static_cast<double>(p.x) - 1.0) / 0x1p-23);
    return worst;
}

TEST(Furnace, O_FUR_01_MirrorsAndGlassInWhiteAreInvisible) {
    RenderSettings settings = centred();
    settings.features.set(Feature::aa, true);
    settings.depth = 20000;
    for (const bool clear : {false, true}) {
        SceneBuilder b;
        const std::uint32_t m = b.add_material(clear ? glass(1.5f) : mirror(1.0f));
        b.add(Sphere{{-1.5f, 0, 0}, 1.0f}, m);
        if (!clear) b.add(Sphere{{1.5f, 0, 0}, 1.0f}, m);
        b.scene().environment.color = glm::vec3(1.0f);
        const Rendered r = render(b.finish(), camera_at({0, 0, 8}, glm::vec3(0.0f)), settings, {32, 16, 4});
        // Glass: the weights of all branches are each rounded once, and there are about 1/(1-F) of them.
        EXPECT_LE(ulps_from_one(r.image), 4.0) << clear;
        EXPECT_EQ(r.progress.rays.depth_cut, 0u) << clear;
        EXPECT_GT(r.progress.rays.reflection, 100u);
    }
}

TEST(Furnace, O_FUR_01_AMatteBallLitFromItsCentreIsEven) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(matte(0.5f)));
    Light light;
    light.falloff = Light::Falloff::physical;
    b.scene().lights.push_back(light);
    const Rendered r = render(b.finish(), camera_at({0.3f, 0.2f, 0.4f}, {1, 0, 0}, 100.0f), centred(), {});
    for (const glm::vec3& p : r.image.pixels) ASSERT_NEAR(p.x, 0.5f, 4.0f * 0x1p-24f);
    EXPECT_EQ(r.progress.rays.shadow, 64u * 64u);
}

// Parallel rays along -z on the upper half of a glass ball; the sky is white above y = 0 and black below. Each path stays in
// its plane of incidence and leaves, turned towards the axis, by 2(i - t) + k(pi - 2t) after k internal reflections; the
// reflection at the outside goes up. So the mean is an integral over the distance b from the axis alone.
double half_white_ball_by_quadrature(int depth) {
    constexpr int kSteps = 100000;
    double sum = 0.0;
    for (int step = 0; step < kSteps; ++step) {
        const double b = std::sqrt((step + 0.5) / kSteps);
        const double i = std::asin(b), t = std::asin(b / 1.5);
        const double s = std::sin(i - t) / std::sin(i + t), p = std::tan(i - t) / std::tan(i + t);
        const double f = 0.5 * (s * s + p * p);  // Fresnel's own form, by angles
        double seen = f, weight = (1.0 - f) * (1.0 - f);
        for (int k = 0; k + 2 <= depth; ++k, weight *= f) {
            if (std::sin(2.0 * (i - t) + k * (kPi - 2.0 * t)) < 0.0) seen += weight;
        }
        sum += seen;
    }
    return sum / kSteps;
}

TEST(Furnace, S_FRN_02_AGlassBallUnderAHalfWhiteSky) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(glass(1.5f)));
    Environment& e = b.scene().environment;
    e.kind = Environment::Kind::cube;
    const std::uint8_t w = 255;
    // Three rows from the bottom up: the texel changes exactly at the horizon.
    for (CubeFace& face : e.faces) face = {1, 3, {0, 0, 0, w, w, w, w, w, w}};
    e.faces[2] = {1, 1, {w, w, w}};
    e.faces[3] = {1, 1, {0, 0, 0}};
    ASSERT_EQ(e.radiance({1, -1e-6f, 0.2f}).x, 0.0f);
    const auto white = static_cast<double>(e.radiance({1, 1e-6f, 0.2f}).x);
    RenderSettings settings = centred();
    settings.depth = 8;
    Probe probe(b.finish(), settings);
    constexpr int kRadii = 1000, kAngles = 40, kRays = kRadii * kAngles;
    double upper = 0.0, lower = 0.0;
    for (int i = 0; i < kRays; ++i) {
        const double radius = std::sqrt((i % kRadii + 0.5) / kRadii), phi = kPi * (i / kRadii + 0.5) / kAngles;
        const glm::vec3 origin(radius * std::cos(phi), radius * std::sin(phi), 4.0);
        upper += probe.radiance(Ray{origin, {0, 0, -1}, kInfinity}).x / white;
        lower += probe.radiance(Ray{glm::vec3(origin.x, -origin.y, 4.0f), {0, 0, -1}, kInfinity}).x / white;
    }
    const double exact = half_white_ball_by_quadrature(settings.depth);
    note("measured", upper / kRays);
    note("exact", exact);
    EXPECT_NEAR(upper / kRays / exact, 1.0, 1e-3) << exact;
    // What a ray of the upper half does not see of white, its mirror image does; the depth limit takes the same from both.
    EXPECT_NEAR((upper + lower + 0.5 * probe.counts().depth_cut_weight) / kRays, 1.0, 1e-5);
}

}  // namespace
}  // namespace glint
