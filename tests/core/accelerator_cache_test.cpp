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

TEST(AcceleratorCache, AutomaticTakesALoopForAHandfulAndATreeOtherwise) {
    EXPECT_EQ(automatic_accelerator(*load_scene("builtin:balls,level=0")), AcceleratorKind::none);
    EXPECT_EQ(automatic_accelerator(*load_scene("builtin:balls,level=2")), AcceleratorKind::bvh);
}

}  // namespace
}  // namespace glint
