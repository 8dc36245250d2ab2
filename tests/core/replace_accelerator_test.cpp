// Another accelerator in the middle of a picture: same bits, nothing restarts, the old one is let go.
#include <thread>

#include <gtest/gtest.h>

#include "tests/core/render_picture.h"

namespace glint {
namespace {

constexpr Picture kPicture{72, 48, 16, 2, AcceleratorKind::bvh, {}};

Frame frame_with(const std::shared_ptr<const Scene>& scene, std::shared_ptr<const AnyAccelerator> accelerator) {
    Frame frame = frame_of(scene, kPicture);
    frame.accelerator = std::move(accelerator);
    return frame;
}

TEST(ReplaceAccelerator, SameBitsNoRestartAndTheOldOneIsLetGo) {
    const auto scene = load_scene("builtin:glass,what=ball");
    const auto quality = build_accelerator(AcceleratorKind::bvh, scene->geometry);
    const Image expected = render_picture(scene, kPicture);
    Renderer renderer(2, true);
    auto fast = build_accelerator(AcceleratorKind::bvh, scene->geometry, serial_for, BuildQuality::fast);
    const std::weak_ptr<const AnyAccelerator> old = fast;
    const std::uint64_t generation = renderer.restart(frame_with(scene, std::move(fast)));
    while (renderer.progress().spp_min == 0) std::this_thread::yield();
    const auto samples_before = renderer.progress().rays.camera;
    ASSERT_TRUE(renderer.replace_accelerator(generation, quality));
    // Any kind will do, and as often as one likes.
    ASSERT_TRUE(renderer.replace_accelerator(generation, build_accelerator(AcceleratorKind::grid, scene->geometry)));
    EXPECT_GE(renderer.progress().rays.camera, samples_before);
    EXPECT_EQ(renderer.progress().generation, generation);
    renderer.wait(1e9, nullptr);
    const Progress p = renderer.progress();
    EXPECT_TRUE(p.finished);
    EXPECT_EQ(p.generation, generation);
    EXPECT_EQ(p.rays.camera, 72u * 48u * 16u) << "no sample was taken twice";
    Image image;
    ASSERT_TRUE(renderer.resolve(image));
    EXPECT_EQ(differing_pixels(image, expected), 0u);
    // The last worker lets go of its order when it asks for the next tile.
    while (!old.expired()) std::this_thread::yield();
}

TEST(ReplaceAccelerator, AnOlderFramesAcceleratorIsRefused) {
    const auto scene = load_scene("builtin:balls,level=1");
    const auto bvh = build_accelerator(AcceleratorKind::bvh, scene->geometry);
    Renderer renderer(1, true);
    EXPECT_FALSE(renderer.replace_accelerator(0, bvh)) << "there is no frame yet";
    const std::uint64_t first = renderer.restart(frame_with(scene, bvh));
    const std::uint64_t second = renderer.restart(frame_with(scene, bvh));
    EXPECT_FALSE(renderer.replace_accelerator(first, bvh));
    EXPECT_TRUE(renderer.replace_accelerator(second, bvh));
}

}  // namespace
}  // namespace glint
