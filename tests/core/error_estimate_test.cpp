// The error bar: estimates against true errors for every sampler, and the rule that stops by them.
#include <gtest/gtest.h>

#include <functional>

#include "core/dimension.h"
#include "core/framebuffer.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A grey picture whose pixels are sample means of functions of the unit square: an edge, a product or a plane, with an edge
// and a slope of their own, as pixels of a scene have.
struct Integrand {
    double level = 0.5, slope = 0.0;
    int kind = 0;

    explicit Integrand(std::size_t pixel)
        : level(0.3 + 0.4 * (hash(static_cast<std::uint32_t>(pixel), 1) % 1000) / 1000.0),
          slope(-0.5 + (hash(static_cast<std::uint32_t>(pixel), 2) % 1000) / 1000.0),
          kind(static_cast<int>(pixel % 3)) {}
    [[nodiscard]] double value(glm::dvec2 p) const {
        if (kind == 0) return p.y < level + slope * (p.x - 0.5) ? 1.0 : 0.2;
        return kind == 1 ? 0.5 + level * p.x * p.y : 1.0 + slope * p.x - level * p.y;
    }
    [[nodiscard]] double exact() const {
        if (kind == 0) return 0.2 + 0.8 * level;
        return kind == 1 ? 0.5 + 0.25 * level : 1.0 + 0.5 * slope - 0.5 * level;
    }
};

class Pixels {
public:
    Pixels(SamplerKind kind, std::size_t count, std::uint64_t seed) : kind_(kind), seed_(seed), sums_(count) {}
    void sample_up_to(int spp) {
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            while (sums_[i].taken < static_cast<std::uint32_t>(spp)) {
                const Sampler sampler(kind_, static_cast<std::uint32_t>(i), 5, sums_[i].taken, seed_);
                const glm::vec3 c(static_cast<float>(Integrand(i).value(glm::dvec2(sampler.square(dimension::pixel)))));
                sums_[i].add(&c, doublings_);
            }
        }
    }
    [[nodiscard]] ErrorEstimate estimate() const {
        return estimate_error(doublings_, sums_.size(), static_cast<int>(sums_[0].taken), {kind_});
    }
    [[nodiscard]] double true_mse() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const double exact = Integrand(i).exact(), e = sums_[i].mean().x - exact;
            sum += e * e / (exact * exact + 1e-2);
        }
        return sum / static_cast<double>(sums_.size());
    }

private:
    SamplerKind kind_;
    std::uint64_t seed_;
    std::vector<PixelSum> sums_;
    Doublings doublings_{};
};

// So many pixels that all changed by so much, whoever weighs it.
Doubling changed(double change, double pixels = 1.0) {
    const Changes all{pixels * change, pixels * change * change};
    return {all, all};
}

std::string name_of(SamplerKind kind) { return std::string(kSamplerNames[static_cast<std::size_t>(kind)]); }

// The plain variance of the samples is two to seven times too large here for all but `random`.
TEST(ErrorBar, C_10_HoldsForEverySamplerAndCount) {
    constexpr int kPictures = 40;
    for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::joint, SamplerKind::jittered, SamplerKind::random}) {
        std::vector<Pixels> pictures;
        for (int i = 0; i < kPictures; ++i) pictures.emplace_back(kind, 256, static_cast<std::uint64_t>(1000 + i));
        for (const int spp : {32, 64, 128, 192, 256, 1024}) {
            double mse = 0.0, estimate = 0.0;
            for (Pixels& p : pictures) {
                p.sample_up_to(spp);
                mse += p.true_mse() / kPictures;
                estimate += p.estimate().relrmse / kPictures;
            }
            const double truth = std::sqrt(mse);
            int held = 0;
            for (const Pixels& p : pictures) held += p.estimate().low <= truth && truth <= p.estimate().high;
            note(fmt::format("{}_{}", name_of(kind), spp), estimate / truth);
            EXPECT_GE(held, kPictures * 9 / 10) << name_of(kind) << ' ' << spp;
            // Within its first block of strata jittered only knows bounds.
            if (kind == SamplerKind::jittered && spp <= 64) continue;
            EXPECT_NEAR(estimate / truth, 1.0, 0.2) << name_of(kind) << ' ' << spp;
        }
    }
}

