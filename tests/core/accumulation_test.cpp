// Sums of samples: constants over many passes, samples that are not finite, and tiles of old generations.
#include <limits>

#include <gtest/gtest.h>

#include "core/framebuffer.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A picture of one pixel that got `n` samples as the kernels add them.
template <class Sample>
Framebuffer one_pixel(int n, const Sample& sample) {
    Framebuffer framebuffer({0, 0, 1, 1});
    std::vector<PixelSum> sums(1);
    Doublings doublings{};
    for (int i = 0; i < n; ++i) {
        const glm::vec3 c(sample(i));
        sums[0].add(&c, doublings);
    }
    framebuffer.write_back(0, 1, sums, n, doublings);
    return framebuffer;
}

Image blank(int width, int height, float value = 0.0f) {
    return {width, height,
            std::vector<glm::vec3>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), glm::vec3(value))};
}

TEST(Accumulation, S_ACC_01_AConstantStaysItselfOverMillionsOfSamples) {
    for (const int n : {1000000, 10000000, 100000000}) {
        const Framebuffer framebuffer = one_pixel(n, [](int) { return 0.1f; });
        Image image = blank(1, 1);
        framebuffer.resolve(0, 1, image);
        EXPECT_EQ(image.at(0, 0).x, 0.1f) << n;
    }
}

TEST(Accumulation, S_ACC_02_ASpreadOnAHighPedestal) {
    // 10^4 + {0 in the first half, 1 in the second}: the last doubling moves the mean by 1/2, those before not at all.
    for (const int n : {2, 1024, 1 << 20}) {
        const Framebuffer framebuffer = one_pixel(n, [n](int i) { return 1e4f + static_cast<float>(2 * i >= n); });
        const Doublings doublings = framebuffer.doublings(1, n);
        const std::size_t last = doublings_within(n) - 1;
        EXPECT_NEAR(doublings[last].fresh.sum * (10000.5 * 10000.5 + 0.01), 0.25, 1e-6) << n;
        for (std::size_t k = 0; k < last; ++k) EXPECT_EQ(doublings[k].fresh.sum, 0.0) << n;
    }
    EXPECT_EQ(one_pixel(1, [](int) { return 1.0f; }).doublings(1, 1), Doublings{});
}

// A 4 x 4 picture of a sky in which a tiny ball stands in the way of one sample of pixel (2, 1).
constexpr int kSide = 4, kSpp = 16, kBadX = 2, kBadY = 1, kBadIndex = 11;

CameraPose small_camera() { return camera_at(glm::vec3(0.0f), {0, 0, -1}, 60.0f); }

Rendered sky_with_a_spark(float emission, int threads) {
    SceneBuilder b;
    b.scene().environment.kind = Environment::Kind::sky;
    if (emission != 0.0f) {
        const RenderSettings settings;
        const Sampler sampler(settings.sampler, kBadX, kBadY, kBadIndex, settings.seed);
        const glm::vec2 at = glm::vec2(kBadX, kBadY) + sampler.square(dimension::pixel);
        const Ray ray = Camera(small_camera(), kSide, kSide).ray(at.x, at.y, glm::vec2(0.0f));
        b.add(Sphere{10.0f * ray.direction, 1e-4f}, b.add_material(emitter(emission)));
    }
    RenderSettings settings;
    settings.features.set(Feature::dof, false);
    return render(b.finish(), small_camera(), settings, {kSide, kSide, kSpp, threads});
}

TEST(Accumulation, S_ACC_03_OneSampleThatIsNotFiniteIsRejectedAndCounted) {
    const Rendered clean = sky_with_a_spark(0.0f, 1);
    EXPECT_EQ(clean.progress.rays.non_finite, 0u);
    const Rendered black_dot = sky_with_a_spark(-1.0f, 1);  // radiance -1, to tell the missing sample's share
    for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        for (const int threads : {1, 2}) {
            const Rendered hurt = sky_with_a_spark(bad, threads);
            EXPECT_EQ(hurt.progress.rays.non_finite, 1u);
            EXPECT_EQ(hurt.progress.rays.camera, static_cast<std::uint64_t>(kSide * kSide * kSpp));
            for (int y = 0; y < kSide; ++y) {
                for (int x = 0; x < kSide; ++x) {
                    if (x == kBadX && y == kBadY) continue;
                    EXPECT_EQ(hurt.image.at(x, y), clean.image.at(x, y)) << x << ' ' << y;
                }
            }
            // The pixel is the mean of its other samples: 15 m = 16 m' + 1, where m' had -1 for the missing one.
            const auto expected = (kSpp * static_cast<double>(black_dot.image.at(kBadX, kBadY).x) + 1.0) / (kSpp - 1);
            EXPECT_NEAR(static_cast<double>(hurt.image.at(kBadX, kBadY).x), expected, 1e-6);
        }
    }
}

