// Each measure against two pixels worked out by hand, and what a NaN may do to none of them.
#include "core/error_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace glint {
namespace {

// a - r is (1/2, 0, 1/4) and (1, 0, -1).
const Image kPicture{2, 1, {glm::vec3(1.0f, 0.5f, 0.25f), glm::vec3(2.0f, 0.0f, 0.0f)}};
const Image kReference{2, 1, {glm::vec3(0.5f, 0.5f, 0.0f), glm::vec3(1.0f, 0.0f, 1.0f)}};

TEST(ErrorMetricsTest, RmseOfTwoPixelsByHand) {
    EXPECT_DOUBLE_EQ(error_metrics(kPicture, kReference).rmse, std::sqrt((0.25 + 0.0625 + 1.0 + 1.0) / 6.0));
}

// The reference is squared in the denominator, as a renderer's tool once forgot: that would give 0.25/0.51 and 1/1.01.
TEST(ErrorMetricsTest, RelmseOfTwoPixelsByHandSquaresTheReference) {
    const double expected = (0.25 / (0.25 + 0.01) + 0.0625 / 0.01 + 1.0 / 1.01 + 1.0 / 1.01) / 6.0;
    EXPECT_DOUBLE_EQ(error_metrics(kPicture, kReference).relmse, expected);
    // Not symmetric: the other one is the reference now.
    const double swapped = (0.25 / 1.01 + 0.0625 / (0.0625 + 0.01) + 1.0 / 4.01 + 1.0 / 0.01) / 6.0;
    EXPECT_DOUBLE_EQ(error_metrics(kReference, kPicture).relmse, swapped);
}

TEST(ErrorMetricsTest, MaeBiasAndZOfTwoPixelsByHand) {
    const ErrorMetrics m = error_metrics(kPicture, kReference);
    EXPECT_DOUBLE_EQ(m.mae, 2.75 / 6.0);
    EXPECT_DOUBLE_EQ(m.bias, 0.75 / 6.0);
    // The pixels' own means are 1/4 and 0: scatter 1/8 about 1/8, standard error sqrt((1/64 + 1/64) / 1 / 2) = 1/8.
    EXPECT_DOUBLE_EQ(m.bias_z, 1.0);
    EXPECT_DOUBLE_EQ(error_metrics(kReference, kPicture).bias_z, -1.0);
}

TEST(ErrorMetricsTest, PsnrOfTwoPixelsByHandCountsWhatIsShown) {
    // 2 and 1 are both display white.
    EXPECT_DOUBLE_EQ(error_metrics(kPicture, kReference).psnr, 10.0 * std::log10(6.0 / (0.25 + 0.0625 + 1.0)));
    EXPECT_EQ(error_metrics(kPicture, kPicture).psnr, std::numeric_limits<double>::infinity());
}

TEST(ErrorMetricsTest, MaximumPercentileAndCountsOfTwoPixelsByHand) {
    const ErrorMetrics m = error_metrics(kPicture, kReference);
    EXPECT_EQ(m.max, 1.0);
    EXPECT_EQ(m.p99, 1.0);
    EXPECT_EQ(m.differing, 2u);
    EXPECT_EQ(m.non_finite, 0u);
    EXPECT_EQ(m.pixels, 2u);
    EXPECT_EQ(absolute_difference(kPicture, kReference).pixels[1], glm::vec3(1.0f, 0.0f, 1.0f));
}

TEST(ErrorMetricsTest, EqualPicturesHaveNoError) {
    const ErrorMetrics m = error_metrics(kPicture, kPicture);
    EXPECT_EQ(m.rmse, 0.0);
    EXPECT_EQ(m.relmse, 0.0);
    EXPECT_EQ(m.mae, 0.0);
    EXPECT_EQ(m.bias, 0.0);
    EXPECT_EQ(m.bias_z, 0.0);
    EXPECT_EQ(m.max, 0.0);
    EXPECT_EQ(m.differing, 0u);
}

// Of 200 pixels, two are off: the 198 others are 99 %, a third one is not.
TEST(ErrorMetricsTest, OnePixelInAHundredMayBeOffWithoutMovingThePercentile) {
    const Image reference{200, 1, std::vector<glm::vec3>(200, glm::vec3(0.5f))};
    Image picture = reference;
    picture.pixels[3].y = picture.pixels[77].z = 0.0f;
    EXPECT_EQ(error_metrics(picture, reference).p99, 0.0);
    EXPECT_EQ(error_metrics(picture, reference).max, 0.5);
    picture.pixels[100].x = 0.75f;
    EXPECT_EQ(error_metrics(picture, reference).p99, 0.25);
}

TEST(ErrorMetricsTest, PixelsThatAreNotFiniteAreCountedAndLeftOut) {
    const float inf = std::numeric_limits<float>::infinity();
    Image picture{4, 1, kPicture.pixels}, reference{4, 1, kReference.pixels};
    picture.pixels.insert(picture.pixels.end(), {glm::vec3(0.0f, std::nanf(""), 0.0f), glm::vec3(inf)});
    reference.pixels.insert(reference.pixels.end(), {glm::vec3(0.0f), glm::vec3(inf)});
    const ErrorMetrics m = error_metrics(picture, reference), alone = error_metrics(kPicture, kReference);
    EXPECT_EQ(m.non_finite, 2u);
    EXPECT_EQ(m.differing, 4u);
    EXPECT_EQ(m.rmse, alone.rmse);
    EXPECT_EQ(m.relmse, alone.relmse);
    EXPECT_EQ(m.mae, alone.mae);
    EXPECT_EQ(m.psnr, alone.psnr);
    EXPECT_EQ(m.bias_z, alone.bias_z);
    EXPECT_EQ(m.p99, alone.p99);
    EXPECT_EQ(m.max, alone.max);
    // Nothing left is no zero error.
    const Image bad{1, 1, {glm::vec3(std::nanf(""))}};
    EXPECT_TRUE(std::isnan(error_metrics(bad, bad).rmse));
    EXPECT_TRUE(std::isnan(error_metrics(bad, bad).max));
    EXPECT_EQ(error_metrics(bad, bad).differing, 1u);
}

// Noise of mean zero has a z of some ones; a hundredth of its deviation, added to 10^5 pixels, is found out.
TEST(ErrorMetricsTest, ZTellsAHiddenBiasFromNoise) {
    const Image reference{1000, 100, std::vector<glm::vec3>(100000, glm::vec3(0.5f))};
    Image noisy = reference;
    std::uint32_t state = 1;
    for (glm::vec3& p : noisy.pixels) {
        state = state * 1664525u + 1013904223u;
        p += static_cast<float>(state >> 8) * 0x1p-24f - 0.5f;
    }
    EXPECT_LT(std::abs(error_metrics(noisy, reference).bias_z), 3.0);
    for (glm::vec3& p : noisy.pixels) p += 0.01f;
    EXPECT_GT(error_metrics(noisy, reference).bias_z, 5.0);
}

TEST(ErrorMetricsTest, SizesThatDifferAreRefused) {
    const Image small{1, 1, {glm::vec3(0.0f)}}, turned{1, 2, kPicture.pixels};
    EXPECT_THROW((void)error_metrics(kPicture, small), ImageError);
    EXPECT_THROW((void)error_metrics(kPicture, turned), ImageError);
    EXPECT_THROW((void)absolute_difference(kPicture, small), ImageError);
}

}  // namespace
}  // namespace glint
