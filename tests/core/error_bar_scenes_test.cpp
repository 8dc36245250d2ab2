// The error bar on every scene of the benchmarks: estimates, intervals and predictions against true errors, and whether pictures
// that stop by their own error are as good as was asked. Small pictures, fixed seeds; tests/bench/error_bar has larger ones.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error_metrics.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

constexpr int kMost = 128, kSeeds = 6;

std::string name_of(SamplerKind kind) { return std::string(kSamplerNames[static_cast<std::size_t>(kind)]); }

struct Shot {
    ErrorEstimate estimate;
    double error = 0.0;
};
using Shots = std::vector<Shot>;  // [k]: at 2^k samples

Shots shots_of(const std::shared_ptr<const Scene>& scene, const Picture& p, const Image& truth) {
    Shots shots;
    Renderer renderer(p.threads, false);
    Frame frame = frame_of(scene, p);
    frame.spp = 1;
    const std::uint64_t generation = renderer.restart(std::move(frame));
    for (int spp = 1; spp <= kMost; spp *= 2) {
        EXPECT_TRUE(renderer.extend(generation, spp));
        renderer.wait(1e9, nullptr);
        Image image;
        EXPECT_TRUE(renderer.resolve(image));
        shots.push_back({renderer.error(), std::sqrt(error_metrics(image, truth).relmse)});
    }
    return shots;
}

std::vector<double> expected_errors(const std::vector<Shots>& runs) {
    std::vector<double> expected(runs.front().size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        for (const Shots& r : runs) expected[k] += r[k].error * r[k].error / static_cast<double>(runs.size());
        expected[k] = std::sqrt(expected[k]);
    }
    return expected;
}

double median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

// Samples at which log-log interpolation of the true errors crosses the target.
double samples_reaching(const std::vector<double>& expected, double target) {
    for (std::size_t k = 1; k < expected.size(); ++k) {
        if (expected[k] > target || !(expected[k - 1] > target)) continue;
        return std::exp2(static_cast<double>(k - 1) +
                         std::log(expected[k - 1] / target) / std::log(expected[k - 1] / expected[k]));
    }
    return 0.0;
}

// Share of pictures that end within the target when they stop at the first doubling that allows it; least_samples() would keep
// pictures as small as these from stopping early, so it is that of a large one.
void count_stops(const Shots& shots, const std::vector<double>& expected, int& stopped, int& within) {
    constexpr std::size_t kLarge = 1 << 20;
    constexpr int kTargets = 12;
    for (int i = 0; i < kTargets; ++i) {
        const double target = expected.back() * 1.05 * std::pow(expected[1] / expected.back(), i / double{kTargets});
        for (const Shot& shot : shots) {
            if (!error_reached(shot.estimate, kLarge, target)) continue;
            ++stopped;
            within += shot.error <= target ? 1 : 0;
            break;
        }
    }
}

// Every sampler, by one seed.
TEST(ErrorBar, C_10_HoldsForScenes) {
    for (const char* spec : {"builtin:balls,level=1", "builtin:mount,level=2"}) {
        const auto scene = load_scene(spec);
        Picture p{32, 24, 2048, 2, AcceleratorKind::bvh, {}};
        p.settings.features = features_of(*scene);
        p.settings.sampler = SamplerKind::joint, p.settings.seed = 12345;
        const Image truth = render_picture(scene, p);
        for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::random}) {
            p.settings.sampler = kind, p.settings.seed = 1, p.spp = 128;
            Renderer renderer(2, false);
            renderer.restart(frame_of(scene, p));
            renderer.wait(1e9, nullptr);
            Image image;
            ASSERT_TRUE(renderer.resolve(image));
            const ErrorEstimate e = renderer.error();
            const double error = std::sqrt(error_metrics(image, truth).relmse);
            note(fmt::format("{}_{}", spec, name_of(kind)), e.relrmse / error);
            EXPECT_NEAR(e.relrmse / error, 1.0, 0.35) << spec << ' ' << name_of(kind);
            EXPECT_LE(e.low, error);
            EXPECT_GE(e.high, error);
        }
    }
}

class ErrorBarScene : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        scene = load_scene(GetParam());
        picture.settings.features = features_of(*scene);
        Picture p = picture;
        p.spp = 2048;
        p.settings.sampler = SamplerKind::joint, p.settings.seed = 12345;
        truth = render_picture(scene, p);
    }
    std::vector<Shots> runs(SamplerKind sampler) {
        std::vector<Shots> all;
        picture.settings.sampler = sampler;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            picture.settings.seed = static_cast<std::uint64_t>(seed);
            all.push_back(shots_of(scene, picture, truth));
        }
        return all;
    }
    std::shared_ptr<const Scene> scene;
    Picture picture{24, 18, 1, 2, AcceleratorKind::bvh, {}};
    Image truth;
};

TEST_P(ErrorBarScene, C_10_S_ADP_02_IntervalsHoldTheTruthAndStopsAreCovered) {
    int intervals = 0, held = 0, stopped = 0, within = 0;
    for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::joint, SamplerKind::random}) {
        const std::string name = name_of(sampler);
        const std::vector<Shots> all = runs(sampler);
        const std::vector<double> expected = expected_errors(all);
        for (std::size_t k = 1; k < expected.size(); ++k) {
            std::vector<double> ratio;
            for (const Shots& r : all) {
                const ErrorEstimate& e = r[k].estimate;
                ratio.push_back(e.relrmse / expected[k]);
                ++intervals;
                held += e.low <= r[k].error && r[k].error <= e.high ? 1 : 0;
            }
            note(fmt::format("{}_{}", name, 1 << k), median(ratio));
            if (k >= 3) {
                EXPECT_NEAR(median(ratio), 1.0, 0.3) << name << ' ' << (1 << k);
            }
        }
        for (const Shots& r : all) count_stops(r, expected, stopped, within);
        // From 32 samples: how many does the error of 128 need? Pictures as small as these tell their slope badly.
        constexpr std::size_t kFrom = 5;
        const double target = expected.back() * 1.0001;
        std::vector<double> predicted;
        for (const Shots& r : all) {
            const ErrorEstimate& e = r[kFrom].estimate;
            predicted.push_back(std::exp2(kFrom) * times_until(e, target / e.relrmse) / samples_reaching(expected, target));
        }
        note(name + "_predicted", median(predicted));
        EXPECT_GT(median(predicted), 0.6) << name;
        EXPECT_LT(median(predicted), 1.7) << name;
    }
    note("held", static_cast<double>(held) / intervals);
    note("within", static_cast<double>(within) / stopped);
    EXPECT_GE(held, 0.95 * intervals);
    EXPECT_GE(within, 0.94 * stopped);
}

INSTANTIATE_TEST_SUITE_P(Bench, ErrorBarScene,
                         testing::Values("builtin:balls,level=2", "builtin:mount,level=4", "builtin:balls_box", "builtin:dof",
                                         "builtin:cornell", "builtin:glass", "builtin:knot,n=10000", "builtin:stadium,n=10000",
                                         "builtin:soup,n=1000", "builtin:crowd,n=20"),
                         test_name);

}  // namespace
}  // namespace glint
