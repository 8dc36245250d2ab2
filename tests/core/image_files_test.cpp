// Radiance and OpenEXR files: what comes back, what other readers see, and what damaged files may not do.
#include <gtest/gtest.h>
#include <stb/stb_image.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>

#include "core/exr.h"
#include "core/image.h"
#include "core/rgbe.h"

namespace glint {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

std::uint32_t next_random(std::uint32_t& state) { return (state = state * 1664525u + 1013904223u) >> 8; }

// Radiance over many orders of magnitude, with runs of equal pixels.
Image sample(int width, int height) {
    Image image{width, height, {}};
    std::uint32_t state = 7;
    glm::vec3 p(0.0f);
    for (int i = 0; i < width * height; ++i) {
        if (i % 11 < 6) {
            for (int c = 0; c < 3; ++c) {
                p[c] =
                    std::ldexp(static_cast<float>(next_random(state)) * 0x1p-24f, static_cast<int>(next_random(state) % 30) - 20);
            }
        }
        image.pixels.push_back(p);
    }
    return image;
}

bool same_bits(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(glm::vec3)) == 0;
}

TEST(ExrFile, ComesBackToTheBit) {
    Image image = sample(37, 21);
    image.pixels[0] = {kInf, -kInf, std::nanf("")};
    image.pixels[1] = {-0.0f, 1e-45f, 3.4e38f};
    image.pixels[2] = {-1.5f, 1.0f / 3.0f, 1e-30f};
    EXPECT_TRUE(same_bits(decode_exr(encode_exr(image), "x.exr"), image));
    for (const auto& [width, height] : {std::pair(1, 1), {1, 40}, {300, 1}}) {
        EXPECT_TRUE(same_bits(decode_exr(encode_exr(sample(width, height)), "x.exr"), sample(width, height)));
    }
}

TEST(ExrFile, SaysItsColours) { EXPECT_NE(encode_exr(sample(2, 2)).find("chromaticities"), std::string::npos); }

template <class T>
std::string raw(T value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    return {bytes.data(), bytes.size()};
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + raw(static_cast<std::int32_t>(value.size())) + value;
}

// By the format's description: scan lines without compression, halves, one channel, a data window away from zero.
std::string grey_halves(const std::string& channel, std::array<std::int32_t, 4> window) {
    std::string file("\x76\x2f\x31\x01\x02\0\0\0", 8);
    std::string box;
    for (const std::int32_t x : window) box += raw(x);
    file += attribute("channels", "chlist", channel + '\0' + raw(1) + std::string(4, '\0') + raw(1) + raw(1) + '\0');
    file += attribute("compression", "compression", std::string(1, '\0'));
    file += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box);
    file += attribute("lineOrder", "lineOrder", std::string(1, '\0')) + attribute("pixelAspectRatio", "float", raw(1.0f));
    file +=
        attribute("screenWindowCenter", "v2f", std::string(8, '\0')) + attribute("screenWindowWidth", "float", raw(1.0f)) + '\0';
    // Two rows of two halves: 1, 2 and -0.5, 0.
    const std::uint64_t first = file.size() + 16;
    file += raw(first) + raw(first + 12);
    file += raw(window[1]) + raw(std::int32_t{4}) + std::string("\x00\x3c\x00\x40", 4);
    return file + raw(window[1] + 1) + raw(std::int32_t{4}) + std::string("\x00\xb8\x00\x00", 4);
}

TEST(ExrFile, GreyHalvesInAWindowAwayFromZeroAreRead) {
    const Image image = decode_exr(grey_halves("Y", {5, -3, 6, -2}), "x.exr");
    ASSERT_EQ(image.width, 2);
    ASSERT_EQ(image.height, 2);
    EXPECT_EQ(image.pixels, (std::vector<glm::vec3>{glm::vec3(1.0f), glm::vec3(2.0f), glm::vec3(-0.5f), glm::vec3(0.0f)}));
    EXPECT_THROW((void)decode_exr(grey_halves("Z", {5, -3, 6, -2}), "x.exr"), ImageError);
}

void expect_within_a_step(const Image& back, const Image& image) {
    ASSERT_EQ(back.width, image.width);
    ASSERT_EQ(back.height, image.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3 p = image.pixels[i];
        const float half_step = std::max({p.x, p.y, p.z}) / 256.0f;
        for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(back.pixels[i][c] - p[c]), half_step) << i;
    }
}

