// The door for scenes: which reader serves what, and what a file must be to be read at all.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/scene_io.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

class SceneDoor : public testing::Test {
protected:
    SceneDoor() : folder_(fs::path(testing::TempDir()) / ("glint_scene_io_" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~SceneDoor() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    std::string write(const std::string& name, const std::string& text) const {
        const fs::path path = folder_ / name;
        std::ofstream(path, std::ios::binary) << text;
        return path.string();
    }

    fs::path folder_;
};

template <class Function>
std::string refusal(Function function) {
    try {
        function();
    } catch (const SceneError& error) {
        return error.what();
    }
    ADD_FAILURE() << "was accepted";
    return {};
}

TEST_F(SceneDoor, ReadsAFileByteForByte) {
    std::string text(3'000'001, 'x');
    text[7] = '\0';
    text[8] = '\r';
    EXPECT_EQ(reader::read_file(write("a", text)), text);
    EXPECT_EQ(reader::read_file(write("empty", "")), "");
}

TEST_F(SceneDoor, ReadsOnlyRegularFilesUpToALimit) {
    const std::string path = write("a", "12345678");
    EXPECT_EQ(reader::read_file(path, 8), "12345678");
    EXPECT_EQ(refusal([&] { (void)reader::read_file(path, 7); }), path + ": larger than 7 bytes");
    EXPECT_EQ(refusal([&] { (void)reader::read_file(folder_); }), folder_.string() + ": is a folder, not a file");
    EXPECT_EQ(refusal([&] { (void)reader::read_file(folder_ / "none"); }), (folder_ / "none").string() + ": no such file");
    EXPECT_EQ(refusal([&] { (void)reader::read_file(fs::path(path) / "below"); }).substr(0, path.size()), path);
    EXPECT_EQ(refusal([&] { (void)reader::read_file("/dev/zero"); }), "/dev/zero: not a regular file");
}

TEST_F(SceneDoor, ChoosesTheReaderByTheEndingInAnyCase) {
    const std::string text =
        "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 8 8\nf 1 1 1 1 0 0 0 1\ns 0 0 0 1\n";
    for (const char* name : {"a.nff", "a.p3f", "a.P3F"})
        EXPECT_EQ(load_scene(write(name, text))->geometry->spheres.size(), 1u) << name;
}

TEST_F(SceneDoor, RefusesWhatItCannotReadAndSaysWhatItCan) {
    EXPECT_EQ(refusal([&] { (void)load_scene("a/b.obj"); }), "a/b.obj: .obj is not supported yet");
    EXPECT_EQ(refusal([&] { (void)load_scene("b.PLY"); }), "b.PLY: no such file");
    EXPECT_EQ(refusal([&] { (void)load_scene("b.ply.gz"); }), "b.ply.gz: no such file");
    EXPECT_NE(refusal([&] { (void)load_scene("b.gz"); }).find("unknown kind of scene"), std::string::npos);
    EXPECT_EQ(refusal([&] { (void)load_scene("balls"); }), "balls: not a scene file; did you mean builtin:balls?");
    EXPECT_EQ(refusal([&] { (void)load_scene("x.txt"); }),
              "x.txt: unknown kind of scene, expected .p3f, .nff, .gltf, .glb, .ply, .ply.gz or builtin:NAME");
    EXPECT_NE(refusal([&] { (void)load_scene(""); }).find("unknown kind of scene"), std::string::npos);
    EXPECT_EQ(refusal([&] { (void)load_scene("none.p3f"); }), "none.p3f: no such file");
}

TEST_F(SceneDoor, ReplacesTheEnvironmentOfAnyScene) {
    const LoadOptions replaced{.load_environment = true, .environment = folder_};
    EXPECT_FALSE(refusal([&] { (void)load_scene("builtin:balls,level=1", replaced); }).empty());
    // Where no picture is wanted, none is opened.
    const LoadOptions none{.load_environment = false, .environment = folder_};
    EXPECT_EQ(load_scene("builtin:balls,level=1", none)->environment.kind, Environment::Kind::color);
    const fs::path skybox = fs::path(GLINT_SHARED) / "scenes" / "p3f" / "skybox";
    if (!fs::exists(skybox)) GTEST_SKIP() << skybox << " is not here";
    const auto scene = load_scene("builtin:balls,level=1", {.load_environment = true, .environment = skybox});
    EXPECT_EQ(scene->environment.kind, Environment::Kind::cube);
    EXPECT_EQ(scene->geometry->spheres.size(), 10u);
}

TEST_F(SceneDoor, EveryAssetLoadsWithoutAWarning) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(GLINT_TESTS) / ".." / "assets")) {
        if (entry.path().extension() != ".p3f") continue;
        SCOPED_TRACE(entry.path());
        const auto scene = load_scene(entry.path().string());
        EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
        EXPECT_FALSE(scene->lights.empty());
        EXPECT_GT(scene->geometry->bounded_count(), 0u);
        ++count;
    }
    EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace glint
