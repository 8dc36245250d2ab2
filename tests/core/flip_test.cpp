// FLIP against its authors' evaluator: flip-evaluator 1.7 of the Python package index gave the numbers below for pictures that
// are made here by formula, evaluate(reference, test, "LDR" or "HDR", applyMagma=False, parameters={"ppd": ...}); means are those
// of its map, taken in double. Ours lie within 2e-7 of its means and 7e-6 of its pixels (its filters and sums are in float).
#include "core/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glint {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr double kMeanTolerance = 1e-6, kPixelTolerance = 2e-5;

using Bytes = std::array<int, 3>;

// Ramps in red and green, a chequered blue, an orange ball in the middle.
Bytes picture(int x, int y) {
    const int dx = x - kWidth / 2, dy = y - kHeight / 2;
    if (dx * dx + dy * dy < (kHeight / 4) * (kHeight / 4)) return {230, 120, 20};
    return {x * 255 / (kWidth - 1), y * 255 / (kHeight - 1), (x / 8 + y / 8) % 2 == 1 ? 200 : 40};
}

std::uint32_t hash(std::uint32_t x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

// The same with noise of at most 32 levels.
Bytes noisy(int x, int y) {
    Bytes p = picture(x, y);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto index = static_cast<std::uint32_t>((y * kWidth + x) * 3) + static_cast<std::uint32_t>(c);
        p[c] = std::clamp(p[c] + static_cast<int>(hash(index) >> 26) - 32, 0, 255);
    }
    return p;
}

// Two pixels to the right, what leaves comes in on the left.
Bytes moved(int x, int y) { return picture((x + kWidth - 2) % kWidth, y); }

Image display(Bytes (*of)(int, int)) {
    Image image{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const Bytes p = of(x, y);
            image.pixels.push_back(glm::vec3(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])) /
                                   255.0f);
        }
    }
    return image;
}

// Up to 4 times white, and a lamp 64 times brighter.
Image radiance(Bytes (*of)(int, int)) {
    Image image = display(of);
    for (glm::vec3& p : image.pixels) p = p * p * 4.0f;
    for (int y = 5; y < 9; ++y) {
        for (int x = 10; x < 14; ++x) image.at(x, y) *= 64.0f;
    }
    return image;
}

double at(const Flip& flip, int x, int y) { return static_cast<double>(flip.map[static_cast<std::size_t>(y * kWidth + x)]); }

TEST(FlipTest, DisplayPicturesWithNoiseAsTheAuthorsEvaluatorHasThem) {
    const Flip flip = flip_of_display(display(noisy), display(picture));
    EXPECT_NEAR(flip.mean, 0.150290668, kMeanTolerance);
    EXPECT_NEAR(at(flip, 0, 0), 0.1128401, kPixelTolerance);
    EXPECT_NEAR(at(flip, 33, 20), 0.1539411, kPixelTolerance);
    EXPECT_NEAR(static_cast<double>(*std::max_element(flip.map.begin(), flip.map.end())), 0.4536175, kPixelTolerance);
}

TEST(FlipTest, MovedDisplayPicturesAsTheAuthorsEvaluatorHasThem) {
    const Flip flip = flip_of_display(display(moved), display(picture));
    EXPECT_NEAR(flip.mean, 0.280547281, kMeanTolerance);
    EXPECT_NEAR(at(flip, 0, 0), 0.9804538, kPixelTolerance);
    EXPECT_NEAR(at(flip, 33, 20), 0.0263703, kPixelTolerance);
}

TEST(FlipTest, FromNearerAsTheAuthorsEvaluatorHasThem) {
    EXPECT_NEAR(flip_of_display(display(noisy), display(picture), 30.0).mean, 0.271064862, kMeanTolerance);
    EXPECT_NEAR(flip_of_display(display(moved), display(picture), 30.0).mean, 0.330742725, kMeanTolerance);
}

TEST(FlipTest, RadianceAsTheAuthorsEvaluatorHasIt) {
    const Flip noise = flip_of_radiance(radiance(noisy), radiance(picture));
    EXPECT_NEAR(noise.mean, 0.206819754, kMeanTolerance);
    EXPECT_NEAR(at(noise, 0, 0), 0.4111391, kPixelTolerance);
    EXPECT_NEAR(at(noise, 33, 20), 0.2837268, kPixelTolerance);
    const Flip shift = flip_of_radiance(radiance(moved), radiance(picture));
    EXPECT_NEAR(shift.mean, 0.315190049, kMeanTolerance);
    EXPECT_NEAR(at(shift, 33, 20), 0.0303912, kPixelTolerance);
}

TEST(FlipTest, EqualIsZeroAndGreenBesideBlueIsOne) {
    EXPECT_EQ(flip_of_display(display(noisy), display(noisy)).mean, 0.0);
    EXPECT_EQ(flip_of_radiance(radiance(noisy), radiance(noisy)).mean, 0.0);
    // The two colours of sRGB that lie farthest apart, and too flat for any feature.
    const auto flat = [](glm::vec3 c) { return Image{2, 1, {c, c}}; };
    EXPECT_NEAR(flip_of_display(flat({0, 1, 0}), flat({0, 0, 1})).mean, 1.0, 1e-6);
    EXPECT_NEAR(flip_of_display(flat(glm::vec3(0)), flat(glm::vec3(1))).mean, 0.9673882, 1e-5);
}

TEST(FlipTest, BadPixelsStayWhereTheyAreAndDarkPicturesHaveAnAnswer) {
    const float inf = std::numeric_limits<float>::infinity();
    Image bad = radiance(picture);
    bad.at(40, 30) = glm::vec3(std::nanf(""), -3.0f, inf);
    for (const Flip& flip : {flip_of_radiance(bad, radiance(picture)), flip_of_radiance(radiance(picture), bad),
                             flip_of_display(bad, display(picture))}) {
        for (const float f : flip.map) ASSERT_TRUE(f >= 0.0f && f <= 1.0f) << f;
    }
    EXPECT_GT(at(flip_of_radiance(bad, radiance(picture)), 40, 30), 0.1);
    const Image black{2, 2, std::vector<glm::vec3>(4, glm::vec3(0.0f))};
    Image lamp = black;
    lamp.at(1, 1) = glm::vec3(5.0f);
    EXPECT_EQ(flip_of_radiance(black, black).mean, 0.0);
    EXPECT_GT(flip_of_radiance(lamp, black).mean, 0.1);
    EXPECT_GT(flip_of_radiance(black, lamp).mean, 0.1);
    // A range of floats' whole width ends, too.
    Image wide = black;
    wide.pixels = {glm::vec3(1e-38f), glm::vec3(1e-38f), glm::vec3(1e-38f), glm::vec3(3e38f)};
    EXPECT_GT(flip_of_radiance(black, wide).mean, 0.1);
    EXPECT_THROW((void)flip_of_display(black, Image{1, 4, black.pixels}), ImageError);
}

}  // namespace
}  // namespace glint