TEST(ErrorBar, C_10_PredictsTheSamplesThatATargetNeeds) {
    for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::jittered, SamplerKind::random}) {
        double predicted = 0.0, reached = 0.0;
        constexpr int kPictures = 10;
        for (int i = 0; i < kPictures; ++i) {
            Pixels p(kind, 1024, 77 + static_cast<std::uint64_t>(i));
            p.sample_up_to(128);
            const ErrorEstimate now = p.estimate();
            p.sample_up_to(1024);
            // The samples for the error that 1024 have, by the slope fitted at 128.
            predicted += std::log(128.0 * std::pow(now.relrmse / std::sqrt(p.true_mse()), 1.0 / now.slope)) / kPictures;
            reached += std::log(1024.0) / kPictures;
        }
        note("predicted_" + name_of(kind), std::exp(predicted - reached));
        EXPECT_NEAR(std::exp(predicted - reached), 1.0, 0.25) << name_of(kind);
    }
}

// Pixels that are 1 with a chance of p, else 0: `more` samples each, until the rule stops it. Returns samples a pixel.
int sample_until(double p, double target, std::uint64_t seed, std::vector<PixelSum>& pixels) {
    Doublings doublings{};
    for (int spp = 1; spp <= 1 << 22; spp *= 2) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            while (pixels[i].taken < static_cast<std::uint32_t>(spp)) {
                const Sampler sampler(SamplerKind::random, static_cast<std::uint32_t>(i), 0, pixels[i].taken, seed);
                const glm::vec3 c(static_cast<double>(sampler.interval(1)) < p ? 1.0f : 0.0f);
                pixels[i].add(&c, doublings);
            }
        }
        if (error_reached(estimate_error(doublings, pixels.size(), spp, {SamplerKind::random}), pixels.size(), target))
            return spp;
    }
    return 0;
}

// A pilot of 16 samples that stops where it saw nothing keeps 16 % of such light (p = .01), one of 64 keeps 51 %.
TEST(ErrorBar, S_ADP_01_RareLightIsNotLostByStopping) {
    for (const double p : {.01, .05}) {
        for (const std::size_t size : {std::size_t{1}, std::size_t{64}, std::size_t{1024}}) {
            const int pictures = size == 1 ? 40 : 8;
            double mean = 0.0, variance = 0.0;
            for (int picture = 0; picture < pictures; ++picture) {
                std::vector<PixelSum> pixels(size);
                // Loose, so that it is the least number of samples that counts.
                const int spp = sample_until(p, 3.0, 31 + static_cast<std::uint64_t>(picture), pixels);
                EXPECT_GE(spp, least_samples(size));
                for (const PixelSum& s : pixels) mean += s.mean().x / static_cast<double>(size) / pictures;
                variance += p * (1 - p) / spp / static_cast<double>(size) / pictures / pictures;
            }
            note(fmt::format("kept_{}_{}", p, size), mean / p);
            EXPECT_NEAR(mean, p, 3.0 * std::sqrt(variance)) << size;
        }
    }
}

// Light that 4 % of a pixel's square sees, of mean 1: one half of the samples sees it and the other does not, as long as there
// are few. Weighed by the mean of twice the samples, changes are what the squared error falls by; at first sight they are not.
TEST(ErrorBar, C_10_WeighsRareLightAgainAndSaysHowUnsureItIs) {
    constexpr int kPixels = 8192, kTop = 8;
    constexpr double kSide = 0.2;
    for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::random}) {
        std::vector<PixelSum> pixels(kPixels);
        Doublings doublings{};
        std::array<double, kTop + 1> mse{};
        for (int k = 0; k <= kTop; ++k) {
            for (std::uint32_t i = 0; i < kPixels; ++i) {
                const glm::dvec2 low = (1.0 - kSide) * glm::dvec2(hash(i, 1) % 1000, hash(i, 2) % 1000) / 1000.0;
                PixelSum& pixel = pixels[i];
                while (pixel.taken < 1u << k) {
                    const glm::dvec2 p = glm::dvec2(Sampler(kind, i, 5, pixel.taken, 1).square(dimension::pixel)) - low;
                    const bool lit = p.x >= 0.0 && p.x < kSide && p.y >= 0.0 && p.y < kSide;
                    const glm::vec3 c(lit ? static_cast<float>(1.0 / (kSide * kSide)) : 0.0f);
                    pixel.add(&c, doublings);
                }
                const double e = pixel.mean().x - 1.0;
                mse[static_cast<std::size_t>(k)] += e * e / 1.01 / kPixels;
            }
        }
        for (int k = 3; k <= kTop; ++k) {
            const auto n = static_cast<std::size_t>(k);
            const auto known = std::span<const Doubling>(doublings).first(n);
            const ErrorEstimate e = estimate_error(known, kPixels, 1 << k, {kind});
            note(fmt::format("{}_{}", name_of(kind), 1 << k), e.relrmse / std::sqrt(mse[n]));
            EXPECT_LE(e.low, std::sqrt(mse[n])) << name_of(kind) << ' ' << (1 << k);
            if (k > 3) {
                EXPECT_GE(e.high, std::sqrt(mse[n])) << name_of(kind) << ' ' << (1 << k);
            }
        }
        // From 64 samples to 128.
        const double fall = (mse[6] - mse[7]) * kPixels;
        note(name_of(kind) + "_fresh", doublings[6].fresh.sum / fall);
        note(name_of(kind) + "_settled", doublings[6].settled.sum / fall);
        EXPECT_NEAR(doublings[6].settled.sum / fall, 1.0, 0.25) << name_of(kind);
        EXPECT_GT(doublings[6].fresh.sum, doublings[6].settled.sum);
    }
}

