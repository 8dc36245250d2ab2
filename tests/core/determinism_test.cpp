// One picture however it is made, and never a trace of another: tile sizes, orders, splits into passes, instruction sets and
// threads give one hash; ten thousand restarts leave no sample of an old view in a new buffer.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <thread>

#include "core/tile_kernels.h"
#include "tests/accel/random.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint {
namespace {

constexpr int kSide = 48, kSpp = 5;

// FNV-1a (Fowler, Noll & Vo) of the picture's bits.
std::uint64_t hash_of(const Image& image) {
    std::uint64_t h = 0xcbf29ce484222325u;
    for (const glm::vec3& p : image.pixels) {
        for (int k = 0; k < 3; ++k) {
            for (std::uint32_t bits = std::bit_cast<std::uint32_t>(p[k]), i = 0; i < 4; ++i, bits >>= 8)
                h = (h ^ (bits & 0xffu)) * 0x100000001b3u;
        }
    }
    return h;
}

// How a picture is cut up: tiles of a size in an order, each pixel's samples in batches.
struct Schedule {
    int tile, batch;
    enum class Order { rows, backwards, random } order;
};

Image by_tiles(const Scene& scene, const AnyAccelerator& accelerator, const RenderSettings& settings, const Schedule& schedule) {
    const RenderPlan plan = plan_render(scene, settings, scene.cameras.front());
    const Camera camera(plan.camera, kSide, kSide);
    const std::atomic<std::uint64_t> generation{1};
    const KernelInput input{scene, accelerator, plan, camera, generation, 1};
    std::vector<TileRect> tiles;
    for (int y = 0; y < kSide; y += schedule.tile) {
        for (int x = 0; x < kSide; x += schedule.tile)
            tiles.push_back({x, y, std::min(x + schedule.tile, kSide), std::min(y + schedule.tile, kSide)});
    }
    Random random(9);
    if (schedule.order == Schedule::Order::backwards) std::reverse(tiles.begin(), tiles.end());
    if (schedule.order == Schedule::Order::random) {
        for (std::size_t i = tiles.size(); i > 1; --i) std::swap(tiles[i - 1], tiles[random.below(i)]);
    }
    Image image{kSide, kSide, std::vector<glm::vec3>(kSide * kSide)};
    Workspace work;
    for (const TileRect& rect : tiles) {
        std::vector<PixelSum> sums(rect.pixels());
        for (int first = 0; first < kSpp; first += schedule.batch)
            EXPECT_TRUE(render_tile(input, rect, first, std::min(kSpp, first + schedule.batch), sums, work));
        std::size_t i = 0;
        for (int y = rect.y0; y < rect.y1; ++y) {
            for (int x = rect.x0; x < rect.x1; ++x) image.at(x, y) = glm::vec3(sums[i++].radiance / static_cast<double>(kSpp));
        }
    }
    return image;
}

class OneHash : public testing::TestWithParam<const char*> {};

// The hash is printed, so that builds by other compilers and with other flags can be compared (`tests/run --long`).
TEST_P(OneHash, S_DET_01_OfEveryTileSizeOrderPassAcceleratorIsaAndThreadCount) {
    const auto scene = load_scene(GetParam());
    RenderSettings settings;
    settings.depth = 4;
    settings.seed = 3;
    using Order = Schedule::Order;
    const auto bvh = build_accelerator(AcceleratorKind::bvh, scene->geometry);
    const std::uint64_t expected = hash_of(by_tiles(*scene, *bvh, settings, {16, kSpp, Order::rows}));
    std::printf("one hash: %s %016llx\n", GetParam(), static_cast<unsigned long long>(expected));
    for_each_isa([&](Isa isa) {
        for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
            const bool slow = isa != Isa::baseline || scene->geometry->bounded_count() > 400;
            if (kind == AcceleratorKind::none && slow) continue;
            const auto accelerator = build_accelerator(kind, scene->geometry);
            int turn = static_cast<int>(kind);
            for (const int tile : {8, 16, 48, 13}) {
                const Schedule schedule{tile, 1 + (turn * 2) % 5, static_cast<Order>(turn % 3)};
                ++turn;
                EXPECT_EQ(hash_of(by_tiles(*scene, *accelerator, settings, schedule)), expected)
                    << kIsaNames[static_cast<std::size_t>(isa)] << ' ' << kAcceleratorNames[static_cast<std::size_t>(kind)] << ' '
                    << tile;
            }
        }
    });
    Picture p{kSide, kSide, kSpp, 1, AcceleratorKind::bvh, settings};
    for (const int threads : {1, 2, 3, 8}) {
        p.threads = threads;
        EXPECT_EQ(hash_of(render_picture(scene, p)), expected) << threads;
        if (threads != 2) continue;
        // Interrupted again and again, with previews.
        Renderer renderer(threads, true);
        renderer.restart(frame_of(scene, p));
        for (int i = 0; i < 6; ++i) {
            renderer.set_paused(i % 2 == 0);
            std::this_thread::yield();
        }
        renderer.set_paused(false);
        renderer.wait(1e9, nullptr);
        Image image;
        ASSERT_TRUE(renderer.resolve(image));
        EXPECT_EQ(hash_of(image), expected) << threads << " interrupted";
    }
}

