// Surface points of many hits: those of one hit at a time, bit for bit, whatever they are on and whoever their neighbours are.
#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "accel/brute_force.h"
#include "core/scene_io.h"
#include "core/surface_points.h"
#include "tests/core/render_picture.h"

namespace glint {
namespace {

void expect_same(glm::vec3 a, glm::vec3 b) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i]));
}

void expect_points_of_single_hits(const Scene& scene) {
    const BruteForce accelerator(scene.geometry);
    RayBatch rays;
    rays.clear(RayOrder::divergent);
    HitBatch hits;
    std::vector<std::uint32_t> lanes;
    const CameraPose& pose = scene.cameras.front();
    // Columns of the picture: runs of one kind, mixed ones, and a rest of less than a run.
    const Camera camera(pose, 16, 16);
    for (std::uint32_t i = 0; i < kRayBatch - 3; ++i) {
        rays.push(camera.ray(static_cast<float>(i / 16) + 0.3f, static_cast<float>(i % 16) + 0.7f, glm::vec2(0.0f)));
        hits.set(static_cast<int>(i), accelerator.closest_hit(rays[static_cast<int>(i)]));
        if (hits.primitive[i] != kNoPrimitive) lanes.push_back(i);
    }
    ASSERT_GT(lanes.size(), 8u);
    static SurfacePoints points;
    find_surface_points(scene, rays, hits, lanes, points);
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        const int lane = static_cast<int>(lanes[k]);
        const SurfacePoint one = surface_point(scene, rays[lane], hits[lane]), many = points[k];
        expect_same(many.p, one.p);
        expect_same(many.ng, one.ng);
        expect_same(many.ns, one.ns);
        expect_same(many.lift, one.lift);
        expect_same(vector_at(points.horizons(), k), horizon(one));
        EXPECT_EQ(many.bend, one.bend);
        EXPECT_EQ(many.outside, one.outside);
        EXPECT_EQ(many.error, one.error);
        EXPECT_EQ(many.error_from_afar, one.error_from_afar);
        EXPECT_EQ(many.material, one.material);
    }
}

class SurfacePointsOf : public testing::TestWithParam<const char*> {};

TEST_P(SurfacePointsOf, ManyHitsAreThoseOfEachFromEveryInstructionSet) {
    auto scene = load_scene(GetParam());
    // The same with normals at the vertices, some of which cancel out.
    auto smooth = std::make_shared<Scene>(*scene);
    for (std::size_t i = 0; i < scene->geometry->vertices.size(); ++i) {
        smooth->normals.push_back(i % 5 == 0 ? glm::vec3(0.0f) : glm::vec3(0.3f, i % 3 == 0 ? -0.8f : 0.8f, 0.2f));
    }
    for_each_isa([&](Isa) {
        expect_points_of_single_hits(*scene);
        if (!smooth->normals.empty()) expect_points_of_single_hits(*smooth);
    });
}

INSTANTIATE_TEST_SUITE_P(Builtin, SurfacePointsOf,
                         testing::Values("builtin:mount,level=3", "builtin:balls,level=2", "builtin:balls_box",
                                         "builtin:cornell"));

}  // namespace
}  // namespace glint