// A clamp would be a bias that nobody sees: however bright a sample is, the mean holds all of it.
TEST(Accumulation, S_ACC_04_ABrightSampleCountsInFull) {
    const Rendered black_dot = sky_with_a_spark(-1.0f, 1);
    for (const float bright : {1e3f, 1e6f, 1e12f, 1e30f}) {
        const Rendered spark = sky_with_a_spark(bright, 2);
        EXPECT_EQ(spark.progress.rays.non_finite, 0u);
        const double others = kSpp * static_cast<double>(black_dot.image.at(kBadX, kBadY).x) + 1.0;
        const double expected = (others + static_cast<double>(bright)) / kSpp;
        EXPECT_NEAR(static_cast<double>(spark.image.at(kBadX, kBadY).x) / expected, 1.0, 1e-6) << bright;
    }
}

TEST(Accumulation, APixelWithoutAnyFiniteSampleIsBlackAndCounted) {
    SceneBuilder b;
    b.scene().environment.color = glm::vec3(std::numeric_limits<float>::infinity());
    RenderSettings jittered = centred();
    jittered.features.set(Feature::aa, true);
    const Rendered r = render(b.finish(), small_camera(), jittered, {kSide, kSide, 3});
    EXPECT_EQ(r.progress.rays.non_finite, 48u);
    for (const glm::vec3& p : r.image.pixels) EXPECT_EQ(p, glm::vec3(0.0f));
}

TEST(Framebuffer, TilesCoverTheAreaOnce) {
    for (const TileRect area : {TileRect{0, 0, 1, 1}, {0, 0, 16, 16}, {3, 5, 50, 38}, {0, 0, 17, 33}}) {
        const Framebuffer framebuffer(area);
        std::vector<int> covered(area.pixels());
        for (std::size_t i = 0; i < framebuffer.tile_count(); ++i) {
            const TileRect r = framebuffer.tile_rect(i);
            EXPECT_LE(r.x1 - r.x0, kTileSize);
            EXPECT_LE(r.y1 - r.y0, kTileSize);
            for (int y = r.y0; y < r.y1; ++y) {
                for (int x = r.x0; x < r.x1; ++x) {
                    ++covered[static_cast<std::size_t>((y - area.y0) * (area.x1 - area.x0) + x - area.x0)];
                }
            }
        }
        for (const int c : covered) ASSERT_EQ(c, 1);
    }
}

TEST(Framebuffer, ATileOfAnOldGenerationCountsAsEmpty) {
    Framebuffer framebuffer({0, 0, 16, 16});
    std::vector<PixelSum> sums(256);
    for (PixelSum& s : sums) s.radiance = glm::dvec3(6.0), s.taken = 2;
    Doublings doublings{};
    doublings[0].fresh.add(0.5);
    framebuffer.write_back(0, 7, sums, 2, doublings);
    EXPECT_EQ(framebuffer.samples(0, 7), 2);
    EXPECT_EQ(framebuffer.samples(0, 8), 0);
    EXPECT_EQ(framebuffer.doublings(7, 2)[0].fresh.sum, 0.5);
    EXPECT_EQ(framebuffer.doublings(7, 1)[0].fresh.sum, 0.0);
    EXPECT_EQ(framebuffer.doublings(8, 2)[0].fresh.sum, 0.0);
    std::vector<PixelSum> copy;
    framebuffer.copy_out(0, 7, copy);
    EXPECT_EQ(copy[5].radiance.x, 6.0);
    framebuffer.copy_out(0, 8, copy);
    ASSERT_EQ(copy.size(), 256u);
    EXPECT_EQ(copy[5].radiance.x, 0.0);
    EXPECT_EQ(copy[5].taken, 0u);
    Image image = blank(16, 16, 0.25f);
    framebuffer.resolve(0, 8, image);
    EXPECT_EQ(image.at(3, 3).x, 0.25f);
    framebuffer.resolve(0, 7, image);
    EXPECT_EQ(image.at(3, 3).x, 3.0f);
}

TEST(Framebuffer, APreviewShowsUntilThereIsASampleOfItsGeneration) {
    // A cropped area of odd size: two by one blocks in its only tile.
    Framebuffer framebuffer({5, 9, 16, 15});
    ASSERT_EQ(framebuffer.tile_count(), 1u);
    ASSERT_EQ(preview_blocks(11), 2);
    framebuffer.write_preview(0, 3, {glm::vec3(0.5f), glm::vec3(0.75f)});
    Image image = blank(11, 6, 9.0f);
    framebuffer.resolve(0, 4, image);
    EXPECT_EQ(image.at(0, 0).x, 9.0f);
    framebuffer.resolve(0, 3, image);
    EXPECT_EQ(image.at(7, 5).x, 0.5f);
    EXPECT_EQ(image.at(8, 0).x, 0.75f);
    std::vector<PixelSum> sums(66);
    for (PixelSum& s : sums) s.radiance = glm::dvec3(2.0);
    framebuffer.write_back(0, 3, sums, 1);
    framebuffer.resolve(0, 3, image);
    EXPECT_EQ(image.at(7, 5).x, 2.0f);
    // The next generation's preview beats the last one's samples, and neither shows where it is stale.
    framebuffer.write_preview(0, 5, {glm::vec3(0.1f), glm::vec3(0.2f)});
    framebuffer.resolve(0, 5, image);
    EXPECT_EQ(image.at(10, 5).x, 0.2f);
}

}  // namespace
}  // namespace glint