TEST(RgbeFile, ComesBackWithinHalfAStepAtEveryWidth) {
    for (const int width : {1, 7, 8, 129, 700}) {
        const Image image = sample(width, 5);
        expect_within_a_step(decode_rgbe(encode_rgbe(image), "x.hdr"), image);
    }
    // Flat, since no run-length code holds such a width.
    expect_within_a_step(decode_rgbe(encode_rgbe(sample(32768, 1)), "x.hdr"), sample(32768, 1));
}

// Rounded, not cut off: a picture stays as bright as it was. Cutting off would darken it by half a step of some 1/300.
TEST(RgbeFile, KeepsTheMean) {
    Image image{256, 64, {}};
    std::uint32_t state = 5;
    const auto uniform = [&] { return static_cast<float>(next_random(state)) * 0x1p-24f; };
    for (int i = 0; i < 256 * 64; ++i) image.pixels.emplace_back(uniform(), uniform(), uniform());
    const Image back = decode_rgbe(encode_rgbe(image), "x.hdr");
    double sum = 0.0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) sum += static_cast<double>(back.pixels[i].y - image.pixels[i].y);
    EXPECT_LT(std::abs(sum / (256.0 * 64.0)), 3e-5);
}

TEST(RgbeFile, WhatItCannotHoldIsTheNearestThatItCan) {
    const Image image{4, 1, {{-1.0f, 2.0f, std::nanf("")}, {kInf, 0.0f, 1.0f}, {1e-42f, 0.0f, 0.0f}, {0.9999f, 0.5f, 0.0f}}};
    const Image back = decode_rgbe(encode_rgbe(image), "x.hdr");
    EXPECT_EQ(back.pixels[0], glm::vec3(0.0f, 2.0f, 0.0f));
    EXPECT_EQ(back.pixels[1], glm::vec3(std::ldexp(255.0f, 119), 0.0f, 0.0f));
    EXPECT_EQ(back.pixels[2], glm::vec3(0.0f));
    // Rounded up to the next power of two, the other channel with it.
    EXPECT_EQ(back.pixels[3], glm::vec3(1.0f, 0.5f, 0.0f));
}

TEST(RgbeFile, AnotherReaderSeesTheSame) {
    const Image image = sample(200, 9);
    const std::string file = encode_rgbe(image);
    const Image ours = decode_rgbe(file, "x.hdr");
    int width = 0, height = 0, channels = 0;
    float* theirs = stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(file.data()), static_cast<int>(file.size()), &width,
                                           &height, &channels, 3);
    ASSERT_NE(theirs, nullptr);
    EXPECT_EQ(width, 200);
    EXPECT_EQ(height, 9);
    EXPECT_EQ(std::memcmp(theirs, ours.pixels.data(), ours.pixels.size() * sizeof(glm::vec3)), 0);
    stbi_image_free(theirs);
}

TEST(RgbeFile, ExposureIsUndoneAndOtherKindsAreRefused) {
    const std::string pixels = std::string("\x80\x40\x00\x81", 4);
    const auto read = [&](const std::string& lines, const std::string& size) {
        return decode_rgbe("#?RADIANCE\n" + lines + "\n" + size + "\n" + pixels, "x.hdr");
    };
    EXPECT_EQ(read("", "-Y 1 +X 1").pixels[0], glm::vec3(1.0f, 0.5f, 0.0f));
    EXPECT_EQ(read("EXPOSURE=2\nEXPOSURE= 2\n", "-Y 1 +X 1").pixels[0], glm::vec3(0.25f, 0.125f, 0.0f));
    EXPECT_THROW((void)read("FORMAT=32-bit_rle_xyze\n", "-Y 1 +X 1"), ImageError);
    EXPECT_THROW((void)read("EXPOSURE=0\n", "-Y 1 +X 1"), ImageError);
    EXPECT_THROW((void)read("", "+X 1 -Y 1"), ImageError);
    EXPECT_THROW((void)read("", "-Y 1 +X 1 2"), ImageError);
    EXPECT_THROW((void)read("", "-Y 0 +X 1"), ImageError);
}

// What read_image makes of bytes in a file: nothing but a picture or one line.
class DamagedFile : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove(path_); }
    void expect_picture_or_one_line(const std::string& bytes) const {
        write_file_atomically(path_, bytes);
        try {
            const StoredImage stored = read_stored_image(path_);
            EXPECT_EQ(stored.image.pixels.size(),
                      static_cast<std::size_t>(stored.image.width) * static_cast<std::size_t>(stored.image.height));
        } catch (const ImageError& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with(path_.string())) << e.what();
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        }
    }
    void expect_refused(const std::string& bytes, const std::string& reason = "") const {
        write_file_atomically(path_, bytes);
        try {
            (void)read_image(path_);
            ADD_FAILURE() << "accepted";
        } catch (const ImageError& e) {
            EXPECT_NE(std::string(e.what()).find(reason), std::string::npos) << e.what();
        }
    }
    const std::filesystem::path path_ = std::filesystem::temp_directory_path() / ("glint-damaged-" + std::to_string(getpid()));
};

