// Adaptive sampling: the rule alone, then whole pictures: the same bits whoever renders them, no bias, an error bar that holds,
// and fewer rays for the same error.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "core/adaptive.h"
#include "core/error_metrics.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// Doubles what tiles_to_double() says until it is done; tile i errs as share[i] / samples.
std::vector<TileState> tiles_at(int spp, const std::vector<double>& share) {
    std::vector<TileState> tiles(share.size(), TileState{1, 256});
    for (std::vector<std::size_t> next; !(next = tiles_to_double(tiles, spp)).empty();) {
        for (const std::size_t i : next) {
            TileState& t = tiles[i];
            t.samples = doubled(t.samples);
            t.change_before = t.change;
            t.change = share[i] / t.samples;
            t.work = static_cast<std::uint64_t>(t.samples) * t.pixels;
        }
    }
    return tiles;
}

double mean_samples(const std::vector<TileState>& tiles) {
    double sum = 0.0;
    for (const TileState& t : tiles) sum += t.samples;
    return sum / static_cast<double>(tiles.size());
}

TEST(Adaptive, AllTilesAreSampledAlikeAtFirst) {
    const std::vector<double> share{1.0, 0.0, 5.0};
    for (const int spp : {1, 2, 4, kUniformSamples}) {
        for (const TileState& t : tiles_at(spp, share)) EXPECT_EQ(t.samples, spp);
    }
}

TEST(Adaptive, TheMeanIsNeverExceededAndNearlyReached) {
    std::vector<double> share;
    for (int i = 0; i < 400; ++i) share.push_back(std::exp2(i % 12));
    for (const int spp : {9, 16, 50, 64, 1000, 4096}) {
        const double mean = mean_samples(tiles_at(spp, share));
        EXPECT_LE(mean, spp);
        EXPECT_GE(mean, 0.98 * spp);
    }
}

// Errors that fall as 1/N are least for a given sum of samples where N goes with their root.
TEST(Adaptive, SamplesGoWithTheRootOfTheError) {
    std::vector<double> share(200, 1.0);
    for (std::size_t i = 100; i < 200; ++i) share[i] = 16.0;
    const std::vector<TileState> tiles = tiles_at(1024, share);
    double poor = 0.0, rich = 0.0;
    for (std::size_t i = 0; i < 100; ++i) poor += tiles[i].samples, rich += tiles[i + 100].samples;
    EXPECT_NEAR(std::log2(rich / poor), 2.0, 0.6);
}

TEST(Adaptive, S_ADP_03_NoTileIsLeftBehindForHavingShownNothing) {
    std::vector<double> share(50, 1.0);
    share[7] = 0.0;
    for (const int spp : {64, 512, 4096}) EXPECT_GE(tiles_at(spp, share)[7].samples * kMostBehind, spp / 2);
}

// What a higher mean asks for begins with what a lower one asked for.
TEST(Adaptive, EveryPowerOfTwoIsPassedOnTheWay) {
    std::vector<double> share;
    for (int i = 0; i < 60; ++i) share.push_back(1.0 + (i * 37) % 11);
    const std::vector<TileState> lower = tiles_at(64, share), upper = tiles_at(256, share);
    for (std::size_t i = 0; i < share.size(); ++i) EXPECT_LE(lower[i].samples, upper[i].samples);
}

Picture adaptive_picture(const Scene& scene, int width, int height, int spp) {
    Picture p{width, height, spp, 2, AcceleratorKind::bvh, {}};
    p.settings.features = features_of(scene);
    p.settings.adaptive = true;
    return p;
}

