// What the course's paper prints or leaves open, entry by entry of the catalogue's section 0: its own formula beside ours, with
// the number that tells them apart. Each is proved at length where the catalogue's IDs stand; here a slip cannot come back.
#include <gtest/gtest.h>

#include "core/error_metrics.h"
#include "core/scene_io.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

const Ray kForward{glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};

// Four comparisons that NaN passes one and all.
bool paper_triangle(const Ray& ray, glm::vec3 v0, glm::vec3 v1, glm::vec3 v2, float& t) {
    const glm::vec3 a = v1 - v0, b = v2 - v0, c = -ray.direction, d = ray.origin - v0;
    const float denom = glm::dot(a, glm::cross(b, c));
    const float beta = glm::dot(d, glm::cross(b, c)) / denom, gamma = glm::dot(a, glm::cross(d, c)) / denom;
    t = glm::dot(a, glm::cross(b, d)) / denom;
    if (beta < 0.0f || gamma < 0.0f || beta + gamma > 1.0f || t < 1e-4f) return false;
    return true;
}

TEST(SeedPaper, Slip_01_APointIsNotATriangle) {
    const glm::vec3 p(0.0f, 0.0f, 5.0f);
    float t = 0.0f;
    EXPECT_TRUE(paper_triangle(kForward, p, p, p, t) && std::isnan(t));
    Geometry g;
    g.vertices = {p, p, p};
    g.triangles = {{0, 1, 2}};
    const BruteForce ours(std::make_shared<const Geometry>(g));
    EXPECT_FALSE(ours.closest_hit(kForward).found());
    EXPECT_FALSE(ours.occluded(kForward));
}

TEST(SeedPaper, Slip_02_FresnelsSecondTerm) {
    // Both sum to 1 with what is transmitted, so a furnace sees nothing.
    const auto paper = [](double cos_i, double n) {
        const double cos_t = std::sqrt(1.0 - (1.0 - cos_i * cos_i) / (n * n));
        const double rs = (cos_i - n * cos_t) / (cos_i + n * cos_t), rp = (n * cos_i - n * cos_t) / (n * cos_i + n * cos_t);
        return 0.5 * (rs * rs + rp * rp);
    };
    EXPECT_NEAR(paper(1.0, 1.5), .02, 1e-9);
    EXPECT_NEAR(fresnel_dielectric(1.0, 1.0 / 1.5), .04, 1e-9);
    EXPECT_NEAR(paper(0.5, 1.5), .1171838, 1e-7);
    EXPECT_NEAR(fresnel_dielectric(0.5, 1.0 / 1.5), .0891867, 1e-7);
}

TEST(SeedPaper, Slip_03_NoFixedEpsilon) {
    const float far = 4096.0f;
    EXPECT_EQ(far + 1e-4f, far) << "it vanishes";
    for (const float distance : {0.0f, far, 1e6f}) {
        SceneBuilder b;
        b.add(Sphere{{0, distance, 0}, 1.0f}, b.add_material(black()));
        const auto scene = b.finish();
        const Ray ray{{0, distance + 3, 0}, {0, -1, 0}};
        const SurfacePoint s = surface_point(*scene, ray, BruteForce(scene->geometry).closest_hit(ray));
        EXPECT_GT(spawn_origin(s, s.ng).y, s.p.y) << distance;
        if (distance == 0.0f) {
            EXPECT_LT(s.error, 1e-6f) << "it swallows what is smaller than it";
        }
    }
}

TEST(SeedPaper, Slip_04_ABallLensMagnifiesByTheBook) {
    SceneBuilder b;
    b.add(Sphere{glm::vec3(0.0f), 1.0f}, b.add_material(glass(1.5f)));
    RenderSettings settings = centred();
    settings.features.set(Feature::reflections, false);
    Probe probe(b.finish(), settings);
    probe.radiance({0.1f, 0, -4}, {0, 0, 1});
    ASSERT_EQ(probe.rays().size(), 3u);
    const glm::vec3 out = probe.rays().back().direction, within = probe.rays()[1].direction;
    EXPECT_NEAR(degrees(std::atan2(-out.x, out.z)), 3.8332335, 1e-5);
    // What one sees without the second refraction, and with the index upside down.
    EXPECT_NEAR(degrees(std::atan2(-within.x, within.z)), 1.9166, 1e-4);
    EXPECT_NEAR(2.0 * degrees(std::asin(.1) - std::asin(.15)), -5.7755, 1e-4);
}

