// The blit without a window: OSMesa draws into memory, and the bytes are compared. A program of its own, because libOSMesa
// and libOpenGL export the same functions and must not meet.
#include "app/blit.h"

#include <limits>
#include <memory>
#include <set>

#include <GL/osmesa.h>
#include <gtest/gtest.h>

#include "core/renderer.h"
#include "core/scene_io.h"

namespace glint {
namespace {

// An OpenGL 3.3 core context on a framebuffer in memory.
class Memory {
public:
    Memory(int width, int height)
        : width_(width), height_(height), rgba_(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0x55) {
        const int attributes[] = {OSMESA_FORMAT,
                                  OSMESA_RGBA,
                                  OSMESA_DEPTH_BITS,
                                  0,
                                  OSMESA_PROFILE,
                                  OSMESA_CORE_PROFILE,
                                  OSMESA_CONTEXT_MAJOR_VERSION,
                                  3,
                                  OSMESA_CONTEXT_MINOR_VERSION,
                                  3,
                                  0,
                                  0};
        context_ = OSMesaCreateContextAttribs(attributes, nullptr);
        if (context_ == nullptr || !OSMesaMakeCurrent(context_, rgba_.data(), GL_UNSIGNED_BYTE, width, height))
            throw std::runtime_error("OSMesa has no OpenGL 3.3");
    }
    ~Memory() { OSMesaDestroyContext(context_); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;

    // What is in the framebuffer, top row first. Every pixel is opaque.
    [[nodiscard]] Image8 read() const {
        glFinish();
        Image8 image{width_, height_, {}};
        for (int y = height_ - 1; y >= 0; --y) {
            for (int x = 0; x < width_; ++x) {
                const std::uint8_t* pixel = rgba_.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                                                static_cast<std::size_t>(x));
                image.rgb.insert(image.rgb.end(), pixel, pixel + 3);
                EXPECT_EQ(pixel[3], 255);
            }
        }
        return image;
    }

private:
    int width_, height_;
    std::vector<std::uint8_t> rgba_;
    OSMesaContext context_ = nullptr;
};

// Every byte value, in an order that differs between rows and channels.
Image8 bytes(int width, int height, unsigned start = 0) {
    Image8 image{width, height, {}};
    const std::size_t n = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (std::size_t i = 0; i < n; ++i) image.rgb.push_back(static_cast<std::uint8_t>((start + i * 167 + i / 256 * 31) & 255));
    return image;
}

class BlitSize : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(BlitSize, PictureOfTheFramebuffersSizeArrivesByteForByte) {
    const auto [width, height] = GetParam();
    const Memory memory(width, height);
    Blit blit;
    for (const unsigned start : {0u, 85u}) {  // the second upload goes into the texture of the first
        const Image8 image = bytes(width, height, start);
        blit.upload(image);
        blit.draw(width, height);
        EXPECT_EQ(memory.read().rgb, image.rgb);
    }
}

INSTANTIATE_TEST_SUITE_P(OddAndEven, BlitSize,
                         testing::Values(std::pair{256, 64}, std::pair{101, 67}, std::pair{1, 1}, std::pair{3, 2},
                                         std::pair{1027, 5}),
                         [](const auto& tested) {
                             return std::to_string(tested.param.first) + "x" + std::to_string(tested.param.second);
                         });

TEST(Blit, SmallerPictureIsEnlargedInItsShapeOnBlack) {
    const Memory memory(40, 40);
    Blit blit;
    const Image8 image = bytes(20, 10);
    blit.upload(image);
    blit.draw(40, 40);
    const Image8 shown = memory.read();
    for (std::size_t y = 0; y < 40; ++y) {
        for (std::size_t x = 0; x < 40; ++x) {
            for (std::size_t c = 0; c < 3; ++c) {
                const bool band = y < 10 || y >= 30;
                const int expected = band ? 0 : image.rgb[3 * ((y - 10) / 2 * 20 + x / 2) + c];
                ASSERT_EQ(shown.rgb[3 * (y * 40 + x) + c], expected) << x << ' ' << y;
            }
        }
    }
}

TEST(Blit, LargerPictureIsShrunkToFit) {
    const Memory memory(10, 20);
    Blit blit;
    const Image8 image = bytes(40, 40);
    blit.upload(image);
    blit.draw(10, 20);
    const Image8 shown = memory.read();
    for (std::size_t y = 0; y < 20; ++y) {
        for (std::size_t x = 0; x < 10; ++x) {
            // Every fourth texel, counted from the bottom left as OpenGL does.
            const bool band = y < 5 || y >= 15;
            const int expected = band ? 0 : image.rgb[3 * ((4 * (y - 5) + 3) * 40 + 4 * x)];
            ASSERT_EQ(shown.rgb[3 * (y * 10 + x)], expected) << x << ' ' << y;
        }
    }
}

TEST(Blit, AnotherSizeReplacesThePicture) {
    const Memory memory(32, 32);
    Blit blit;
    blit.upload(bytes(64, 16));
    blit.draw(32, 32);
    const Image8 image = bytes(32, 32, 7);
    blit.upload(image);
    blit.draw(32, 32);
    EXPECT_EQ(memory.read().rgb, image.rgb);
}

TEST(Blit, BlackBeforeTheFirstPicture) {
    const Memory memory(8, 8);
    const Blit blit;
    blit.draw(8, 8);
    EXPECT_EQ(memory.read().rgb, std::vector<std::uint8_t>(8 * 8 * 3, 0));
}

// The whole path of the viewer: scene, accelerator, renderer, resolve, display bytes, blit.
TEST(Blit, RenderedSceneArrivesAsToDisplayMadeIt) {
    Frame frame;
    frame.scene = load_scene("builtin:balls,level=2");
    frame.accelerator = build_accelerator(AcceleratorKind::bvh, frame.scene->geometry);
    frame.camera = frame.scene->cameras.at(0);
    frame.settings.features = features_of(*frame.scene);
    frame.width = 101;
    frame.height = 67;
    frame.spp = 4;
    Renderer renderer(2, true);
    renderer.restart(frame);
    renderer.wait(std::numeric_limits<double>::infinity(), nullptr);
    Image image;
    ASSERT_TRUE(renderer.resolve(image));
    for (const Transfer transfer : {Transfer::linear, Transfer::srgb}) {
        const Image8 display = to_display(image, {0.0f, transfer});
        const Memory memory(101, 67);
        Blit blit;
        blit.upload(display);
        blit.draw(101, 67);
        EXPECT_EQ(memory.read().rgb, display.rgb);
        EXPECT_GT(std::set<std::uint8_t>(display.rgb.begin(), display.rgb.end()).size(), 50u) << "a picture, not one colour";
    }
}

}  // namespace
}  // namespace glint
