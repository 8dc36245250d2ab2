#include "app/screenshot.h"

#include <unistd.h>

#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace glint {
namespace {

// A fresh folder, removed at the end.
class ScreenshotTest : public testing::Test {
protected:
    ScreenshotTest() {
        std::string name = (std::filesystem::temp_directory_path() / "glint_screenshot_XXXXXX").string();
        EXPECT_NE(mkdtemp(name.data()), nullptr);
        folder = name;
    }
    ~ScreenshotTest() override { std::filesystem::remove_all(folder); }

    std::filesystem::path folder;
};

TEST_F(ScreenshotTest, NameTellsSceneAcceleratorAndSamples) {
    EXPECT_EQ(screenshot_path(folder, "some/where/balls_low.p3f", "bvh", 37).filename(), "balls_low_bvh_37spp_1.png");
}

TEST_F(ScreenshotTest, NameHoldsNothingThatPathsOrShellsStumbleOver) {
    EXPECT_EQ(screenshot_path(folder, "builtin:balls,level=4", "none", 1).filename(), "balls_level_4_none_1spp_1.png");
    EXPECT_EQ(screenshot_path(folder, "a b/$(c) 'd'.p3f", "grid", 1).filename(), "__c___d__grid_1spp_1.png");
    EXPECT_EQ(screenshot_path(folder, "caf\u00e9.glb", "grid", 1).filename(), "caf\u00e9_grid_1spp_1.png");
}

TEST_F(ScreenshotTest, ExistingPictureIsNeverReplaced) {
    for (const char* expected : {"s_bvh_4spp_1.png", "s_bvh_4spp_2.png", "s_bvh_4spp_3.png"}) {
        const auto path = screenshot_path(folder, "s.p3f", "bvh", 4);
        EXPECT_EQ(path.filename(), expected);
        std::ofstream(path) << "taken";
    }
}

TEST_F(ScreenshotTest, FileHoldsTheBytesThatTheWindowShows) {
    const Image image{2, 1, {{0.25f, 0.5f, 0.75f}, {0.0f, 1.0f, 2.0f}}};
    const DisplaySettings display{-1.0f, Transfer::srgb};
    const auto path = folder / "picture.png";
    write_screenshot(path, image, display);
    const Image8 shown = to_display(image, display);
    const Image read = read_image(path);
    ASSERT_EQ(read.width, 2);
    for (std::size_t i = 0; i < shown.rgb.size(); ++i)
        EXPECT_EQ(std::lround(read.pixels[i / 3][static_cast<int>(i % 3)] * 255.0f), shown.rgb[i]);
}

TEST_F(ScreenshotTest, MissingFolderIsAnImageError) {
    EXPECT_THROW(write_screenshot(folder / "missing" / "picture.png", Image{1, 1, {{0, 0, 0}}}, {}), ImageError);
}

}  // namespace
}  // namespace glint
