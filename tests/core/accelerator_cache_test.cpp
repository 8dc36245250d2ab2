// Accelerators are built once, in the background, and handed out again.
#include "core/accelerator_cache.h"

#include <gtest/gtest.h>

#include "core/scene_io.h"

namespace glint {
namespace {

TEST(AcceleratorCache, EachKindIsBuiltOnceAndKept) {
    AcceleratorCache cache(load_scene("builtin:balls,level=3"));
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto built = cache.wait(kind);
        ASSERT_NE(built, nullptr);
        EXPECT_EQ(kind_of(*built), kind);
        EXPECT_EQ(cache.request(kind), built);
        EXPECT_EQ(cache.wait(kind), built);
        EXPECT_FALSE(cache.failed(kind));
    }
    EXPECT_GT(cache.build_seconds(AcceleratorKind::bvh), 0.0);
}

TEST(AcceleratorCache, RequestingDoesNotWaitAndLeavingDoesNotLoseTheBuild) {
    const auto scene = load_scene("builtin:mount,level=7");
    AcceleratorCache cache(scene);
    // Whatever the first answer, asking again never starts a second build.
    const auto first = cache.request(AcceleratorKind::bvh);
    const auto built = cache.wait(AcceleratorKind::bvh);
    EXPECT_TRUE(first == nullptr || first == built);
    const AcceleratorCache abandoned(scene);
}

TEST(AcceleratorCache, AutomaticTakesALoopWhereATreeHasNothingToSave) {
    Scene planes;
    planes.geometry = std::make_shared<const Geometry>();
    EXPECT_EQ(automatic_accelerator(planes), AcceleratorKind::none);
    EXPECT_EQ(automatic_accelerator(*load_scene("builtin:balls,level=2")), AcceleratorKind::bvh);
    // A tree for a handful of rays costs more than it saves.
    EXPECT_EQ(automatic_accelerator(*load_scene("builtin:balls,level=4"), {10.0}), AcceleratorKind::none);
}

TEST(AcceleratorCache, EstimatesGrowWithRaysAndPrimitives) {
    const auto few = load_scene("builtin:balls,level=2"), many = load_scene("builtin:balls,level=4");
    const auto base = estimated_seconds(*few->geometry, {1.0e5});
    const auto more_rays = estimated_seconds(*few->geometry, {2.0e5}), more = estimated_seconds(*many->geometry, {1.0e5});
    for (std::size_t i = 0; i < base.size(); ++i) {
        EXPECT_GT(base[i], 0.0);
        EXPECT_GT(more_rays[i], base[i]);
        EXPECT_GT(more[i], base[i]);
    }
    EXPECT_EQ(expected_rays(*few, 200, 100, 8).rays, 2.0 * expected_rays(*few, 100, 100, 8).rays);
}

}  // namespace
}  // namespace glint