TEST(Adaptive, S_DET_01_SameBitsFromThreadsAcceleratorsAndPauses) {
    for (const char* spec : {"builtin:balls,level=1", "builtin:dof", "builtin:cornell"}) {
        const auto scene = load_scene(spec);
        Picture p = adaptive_picture(*scene, 70, 50, 32);
        const Image expected = render_picture(scene, p);
        for (const int threads : {1, 3, 8}) {
            p.threads = threads;
            EXPECT_EQ(differing_pixels(render_picture(scene, p), expected), 0u) << spec << ' ' << threads;
        }
        for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid}) {
            p.accelerator = kind;
            EXPECT_EQ(differing_pixels(render_picture(scene, p), expected), 0u) << spec;
        }
        for_each_isa([&](Isa isa) {
            p.accelerator = AcceleratorKind::bvh;
            EXPECT_EQ(differing_pixels(render_picture(scene, p), expected), 0u)
                << spec << ' ' << kIsaNames[static_cast<std::size_t>(isa)];
        });
        // By steps, as --noise goes.
        Renderer renderer(2, true);
        p.spp = 1;
        const std::uint64_t generation = renderer.restart(frame_of(scene, p));
        for (int spp = 1; spp <= 32; spp *= 2) {
            EXPECT_TRUE(renderer.extend(generation, spp));
            renderer.wait(1e9, nullptr);
        }
        Image stepped;
        EXPECT_TRUE(renderer.resolve(stepped));
        EXPECT_EQ(differing_pixels(stepped, expected), 0u) << spec;
        const Progress progress = renderer.progress();
        EXPECT_LT(progress.spp_min, progress.spp_max) << spec << ": nothing was adaptive";
    }
}

// Independent samples, so that errors fall as 1/N: `share` of the error is where the pixels are `part` of all.
ErrorEstimate two_strata(double share, double part) {
    constexpr int kSamples = 64;
    constexpr std::size_t kPixels = 1000;
    std::array<Stratum, 2> strata{};
    for (const std::size_t i : {0, 1}) {
        strata[i].spp = kSamples;
        strata[i].pixels = static_cast<std::size_t>((i == 0 ? part : 1.0 - part) * kPixels);
        for (std::size_t k = 0; k < 6; ++k)
            strata[i].doublings[k].fresh.sum = (i == 0 ? share : 1.0 - share) * std::exp2(-double(k));
        for (Doubling& d : strata[i].doublings) d.settled = d.fresh;
    }
    return estimate_error(strata, kSamples, {SamplerKind::random});
}

// Forecasts count with what choosing tiles spares, half of it. All error in half of the pixels: 2 * 4 more samples there, none
// elsewhere, make 2.5 times all samples, not 4.
TEST(Adaptive, C_10_ForecastsCountWithTheChoiceOfTiles) {
    EXPECT_NEAR(two_strata(0.5, 0.5).spared, 1.0, 0.01);
    EXPECT_NEAR(times_until(two_strata(0.5, 0.5), 0.25), 16.0, 0.3);
    const ErrorEstimate e = two_strata(1.0, 0.5);
    EXPECT_NEAR(e.spared, std::sqrt(2.5 / 4.0), 0.02);
    EXPECT_NEAR(times_until(e, 0.5), 4.0 * e.spared, 1e-6);
    EXPECT_NEAR(times_until(e, 0.25), 16.0 * e.spared, 1e-6);
    EXPECT_NEAR(times_until(e, 1.0), 1.0, 1e-6);
    // The fewer pixels have the error, the more is spared.
    EXPECT_LT(two_strata(1.0, 0.1).spared, two_strata(1.0, 0.5).spared);
}

TEST(Adaptive, WhereNothingIsRandomOneSampleIsTaken) {
    const auto scene = load_scene("builtin:balls,level=1");
    Picture p = adaptive_picture(*scene, 40, 30, 64);
    p.settings.features = FeatureSet::whitted();
    Progress progress;
    render_picture(scene, p, &progress);
    EXPECT_EQ(progress.spp_max, 1);
}

Image truth_of(const std::shared_ptr<const Scene>& scene, Picture p) {
    p.settings.adaptive = false;
    p.settings.sampler = SamplerKind::joint, p.settings.seed = 999;
    p.spp = 2048;
    return render_picture(scene, p);
}

double mean_of(const Image& image) {
    double sum = 0.0;
    for (const glm::vec3 c : image.pixels) sum += static_cast<double>(c.x + c.y + c.z);
    return sum / static_cast<double>(image.pixels.size());
}