// Intervals that are looked at again and again cover less than they say; not so at doublings and with z = 2.
TEST(ErrorBar, S_ADP_02_StreamsThatStopByTheirOwnErrorAreCovered) {
    constexpr double kHalf = 0.02;
    // relRMSE at which 1.96 standard errors are the half width.
    const double target = kHalf / 1.96 / std::sqrt(0.5 * 0.5 + 0.01);
    for (const std::size_t size : {std::size_t{64}, std::size_t{256}, std::size_t{10000}}) {
        const std::size_t pictures = 10000 / size;
        std::size_t covered = 0, streams = 0;
        for (std::size_t picture = 0; picture < pictures; ++picture) {
            std::vector<PixelSum> pixels(size);
            EXPECT_GT(sample_until(0.5, target, 900 + picture, pixels), 0);
            for (const PixelSum& s : pixels) covered += std::abs(s.mean().x - 0.5) <= kHalf ? 1u : 0u;
            streams += size;
        }
        const double coverage = static_cast<double>(covered) / static_cast<double>(streams);
        note(fmt::format("coverage_of_{}_streams_{}_together", streams, size), coverage);
        EXPECT_GE(coverage, 0.94) << size;
    }
}

TEST(ErrorBar, S_ADP_03_TwoHalvesThatAgreeAreNoProof) {
    // Nothing has changed so far, so the error looks like none: but not before the least number of samples.
    const Doublings none{};
    for (const std::size_t pixels : {std::size_t{1}, std::size_t{100}, std::size_t{5000}, std::size_t{1000000}}) {
        for (int spp = 1; spp < least_samples(pixels); spp *= 2) {
            const ErrorEstimate e = estimate_error(none, pixels, spp, {SamplerKind::sobol});
            EXPECT_FALSE(error_reached(e, pixels, 0.5)) << pixels << ' ' << spp;
        }
        EXPECT_GE(least_samples(pixels), 8);
        EXPECT_GE(static_cast<std::size_t>(least_samples(pixels)) * pixels, std::size_t{1} << 16);
    }
    // The last two halves agree, those before did not.
    Doublings chance{};
    for (std::size_t k = 0; k < 5; ++k) chance[k] = changed(0.01 * std::exp2(-static_cast<double>(k)));
    const ErrorEstimate e = estimate_error(chance, 1, 64, {SamplerKind::sobol});
    EXPECT_GT(e.relrmse, 0.0);
    EXPECT_GT(e.cautious, e.relrmse);
}

TEST(ErrorBar, KnowsWhatItDoesNotKnow) {
    using Kind = ErrorEstimate::Kind;
    Doublings some{};
    some[0] = changed(0.1);
    EXPECT_EQ(estimate_error(some, 10, 1, {SamplerKind::sobol}).kind, Kind::unknown);
    EXPECT_EQ(estimate_error(some, 10, 0, {SamplerKind::random}).kind, Kind::unknown);
    EXPECT_EQ(estimate_error(some, 10, 64, {SamplerKind::regular}).kind, Kind::unknown);
    EXPECT_EQ(estimate_error(some, 10, 2, {SamplerKind::sobol}).kind, Kind::estimated);
    const auto scene = load_scene("builtin:balls,level=1");
    Picture p{16, 16, 1, 1, AcceleratorKind::bvh, {}};
    p.settings.features = FeatureSet::whitted();
    Renderer renderer(1, false);
    EXPECT_EQ(renderer.error().kind, Kind::unknown);
    renderer.restart(frame_of(scene, p));
    renderer.wait(1e9, nullptr);
    EXPECT_EQ(renderer.error().kind, Kind::exact);
    EXPECT_EQ(renderer.error().relrmse, 0.0);
    EXPECT_TRUE(error_reached(renderer.error(), 256, 1e-6));
}

