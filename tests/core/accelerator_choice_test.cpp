// The cost model behind `auto`: what must hold whatever its constants are.
#include "core/accelerator_choice.h"

#include <gtest/gtest.h>

#include "core/scene_io.h"

namespace glint {
namespace {

constexpr AcceleratorChoice kNone = AcceleratorKind::none, kBvh = AcceleratorKind::bvh;
constexpr AcceleratorChoice kFast{AcceleratorKind::bvh, BuildQuality::fast};

TEST(AcceleratorChoice, ALoopForAHandfulOfRaysAQuickTreeForFewAGoodOneForMany) {
    const auto balls = load_scene("builtin:balls,level=2"), mesh = load_scene("builtin:knot,n=100000");
    EXPECT_EQ(automatic_accelerator(*balls, {10.0}), kNone);
    EXPECT_EQ(automatic_accelerator(*balls, {1.0e6}), kBvh);
    EXPECT_EQ(automatic_accelerator(*mesh, {5.0}), kNone);
    EXPECT_EQ(automatic_accelerator(*mesh, {1.0e5}), kFast);
    EXPECT_EQ(automatic_accelerator(*mesh, {1.0e9}), kBvh);
}

TEST(AcceleratorChoice, EmptyAndPlaneOnlyScenesHaveAFiniteEstimate) {
    Scene planes;
    planes.geometry = std::make_shared<const Geometry>();
    for (const double seconds : estimated_seconds(*planes.geometry, {1.0e6})) {
        EXPECT_TRUE(std::isfinite(seconds));
        EXPECT_GT(seconds, 0.0);
    }
}

TEST(AcceleratorChoice, EstimatesGrowWithRaysAndPrimitivesAndShrinkWithThreads) {
    const auto few = load_scene("builtin:balls,level=2"), many = load_scene("builtin:balls,level=4");
    const auto base = estimated_seconds(*few->geometry, {1.0e5});
    const auto more_rays = estimated_seconds(*few->geometry, {2.0e5}), more = estimated_seconds(*many->geometry, {1.0e5});
    const auto shared = estimated_seconds(*few->geometry, {1.0e5, 4});
    for (std::size_t i = 0; i < base.size(); ++i) {
        EXPECT_GT(base[i], 0.0);
        EXPECT_GT(more_rays[i], base[i]);
        EXPECT_GT(more[i], base[i]);
        EXPECT_LT(shared[i], base[i]);
        EXPECT_GT(4.0 * shared[i], 0.999 * base[i]) << "threads share out work, they do not save any";
    }
}

// More rays never make a cheaper build the better choice.
TEST(AcceleratorChoice, MoreRaysNeverAskForALesserTree) {
    const auto mesh = load_scene("builtin:knot,n=10000");
    bool quality = false;
    for (double rays = 1.0; rays < 1.0e11; rays *= 1.5) {
        const AcceleratorChoice choice = automatic_accelerator(*mesh, {rays, 2});
        EXPECT_FALSE(quality && choice != kBvh) << rays;
        quality = quality || choice == kBvh;
    }
    EXPECT_TRUE(quality);
}

// A crowd in the corner of a field: cells of the field's size would hold all of it.
TEST(AcceleratorChoice, S_GRD_04_NoGridForAStadium) {
    const auto stadium = load_scene("builtin:stadium,n=10000");
    for (double rays = 1.0; rays < 1.0e12; rays *= 3.0) {
        for (const int threads : {1, 2, 64})
            EXPECT_NE(automatic_accelerator(*stadium, {rays, threads}).kind, AcceleratorKind::grid) << rays << ' ' << threads;
    }
}

TEST(AcceleratorChoice, ExpectedRaysGoWithPixelsSamplesAndLights) {
    const auto scene = load_scene("builtin:balls,level=2");
    EXPECT_EQ(expected_rays(*scene, 200, 100, 8).rays, 2.0 * expected_rays(*scene, 100, 100, 8).rays);
    EXPECT_EQ(expected_rays(*scene, 100, 100, 8).rays, 8.0 * expected_rays(*scene, 100, 100, 1).rays);
    Scene more_lights = *scene;
    more_lights.lights.push_back(more_lights.lights.front());
    EXPECT_GT(expected_rays(more_lights, 100, 100, 8).rays, expected_rays(*scene, 100, 100, 8).rays);
}

}  // namespace
}  // namespace glint