struct AgainstEven {
    double rays = 0.0, relmse = 0.0;  // adaptive over even, for the same mean of samples
    double bias = 0.0, z = 0.0;       // of the picture's mean: relative, and over its standard error
};

AgainstEven against_even(const char* spec, int spp, int seeds) {
    const auto scene = load_scene(spec);
    Picture p = adaptive_picture(*scene, 96, 64, spp);
    const Image truth = truth_of(scene, p);
    std::array<double, 2> rays{}, relmse{};
    double sum = 0.0, squares = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
        p.settings.seed = static_cast<std::uint64_t>(seed);
        for (const std::size_t adaptive : {0, 1}) {
            p.settings.adaptive = adaptive == 1;
            Progress progress;
            const Image image = render_picture(scene, p, &progress);
            rays[adaptive] += static_cast<double>(progress.rays.total());
            relmse[adaptive] += error_metrics(image, truth).relmse;
            const double off = mean_of(image) / mean_of(truth) - 1.0;
            if (adaptive == 1) sum += off, squares += off * off;
        }
    }
    const double bias = sum / seeds, variance = (squares - seeds * bias * bias) / (seeds - 1.0);
    return {rays[1] / rays[0], relmse[1] / relmse[0], bias, bias / std::sqrt(variance / seeds)};
}

// relMSE falls faster than as 1 / rays, so what is saved is at least what their product says.
TEST(Adaptive, P_08_TheSameErrorForFewerRays) {
    const std::pair<const char*, double> most[]{
        {"builtin:balls_box", 0.8}, {"builtin:dof", 0.7}, {"builtin:soup,n=1000", 0.7}, {"builtin:stadium,n=10000", 0.6}};
    for (const auto& [spec, product] : most) {
        const AgainstEven c = against_even(spec, 32, 2);
        note(spec, c.rays * c.relmse);
        EXPECT_LT(c.rays * c.relmse, product) << spec;
    }
}

// The estimate is put together from tiles that were chosen by what it is made of; that may not make it small.
TEST(Adaptive, C_10_S_ADP_02_TheErrorBarHolds) {
    for (const char* spec : {"builtin:balls_box", "builtin:dof", "builtin:soup,n=1000"}) {
        const auto scene = load_scene(spec);
        Picture p = adaptive_picture(*scene, 96, 64, 1);
        const Image truth = truth_of(scene, p);
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::random}) {
            p.settings.sampler = kind, p.settings.seed = 1;
            Renderer renderer(2, false);
            const std::uint64_t generation = renderer.restart(frame_of(scene, p));
            for (int spp = 16; spp <= 64; spp *= 2) {
                ASSERT_TRUE(renderer.extend(generation, spp));
                renderer.wait(1e9, nullptr);
                Image image;
                ASSERT_TRUE(renderer.resolve(image));
                const ErrorEstimate e = renderer.error();
                const double error = std::sqrt(error_metrics(image, truth).relmse);
                note(fmt::format("{}_{}_{}", spec, kSamplerNames[static_cast<std::size_t>(kind)], spp), e.relrmse / error);
                EXPECT_EQ(e.spp, spp);
                EXPECT_NEAR(e.relrmse / error, 1.0, 0.3) << spec << ' ' << spp;
                EXPECT_LE(e.low, error) << spec << ' ' << spp;
                EXPECT_GE(e.high, error) << spec << ' ' << spp;
            }
        }
    }
}

// Tiles that were dark by chance get fewer samples; what that does to the mean is far below its noise.
TEST(Adaptive, S_ADP_01_TheMeanIsNotShifted) {
    const AgainstEven c = against_even("builtin:balls_box", 16, scale(16, 400));
    note("bias", c.bias);
    note("z", c.z);
    EXPECT_LT(std::abs(c.bias), 2e-4);
    EXPECT_LT(std::abs(c.z), 5.0);
}

}  // namespace
}  // namespace glint