// Between powers of two: with independent samples the error of n is exactly that of one over the root of n.
TEST(ErrorBar, BetweenDoublingsIndependentSamplesFollowTheRoot) {
    Doublings doublings{};
    for (std::size_t k = 0; k < 7; ++k) doublings[k] = changed(std::exp2(-static_cast<double>(k) - 1.0));
    const double one = estimate_error(doublings, 1, 128, {SamplerKind::random}).relrmse * std::sqrt(128.0);
    for (const int spp : {129, 150, 192, 255})
        EXPECT_NEAR(estimate_error(doublings, 1, spp, {SamplerKind::random}).relrmse * std::sqrt(spp), one, 1e-9 * one) << spp;
}

// Where several squares are padded, the part that falls as 1/N is hidden at first and decides in the end.
TEST(ErrorBar, C_10_FindsTheSlowPartOfPaddedSquares) {
    constexpr std::size_t kPixels = 1000;
    for (const double slow : {0.1, 0.3, 0.6, 0.9}) {
        const auto mse = [&](double n) { return 0.01 * (slow / n + (1.0 - slow) / (n * n)); };
        Doublings doublings{};
        for (std::size_t k = 0; k < 10; ++k) {
            const double n = std::exp2(static_cast<double>(k)), change = mse(n) - mse(2.0 * n);
            doublings[k] = changed(change, kPixels);
        }
        for (const int spp : {8, 32, 128}) {
            const ErrorEstimate e = estimate_error(doublings, kPixels, spp, {SamplerKind::sobol, false});
            EXPECT_NEAR(e.relrmse / std::sqrt(mse(spp)), 1.0, 0.1) << slow << ' ' << spp;
            EXPECT_NEAR(times_until(e, std::sqrt(mse(4.0 * spp)) / e.relrmse), 4.0, 1.0) << slow << ' ' << spp;
        }
    }
    ErrorEstimate power;
    power.slope = 0.75;
    EXPECT_NEAR(times_until(power, 0.125), 16.0, 1e-9);
    EXPECT_NEAR(times_until(power, 1.0), 1.0, 1e-9);
}

TEST(ErrorBar, IsTheSameForEveryThreadCountAndWayThere) {
    const auto scene = load_scene("builtin:dof");
    Picture p{40, 30, 64, 1, AcceleratorKind::bvh, {}};
    p.settings.features = features_of(*scene);
    std::optional<ErrorEstimate> first;
    for (const int threads : {1, 2, 3}) {
        for (const bool preview : {false, true}) {
            Renderer renderer(threads, preview);
            renderer.restart(frame_of(scene, p));
            renderer.wait(1e9, nullptr);
            const ErrorEstimate e = renderer.error();
            if (!first) first = e;
            EXPECT_GT(e.relrmse, 0.0);
            EXPECT_EQ(e.relrmse, first->relrmse);
            EXPECT_EQ(e.high, first->high);
        }
    }
}

TEST(Extend, GivesTheBitsOfAFrameThatAskedForAsMany) {
    const auto scene = load_scene("builtin:balls_box");
    Picture p{50, 20, 100, 1, AcceleratorKind::bvh, {}};
    p.settings.features = features_of(*scene);
    Progress whole;
    const Image expected = render_picture(scene, p, &whole);
    for (const bool preview : {false, true}) {
        Renderer renderer(3, preview);
        p.spp = 1;
        const std::uint64_t generation = renderer.restart(frame_of(scene, p));
        // Once the frame is finished, and while it is at work.
        for (const int spp : {1, 2, 7, 32, 64, 100}) {
            EXPECT_TRUE(renderer.extend(generation, spp));
            if (spp % 2 == 1) renderer.wait(1e9, nullptr);
        }
        EXPECT_TRUE(renderer.extend(generation, 5)) << "never fewer";
        renderer.wait(1e9, nullptr);
        EXPECT_TRUE(renderer.progress().finished);
        EXPECT_EQ(renderer.progress().spp_min, 100);
        EXPECT_EQ(renderer.progress().spp_max, 100);
        EXPECT_EQ(renderer.progress().rays.camera, whole.rays.camera);
        Image image;
        ASSERT_TRUE(renderer.resolve(image));
        EXPECT_EQ(differing_pixels(image, expected), 0u);
        renderer.restart(frame_of(scene, p));
        EXPECT_FALSE(renderer.extend(generation, 200));
    }
}

}  // namespace
}  // namespace glint