INSTANTIATE_TEST_SUITE_P(Builtin, OneHash,
                         testing::Values("builtin:balls,level=2", "builtin:mount,level=3", "builtin:cornell",
                                         "builtin:glass,what=nested", "builtin:dof"),
                         test_name);

// Each frame shows one value in all its pixels, another one for each: two walls of different light, left and right of the
// eye, in one of eight scenes. So any sample of another frame stands out, whatever buffer it strayed into.
constexpr int kScenes = 8;

std::shared_ptr<const Scene> two_walls(int number) {
    SceneBuilder b;
    for (const float side : {-1.0f, 1.0f}) {
        const float value = static_cast<float>(2 * number + (side > 0.0f ? 2 : 1));
        b.add(test::plane_at({side, 0, 0}, {-side, 0, 0}), b.add_material(test::emitter(value)));
    }
    return b.finish();
}

TEST(Restarts, S_DET_02_NoSampleOfAnOldViewInANewBuffer) {
    std::vector<Frame> frames;
    for (int i = 0; i < 4 * kScenes; ++i) {
        Frame f;
        f.scene = two_walls(i % kScenes);
        f.accelerator = build_accelerator(AcceleratorKind::bvh, f.scene->geometry);
        f.camera = test::camera_at(glm::vec3(0.0f), {i / kScenes % 2 == 0 ? -1.0f : 1.0f, 0, 0});
        // Four sizes: neighbours in the list share their buffer or need another.
        f.width = i % 4 < 2 ? 40 : 23, f.height = i % 3 == 0 ? 36 : 17;
        f.spp = 1 + i % 5;
        frames.push_back(f);
    }
    const auto value_of = [](int i) { return static_cast<float>(2 * (i % kScenes) + (i / kScenes % 2 == 0 ? 1 : 2)); };
    Renderer renderer(3, true);
    Random random(2);
    int seen = 0, passes = 0;
    const int restarts = scale(10000, 200000);
    for (int k = 0; k < restarts; ++k) {
        const int i = static_cast<int>(random.below(frames.size()));
        renderer.restart(frames[static_cast<std::size_t>(i)]);
        // Looked at at once, a little later, or not at all.
        const std::uint32_t patience = random.below(8);
        for (std::uint32_t look = 0; look < patience; ++look) {
            std::this_thread::yield();
            Image image;
            const int pass = look % 2 == 1 ? renderer.resolve_pass(image) : 0;
            passes += pass > 0 ? 1 : 0;
            if (pass == 0 && !renderer.resolve(image)) continue;
            ++seen;
            ASSERT_EQ(image.width, frames[static_cast<std::size_t>(i)].width);
            ASSERT_EQ(image.height, frames[static_cast<std::size_t>(i)].height);
            for (const glm::vec3& p : image.pixels) ASSERT_EQ(p.x, value_of(i)) << "restart " << k << ", pass " << pass;
        }
    }
    EXPECT_GT(seen, restarts / 10);
    EXPECT_GT(passes, 0);
}

// The same with a picture of a real scene at the end of each hundred: equal to a fresh render.
TEST(Restarts, S_DET_02_TheLastFrameEqualsAFreshRender) {
    const auto scene = load_scene("builtin:glass,what=nested");
    Picture p;
    p.width = 40, p.height = 32, p.spp = 3;
    Frame frame = frame_of(scene, p);
    const CameraPose home = frame.camera;
    Renderer renderer(3, true);
    Random random(3);
    for (int round = 0; round < scale(10, 400); ++round) {
        for (int k = 0; k < 100; ++k) {
            frame.camera.eye = home.eye + 0.2f * random.in_cube(-1.0f, 1.0f);
            frame.width = 24 + static_cast<int>(random.below(3)) * 8;
            renderer.restart(frame);
            if (random.below(4) == 0) std::this_thread::yield();
        }
        renderer.wait(1e9, nullptr);
        Image last, fresh;
        ASSERT_TRUE(renderer.resolve(last));
        Renderer alone(1, false);
        alone.restart(frame);
        alone.wait(1e9, nullptr);
        ASSERT_TRUE(alone.resolve(fresh));
        ASSERT_EQ(differing_pixels(fresh, last), 0u) << round;
    }
}

}  // namespace
}  // namespace glint