TEST(SeedPaper, Slip_05_WhatStandsBehindALightCastsNoShadow) {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(matte(1.0f)));
    b.add(Box{{-9, 3, -9}, {9, 3, 9}}, b.add_material(black()));
    b.scene().lights = {point_light({0, 2, 0})};
    const auto scene = b.finish();
    EXPECT_TRUE(BruteForce(scene->geometry).occluded({{0, 1e-3f, 0}, {0, 1, 0}})) << "a ray without end meets the plate";
    EXPECT_NEAR(Probe(scene, centred()).radiance({0, 1, 0}, {0, -1, 0}).x, 1.0, 1e-6);
}

TEST(SeedPaper, Slip_06_NoHighlightFromBelowTheHorizon) {
    const glm::dvec3 n(0, 1, 0), l(std::sqrt(0.99), -0.1, 0.0), v(-0.2, std::sqrt(0.96), 0.0);
    EXPECT_GT(glm::dot(n, glm::normalize(l + v)), 0.6) << "clamped alone it would shine";
    EXPECT_LT(glm::dot(n, l), 0.0) << "unclamped it would take light away";
    SceneBuilder b;
    Material m = highlight(1.0f, 2.0f);
    m.diffuse = glm::vec3(1.0f);
    b.add(plane_at(glm::dvec3(0.0), n), b.add_material(m));
    b.scene().lights = {sun(l)};
    EXPECT_EQ(Probe(b.finish(), centred()).radiance(glm::vec3(v), glm::vec3(-v)).x, 0.0);
}

TEST(SeedPaper, Slip_07_AnAreaLightIsNotItsCentre) {
    SceneBuilder b;
    b.add(plane_at(glm::dvec3(0.0), {0, 1, 0}), b.add_material(matte(1.0f)));
    Light lamp;
    lamp.shape = Light::Shape::quad, lamp.falloff = Light::Falloff::physical;
    lamp.position = {-1, 2, -1}, lamp.edge1 = {2, 0, 0}, lamp.edge2 = {0, 0, 2};
    b.scene().lights = {lamp};
    const auto scene = b.finish();
    Probe soft(scene);
    EXPECT_NEAR(estimate_radiance(soft, {0, 0.5f, 0}, {0, -1, 0}, 8, 512).mean, .752274688, 2e-3);
    EXPECT_NEAR(Probe(scene, centred()).radiance({0, 0.5f, 0}, {0, -1, 0}).x, 1.0, 1e-6) << "the centre for all of it";
}

TEST(SeedPaper, Slip_08_StrataArePairedAtRandom) {
    constexpr int n = 4;
    double paired = 0.0, ours = 0.0;
    for (int i = 0; i < n * n; ++i) paired += (i % n + 0.5) / n * ((i % n + 0.5) / n) / (n * n);
    EXPECT_NEAR(paired, 1.0 / 3.0 - 1.0 / (12.0 * n * n), 1e-12) << "stratum by stratum";
    constexpr std::uint32_t kPixels = 4096;
    for (std::uint32_t k = 0; k < kPixels * n * n; ++k) {
        const Sampler s(SamplerKind::jittered, k / (n * n), 3, k % (n * n), 1);
        ours += static_cast<double>(s.square(dimension::pixel).x * s.square(dimension::lens).x) / (kPixels * n * n);
    }
    EXPECT_NEAR(ours, 0.25, 3.0 * std::sqrt(7.0 / 144.0 / (kPixels * n * n)));
}

TEST(SeedPaper, Slip_09_FocusIsMeasuredAlongTheAxis) {
    CameraPose pose = camera_at(glm::vec3(0.0f), {0, 0, -1}, 90.0f);
    pose.lens_radius = 0.1f, pose.focus_distance = 4.0f;
    const Camera camera(pose, 64, 64);
    const Ray edge = camera.ray(64.0f, 32.0f, {1, 0}), centre = camera.ray(64.0f, 32.0f, {0, 0});
    const auto at_focus = [](const Ray& r) { return r.origin.x - (r.origin.z + 4.0f) / r.direction.z * r.direction.x; };
    EXPECT_NEAR(at_focus(edge), at_focus(centre), 4e-6f);
    EXPECT_NEAR(0.1 * (4.0 - 4.0 * std::cos(kPi / 4)) / (4.0 * std::cos(kPi / 4)), .0414, 1e-4) << "by the ray's length";
}

