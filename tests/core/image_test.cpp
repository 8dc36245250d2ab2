// From radiance to bytes and files: the one transfer, what a NaN looks like, and pictures that come back as they were written.
#include "core/image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace glint {
namespace {

std::uint8_t shown(float x, const DisplaySettings& display) { return to_display({1, 1, {glm::vec3(x)}}, display).rgb[0]; }

// S-TON-01, with byte = floor(255.99 x): .18 is .461356 and .5 is .735357 after the transfer of IEC 61966-2-1.
TEST(Display, S_TON_01_SrgbTransfer) {
    const DisplaySettings srgb{0.0f, Transfer::srgb};
    EXPECT_EQ(shown(0.0f, srgb), 0);
    EXPECT_EQ(shown(0.0031308f, srgb), static_cast<int>(255.99 * 0.0404499));
    EXPECT_EQ(shown(0.18f, srgb), 118);
    EXPECT_EQ(shown(0.5f, srgb), 188);
    EXPECT_EQ(shown(1.0f, srgb), 255);
    EXPECT_EQ(shown(1e30f, srgb), 255);
    EXPECT_EQ(shown(-1.0f, srgb), 0);
}

TEST(Display, LinearBytesFollowTheRuleOfTheCourse) {
    const DisplaySettings linear{0.0f, Transfer::linear};
    for (int b = 0; b < 256; ++b) {
        EXPECT_EQ(shown(static_cast<float>((b + 0.5) / 255.99), linear), b);
    }
    EXPECT_EQ(shown(std::numeric_limits<float>::infinity(), linear), 255);
}

TEST(Display, AStopOfExposureDoubles) {
    EXPECT_EQ(shown(0.2f, {1.0f, Transfer::linear}), shown(0.4f, {0.0f, Transfer::linear}));
    EXPECT_EQ(shown(0.2f, {-2.0f, Transfer::srgb}), shown(0.05f, {0.0f, Transfer::srgb}));
}

TEST(Display, ANanIsMagenta) {
    const Image8 out = to_display({1, 1, {glm::vec3(0.5f, std::nanf(""), 0.5f)}}, {0.0f, Transfer::srgb});
    EXPECT_EQ(out.rgb, (std::vector<std::uint8_t>{255, 0, 255}));
}

TEST(ImageFile, PfmComesBackToTheBitAndPngToTheByte) {
    Image image{3, 2, {}};
    for (int i = 0; i < 6; ++i) image.pixels.emplace_back(0.1f * static_cast<float>(i), 1e-30f, 3e20f);
    const auto path = std::filesystem::temp_directory_path() / ("glint-image-" + std::to_string(getpid()));
    write_file_atomically(path, encode_pfm(image));
    EXPECT_EQ(read_image(path).pixels, image.pixels);
    const Image8 bytes = to_display(image, {0.0f, Transfer::srgb});
    write_file_atomically(path, encode_png(bytes, Transfer::srgb));
    const Image back = read_image(path);
    for (std::size_t i = 0; i < bytes.rgb.size(); ++i) {
        EXPECT_EQ(std::lround(back.pixels[i / 3][static_cast<int>(i % 3)] * 255.0f), bytes.rgb[i]);
    }
    std::filesystem::resize_file(path, 20);
    EXPECT_THROW((void)read_image(path), ImageError);
    std::filesystem::remove(path);
    EXPECT_THROW((void)read_image(path), ImageError);
}

TEST(ImageDifferenceTest, OfTwoPixelsByHand) {
    const Image a{2, 1, {glm::vec3(0.0f), glm::vec3(1.0f)}}, b{2, 1, {glm::vec3(0.0f), glm::vec3(1.0f, 1.0f, 0.25f)}};
    const ImageDifference d = difference(a, b);
    EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(0.75 * 0.75 / 6.0));
    EXPECT_DOUBLE_EQ(d.max, 0.75);
    EXPECT_EQ(d.differing, 1u);
    EXPECT_THROW((void)difference(a, Image{1, 1, {glm::vec3(0.0f)}}), ImageError);
    // A NaN never passes for equal.
    EXPECT_EQ(difference(a, Image{2, 1, {glm::vec3(0.0f), glm::vec3(std::nanf(""))}}).differing, 1u);
}

}  // namespace
}  // namespace glint