using Encoder = std::string (*)(const Image&);
constexpr std::array<Encoder, 3> kEncoders{encode_pfm, encode_rgbe, encode_exr};

TEST_F(DamagedFile, CutShortIsRefusedWhereverItIsCut) {
    for (const Encoder encode : kEncoders) {
        const std::string whole = encode(sample(17, 9));
        for (std::size_t size = 0; size < whole.size(); size += size < 500 ? 1 : 13) expect_refused(whole.substr(0, size));
        expect_refused(whole.substr(0, whole.size() - 1));
    }
}

TEST_F(DamagedFile, FlippedBitsGiveAPictureOrOneLine) {
    for (const Encoder encode : kEncoders) {
        const std::string whole = encode(sample(17, 9));
        std::uint32_t state = 3;
        for (std::size_t at = 0; at < whole.size(); at += at < 500 ? 1 : 7) {
            std::string flipped = whole;
            flipped[at] = static_cast<char>(flipped[at] ^ (1 << next_random(state) % 8));
            expect_picture_or_one_line(flipped);
        }
    }
}

// A few hundred bytes that claim to be huge take no memory.
TEST_F(DamagedFile, ClaimsAreNotBelieved) {
    const auto peak = [] {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss;  // KiB
    };
    const long before = peak();
    for (const std::string size : {"1000000000 1000000000", "16384 16384", "268435456 1", "-5 4", "99999999999999999999 1"}) {
        expect_refused("PF\n" + size + "\n-1.0\n" + std::string(300, 'x'));
        const std::string height = size.substr(0, size.find(' ')), width = size.substr(size.find(' ') + 1);
        expect_refused("#?RADIANCE\n\n-Y " + height + " +X " + width + "\n" + std::string(300, '\2'));
    }
    // 16000 x 16000 RGB, by its header alone.
    expect_refused(std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x3e\x80\0\0\x3e\x80\x08\2\0\0\0", 29) + std::string(300, 'x'));
    // A PNG's data, by their own chunk.
    std::string png = encode_png(to_display(sample(9, 5), {}), Transfer::srgb);
    png[png.find("IDAT") - 4] = '\x3f';
    expect_refused(png, "too short");
    // An attribute of 1.6 GB, of a type that OpenEXR does not know. It would take them before it finds the file's end, untouched,
    // which no peak shows; so it must not come to that.
    expect_refused(std::string("\x76\x2f\x31\x01\2\0\0\0x\0y\0\0\0\0\x60", 16) + std::string(300, '\0'), "its header");
    // The same behind an attribute of a type whose size OpenEXR knows better than the file, as the latter's contents.
    const auto hidden = [](std::string_view type, std::size_t known) {
        const std::string inner = std::string("x\0y\0\0\0\0\x60", 8) + std::string(56, '\0');
        return std::string("\x76\x2f\x31\x01\2\0\0\0z\0", 10) + std::string(type) + '\0' +
               std::string({static_cast<char>(known + inner.size()), 0, 0, 0}) + std::string(known, '\0') + inner +
               std::string(300, '\0');
    };
    expect_refused(hidden("float", 4), "its header");
    expect_refused(hidden("box2i", 16), "its header");
    expect_refused(hidden("chlist", 1), "its header");
    expect_refused(hidden("preview", 8), "its header");
    constexpr std::int32_t kBillion = 1000000000, kLeast = std::numeric_limits<std::int32_t>::min(), kMost = ~kLeast;
    for (const std::array<std::int32_t, 4> window : {std::array{0, 0, kBillion, kBillion},
                                                     {0, 0, 16383, 16383},
                                                     {0, 0, 1, kMost},
                                                     {kLeast, kLeast, kMost, kMost},
                                                     {3, 3, 2, 2},
                                                     {0, 0, 65534, 4000}}) {
        expect_refused(grey_halves("Y", window));
    }
    EXPECT_LT(peak() - before, 64 * 1024);
}

TEST_F(DamagedFile, WhatAFileHoldsIsSaid) {
    for (const Encoder encode : kEncoders) {
        write_file_atomically(path_, encode(sample(9, 5)));
        EXPECT_TRUE(read_stored_image(path_).radiance);
    }
    write_file_atomically(path_, encode_png(to_display(sample(9, 5), {}), Transfer::srgb));
    EXPECT_FALSE(read_stored_image(path_).radiance);
}

}  // namespace
}  // namespace glint