TEST(SeedPaper, Slip_10_AFuzzyRayIsUnitAndNeverGoesBelow) {
    Random random(10);
    const glm::vec3 n(0, 1, 0);
    for (int i = 0; i < 20000; ++i) {
        const glm::vec3 r = glm::normalize(glm::vec3(1, 0.05f, 0)), u(random.direction() * std::cbrt(random.uniform()));
        const glm::vec3 d = fuzzy_direction(r, n, 0.5f, u);
        ASSERT_GE(d.y, 0.0f);
        ASSERT_NEAR(glm::length(d), 1.0f, 3e-7f);
    }
    EXPECT_EQ(fuzzy_direction(n, n, 1.0f, -n), n) << "a sum of zero";
}

TEST(SeedPaper, Slip_11_TheFirstHitFoundIsNotTheNearest) {
    auto g = std::make_shared<Geometry>();
    g->vertices = {{0.0f, 0.0f, 0.5f}, {3.0f, 0.6f, 0.0f}, {3.0f, 0.6f, 1.0f}};
    g->triangles = {{0, 1, 2}};
    g->spheres = {{{1.5f, 0.5f, 0.5f}, 0.2f}};
    const Ray ray{{-1.0f, 0.5f, 0.5f}, {1, 0, 0}};
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh})
        EXPECT_FLOAT_EQ(closest_hit(*build_accelerator(kind, g), ray).t, 2.3f) << "3.5 is the triangle's, from the first cell";
}

TEST(SeedPaper, Slip_12_TheTreeTestsLessThanTheGrid) {
    const auto scene = load_scene("builtin:knot,n=20000");
    const Bvh bvh(scene->geometry);
    const UniformGrid grid(scene->geometry);
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    Random random(12);
    const std::vector<glm::vec3>& vertices = scene->geometry->vertices;
    const float size = glm::length(scene->geometry->bounds().size());
    while (batch.count < kRayBatch) {
        const auto at = vertices[static_cast<std::size_t>(random.uniform() * static_cast<double>(vertices.size()))];
        const glm::vec3 eye = at + size * glm::vec3(random.direction());
        batch.push({eye, at - eye});
    }
    const TraversalCounts tree = bvh.count_traversal(batch), cells = grid.count_traversal(batch);
    note("tree_nodes_a_ray", static_cast<double>(tree.nodes) / kRayBatch);
    note("tree_blocks_a_ray", static_cast<double>(tree.leaves) / kRayBatch);
    note("grid_cells_a_ray", static_cast<double>(cells.nodes) / kRayBatch);
    note("grid_blocks_a_ray", static_cast<double>(cells.leaves) / kRayBatch);
    EXPECT_LT(tree.nodes + tree.leaves, cells.nodes + cells.leaves) << "in the paper the tree takes 2.4 times the grid's time";
}

TEST(SeedPaper, Slip_13_WhatADepthLimitTakesIsTold) {
    SceneBuilder b;
    Material m = mirror(0.9f);
    m.emission = glm::vec3(1.0f);
    for (const double side : {-1.0, 1.0}) b.add(plane_at({0, 0, side}, {0, 0, -side}), b.add_material(m));
    RenderSettings settings = centred();
    settings.depth = 5;
    Probe probe(b.finish(), settings);
    const double seen = probe.radiance(kForward).x, all = 10.0;
    EXPECT_NEAR(1.0 - seen / all, .531, 1e-3);
    EXPECT_NEAR(probe.counts().depth_cut_weight * all + seen, all, 1e-5);
}

TEST(SeedPaper, Slip_14_APictureHasASeedAMetricAndAnErrorBar) {
    const auto scene = load_scene("builtin:cornell");
    const auto picture = [&](std::uint64_t seed, SamplerKind sampler, int spp, double* bar) {
        RenderSettings settings;
        settings.seed = seed, settings.sampler = sampler;
        Frame frame;
        frame.scene = scene, frame.accelerator = build_accelerator(AcceleratorKind::bvh, scene->geometry);
        frame.camera = scene->cameras.front(), frame.settings = settings;
        frame.width = frame.height = 32, frame.spp = spp;
        Renderer renderer(2, false);
        renderer.restart(frame);
        renderer.wait(1e9, nullptr);
        Image image;
        EXPECT_TRUE(renderer.resolve(image));
        if (bar != nullptr) *bar = renderer.error().relrmse;
        return image;
    };
    double bar = 0.0;
    const Image one = picture(1, SamplerKind::random, 256, &bar), again = picture(1, SamplerKind::random, 256, nullptr);
    EXPECT_EQ(difference(one, again).differing, 0u);
    const Image reference = picture(99, SamplerKind::sobol, 1024, nullptr);
    const double error = std::sqrt(error_metrics(one, reference).relmse);
    note("bar", bar), note("error", error);
    EXPECT_NEAR(error / bar, 1.0, 0.35) << "what the error bar says is what is wrong";
}

}  // namespace
}  // namespace glint
