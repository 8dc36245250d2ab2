// Accelerators are built once, in the background, and handed out again.
#include "core/accelerator_cache.h"

#include <thread>

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

constexpr AcceleratorChoice kFast{AcceleratorKind::bvh, BuildQuality::fast};

TEST(AcceleratorCache, AFastTreeMakesRoomForTheBetterOne) {
    AcceleratorCache cache(load_scene("builtin:balls,level=3"));
    std::weak_ptr<const AnyAccelerator> first;
    {
        const auto fast = cache.wait(kFast);
        EXPECT_EQ(cache.wait(kFast), fast);
        first = fast;
    }
    EXPECT_GT(cache.build_seconds(kFast), 0.0);
    const auto better = cache.wait(AcceleratorKind::bvh);
    // The builder lets go of it after it has told us.
    while (!first.expired()) std::this_thread::yield();
    EXPECT_EQ(cache.request(kFast), better);
    EXPECT_EQ(cache.wait(kFast), better);
}

TEST(AcceleratorCache, AFirstLookComesBeforeTheBestAndOnlyWhereItPays) {
    const auto large = load_scene("builtin:soup,n=600000"), small = load_scene("builtin:balls,level=3");
    AcceleratorCache cache(large);
    std::shared_ptr<const AnyAccelerator> first;
    while (!(first = cache.request_best_so_far(AcceleratorKind::bvh, false))) std::this_thread::yield();
    EXPECT_EQ(cache.request_best_so_far(AcceleratorKind::bvh, true), first) << "now the better one is begun";
    EXPECT_GT(cache.build_seconds(kFast), 0.0) << "the fast one came first";
    const auto best = cache.wait(AcceleratorKind::bvh);
    EXPECT_NE(best, first);
    EXPECT_EQ(cache.request_best_so_far(AcceleratorKind::bvh, false), best);
    AcceleratorCache quick(small);
    while (!quick.request_best_so_far(AcceleratorKind::bvh, false)) std::this_thread::yield();
    EXPECT_EQ(quick.build_seconds(kFast), 0.0) << "nothing to win";
}

}  // namespace
}  // namespace glint
