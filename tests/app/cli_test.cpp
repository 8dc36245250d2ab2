// The program as a stranger calls it: exit codes, messages of one line, files whole or absent, options that do what they say.
#include <csignal>
#include <thread>

#include <nlohmann/json.hpp>

#include "core/image.h"
#include "tests/app/command_line.h"

namespace glint {
namespace {

TEST_F(CommandLine, BadUsageIsOneLineAndExit2) {
    expect_refused("render builtin:balls -o x.png --spq 3", 2, "unknown option '--spq'; did you mean '--spp'?");
    expect_refused("render builtin:balls -o x.png --accel bhv", 2, "did you mean 'bvh'?");
    expect_refused("render builtin:balls -o x.png --features +sofft", 2, "did you mean 'soft'?");
    expect_refused("render builtin:balls -o x.png --spp -4", 2, "--spp");
    expect_refused("render builtin:balls -o x.png --spp 0", 2, "--spp");
    expect_refused("render builtin:balls -o x.png --spp 1e3", 2, "--spp");
    expect_refused("render builtin:balls -o x.png --resolution 0x10", 2, "--resolution");
    expect_refused("render builtin:balls -o x.png --resolution 1000000x1000000", 2, "--resolution");
    expect_refused("render builtin:balls -o x.png --resolution 60000x60000", 2, "2^28 pixels");
    expect_refused("render builtin:balls -o x.png --resolution 10", 2, "WxH");
    expect_refused("render builtin:balls -o x.png --aperture nan", 2, "--aperture");
    expect_refused("render builtin:balls -o x.png --light-size -1", 2, "--light-size");
    expect_refused("render builtin:balls -o x.png --camera-position 1,2", 2, "X,Y,Z");
    expect_refused("render builtin:balls -o x.png --camera-position 1,2,inf", 2, "X,Y,Z");
    expect_refused("render builtin:balls -o x.png --camera-position 1,1,1 --camera-focal-point 1,1,1", 2, "the same");
    expect_refused("render builtin:balls -o x.png --camera-view-angle 180", 2, "--camera-view-angle");
    expect_refused("render builtin:balls -o x.png --camera-view-up 0,0,0", 2, "--camera-view-up");
    expect_refused("render builtin:balls -o x.png --camera-index 7", 2, "--camera-index");
    expect_refused("render builtin:balls -o x.png --crop 5,5,0,9", 2, "--crop");
    expect_refused("render builtin:balls -o x.png --crop 0,9999,0,9", 2, "--crop");
    expect_refused("render builtin:balls -o x.png --threads 99999", 2, "--threads");
    expect_refused("render builtin:balls -o x.gif", 2, ".png, .pfm, .hdr or .exr");
    expect_refused("render builtin:balls", 2, "-o");
    expect_refused("render builtin:balls also -o x.png", 2, "'also'");
    expect_refused("compare one.png", 2, "two pictures");
    expect_refused("render builtin:balls -o x.png --nosie 0.1", 2, "did you mean '--noise'");
}

TEST_F(CommandLine, ARefusedSceneIsOneLineAndExit3) {
    expect_refused("render " + path("missing.p3f") + " -o x.png", 3, "missing.p3f");
    expect_refused("render builtin:bals -o x.png", 3, "bals");
    expect_refused("render " + folder.string() + " -o x.png", 3, folder.string());
    expect_refused("render " + write("empty.p3f", "") + " -o x.png", 3, "empty.p3f");
    expect_refused("render " + write("cut.p3f", "v\nfrom 1 2 3\nat 0 0") + " -o x.png", 3, "cut.p3f:3");
    expect_refused("render " + write("huge.p3f", "mesh 1000000000000 1000000000000\n0 0 0\n") + " -o x.png", 3, "huge.p3f:1");
    expect_refused("render " + write("nan.p3f", "s 0 0 nan 1\n") + " -o x.png", 3, "nan.p3f:1");
    expect_refused("render " + write("binary.glb", std::string("glTF\x02\0\0\0\xff\xff\xff\xff", 12)) + " -o x.png", 3,
                   "binary.glb");
    expect_refused("render " + write("scene.xyz", "") + " -o x.png", 3, "scene.xyz");
    expect_refused("info " + path("missing.gltf"), 3, "missing.gltf");
}

TEST_F(CommandLine, AnUnwritableOutputIsExit5AndLeavesNothingBehind) {
    expect_refused(quick + "-o " + path("no/such/folder/x.png"), 5, "cannot write");
    expect_refused(quick + "-o /dev/full/x.png", 5, "cannot write");
    fs::create_directory(folder / "taken.png");
    expect_refused(quick + "-o " + path("taken.png"), 5, "folder");
    for (const auto& entry : fs::directory_iterator(folder)) EXPECT_EQ(entry.path().string().find(".part"), std::string::npos);
}

TEST_F(CommandLine, RendersPngAndPfmOfTheSamePicture) {
    ASSERT_EQ(glint(quick + "-o " + path("a.png")).code, 0);
    ASSERT_EQ(glint(quick + "-o " + path("a.pfm")).code, 0);
    const Image png = read_image(path("a.png")), pfm = read_image(path("a.pfm"));
    ASSERT_EQ(png.width, 32);
    ASSERT_EQ(png.height, 24);
    const Image8 shown = to_display(pfm, {0.0f, Transfer::linear});
    for (std::size_t i = 0; i < png.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(static_cast<int>(std::lround(png.pixels[i][static_cast<int>(c)] * 255.0f)), shown.rgb[3 * i + c]);
        }
    }
    EXPECT_EQ(glint("compare " + path("a.png") + " " + path("a.png")).code, 0);
    EXPECT_EQ(glint("compare " + path("a.png") + " " + path("a.pfm")).code, 1);
}

TEST_F(CommandLine, PngOnStdoutEqualsTheFile) {
    ASSERT_EQ(glint(quick + "-o " + path("a.png")).code, 0);
    const Outcome piped = glint(quick + "-o - --stats json");
    EXPECT_EQ(piped.code, 0);
    EXPECT_EQ(piped.out, contents(path("a.png")));
    EXPECT_NE(piped.err.find("\"mrays_per_s\""), std::string::npos);
}

TEST_F(CommandLine, OnlySrgbPicturesCarryAnSrgbChunk) {
    ASSERT_EQ(glint(quick + "-o " + path("linear.png")).code, 0);
    ASSERT_EQ(glint(quick + "--transfer srgb -o " + path("srgb.png")).code, 0);
    EXPECT_EQ(contents(path("linear.png")).find("sRGB"), std::string::npos);
    EXPECT_NE(contents(path("srgb.png")).find("sRGB"), std::string::npos);
}

TEST_F(CommandLine, ExposureAndTransferNeverTouchPfm) {
    ASSERT_EQ(glint(quick + "-o " + path("a.pfm")).code, 0);
    ASSERT_EQ(glint(quick + "--exposure 2 --transfer srgb -o " + path("b.pfm")).code, 0);
    EXPECT_EQ(contents(path("a.pfm")), contents(path("b.pfm")));
}

TEST_F(CommandLine, StatsCountWhatWasAsked) {
    const Outcome r = glint(quick + "-o " + path("a.png") + " --stats json --threads 1 --accel grid --seed 7 --crop 0,8,4,8");
    ASSERT_EQ(r.code, 0) << r.err;
    const auto json = nlohmann::json::parse(r.out);
    EXPECT_EQ(json["rays"]["camera"], 8 * 4 * 2);
    EXPECT_EQ(json["accelerator"], "grid");
    EXPECT_EQ(json["stopped_by"], "spp");
    EXPECT_EQ(json["spp_min"], 2);
    EXPECT_EQ(json["threads"], 1);
    // Said twice, the last one counts.
    EXPECT_EQ(nlohmann::json::parse(glint(quick + "-o " + path("b.png") + " --stats json --spp 5").out)["spp"], 5);
    EXPECT_EQ(json["non_finite_samples"], 0);
    const Image crop = read_image(path("a.png"));
    EXPECT_EQ(crop.width, 8);
    EXPECT_EQ(crop.height, 4);
}

TEST_F(CommandLine, OneShaForEveryAcceleratorThreadCountAndRepetition) {
    std::string expected;
    for (const char* variant :
         {"--accel none --threads 1", "--accel grid --threads 2", "--accel bvh --threads 3", "--accel auto"}) {
        ASSERT_EQ(glint(quick + "--seed 1 --features all -o " + path("a.png") + " " + variant).code, 0);
        if (expected.empty()) expected = contents(path("a.png"));
        EXPECT_EQ(contents(path("a.png")), expected) << variant;
    }
}

TEST_F(CommandLine, FeatureListsReplaceOrEdit) {
    const auto picture = [&](const std::string& features) {
        EXPECT_EQ(glint(quick + "-o " + path("f.png") + " --features " + features).code, 0);
        return contents(path("f.png"));
    };
    EXPECT_EQ(picture("whitted,-shadows"), picture("specular,reflections,refractions"));
    EXPECT_NE(picture("+soft"), picture("-soft"));
    EXPECT_NE(picture("+dof"), picture("-dof"));
    EXPECT_NE(picture("+fuzzy"), picture("-fuzzy"));
    EXPECT_EQ(picture("all,-soft,-dof,-fuzzy"), picture("aa,whitted"));
}

TEST_F(CommandLine, CameraOptionsMoveTheCamera) {
    // The scene's own camera, spelt out.
    const std::string own =
        "--camera-position 2.1,1.3,1.7 --camera-focal-point 0,0,0 --camera-view-up 0,0,1 --camera-view-angle 45";
    ASSERT_EQ(glint(quick + "-o " + path("a.png")).code, 0);
    ASSERT_EQ(glint(quick + own + " -o " + path("b.png")).code, 0);
    EXPECT_EQ(contents(path("a.png")), contents(path("b.png")));
    ASSERT_EQ(glint(quick + "--camera-view-angle 30 -o " + path("b.png")).code, 0);
    EXPECT_NE(contents(path("a.png")), contents(path("b.png")));
}

TEST_F(CommandLine, FarOutPositionsArePointsOfTheWorld) {
    const std::string scene =
        write("far.p3f",
              "v from 1000000.25 2000000.5 -2999996 at 1000000 2000000 -3000000 up 0 1 0 angle 45 hither 1\n"
              "resolution 32 24 l 1000003 2000009 -2999990 1 1 1 f 1 0.5 0.2 1 0 1 0 1\n"
              "s 1000000 2000000 -3000000 1 s 1000000.5 2000000.5 -2999999.25 0.25");
    const std::string command = "render " + scene + " --spp 2 -o ";
    ASSERT_EQ(glint(command + path("a.png")).code, 0);
    ASSERT_EQ(glint(command + path("b.png") + " --camera-position 1000000.25,2000000.5,-2999996").code, 0);
    EXPECT_EQ(contents(path("a.png")), contents(path("b.png")));
    ASSERT_EQ(glint(command + path("b.png") + " --camera-focal-point 1000000.125,2000000,-3000000").code, 0);
    EXPECT_NE(contents(path("a.png")), contents(path("b.png")));
    const Outcome info = glint("info " + scene);
    EXPECT_NE(info.out.find("bounds 999999 1999999 -3000001"), std::string::npos) << info.out;
    EXPECT_NE(info.out.find("stored relative to 1000000 2000000 -3000000"), std::string::npos) << info.out;
}

TEST_F(CommandLine, ASceneWithoutEnvironmentCanHaveTheProceduralSky) {
    ASSERT_EQ(glint(quick + "-o " + path("a.png")).code, 0);
    ASSERT_EQ(glint(quick + "--background color -o " + path("b.png")).code, 0);
    ASSERT_EQ(glint(quick + "--background environment -o " + path("c.png")).code, 0);
    EXPECT_EQ(contents(path("a.png")), contents(path("b.png")));
    EXPECT_NE(contents(path("a.png")), contents(path("c.png")));
    expect_refused(quick + "-o x.png --environment " + path("none"), 3, "none");
}

TEST_F(CommandLine, NamesAreFilledIn) {
    ASSERT_EQ(glint(quick + "--accel grid -o '" + path("{scene}-{accel}-{spp}.png") + "'").code, 0);
    EXPECT_TRUE(fs::exists(folder / "builtin_balls_level_1-grid-2.png"));
    for (int n = 1; n <= 2; ++n) {
        ASSERT_EQ(glint(quick + "-o '" + path("shot{n}.png") + "'").code, 0);
        EXPECT_TRUE(fs::exists(folder / fmt::format("shot{}.png", n)));
    }
}

TEST_F(CommandLine, TimeEndsARenderAndIsNamed) {
    const Outcome r =
        glint("render builtin:balls,level=2 --resolution 64x48 --spp 1000000 --time 0.3 --stats json -o " + path("a.png"));
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(nlohmann::json::parse(r.out)["stopped_by"], "time");
    EXPECT_TRUE(fs::exists(folder / "a.png"));
}

TEST_F(CommandLine, SignalsSaveWhatWasRendered) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const std::string picture = path(fmt::format("{}.png", signal));
        const pid_t child = fork();
        if (child == 0) {
            execl(GLINT_BINARY, "glint", "render", "builtin:balls,level=2", "--resolution", "64x48", "--spp", "100000000",
                  "--quiet", "-o", picture.c_str(), nullptr);
            _exit(127);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(700));
        kill(child, signal);
        int status = 0;
        waitpid(child, &status, 0);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 128 + signal);
        EXPECT_EQ(read_image(picture).width, 64);
    }
}

TEST_F(CommandLine, AdaptiveSamplesStopAtTheErrorThatWasAskedFor) {
    const std::string words = "render builtin:dof --resolution 128x96 --quiet --stats json --noise 0.02 -o " + path("x.pfm");
    const nlohmann::json even = nlohmann::json::parse(glint(words).out);
    const nlohmann::json adaptive = nlohmann::json::parse(glint(words + " --adaptive").out);
    for (const nlohmann::json& stats : {even, adaptive}) {
        EXPECT_EQ(stats["stopped_by"], "noise");
        EXPECT_LE(stats["error"]["relrmse"], 0.02);
    }
    EXPECT_TRUE(adaptive["adaptive"]);
    EXPECT_LT(adaptive["spp_min"], adaptive["spp_max"]);
    EXPECT_LE(adaptive["rays"]["camera"], even["rays"]["camera"]);
    EXPECT_EQ(glint("render builtin:dof --adaptive --sampler regular -o x.png").code, 2);
}

TEST_F(CommandLine, HelpVersionListAndInfoGoToStdout) {
    const Outcome help = glint("render --help");
    EXPECT_EQ(help.code, 0);
    for (const char* option : {"--resolution", "--spp", "--features", "--accel", "--isa", "--crop", "--stats", "--hdri-file",
                               "--camera-view-up", "--preset", "--noise", "--convergence", "--adaptive"}) {
        EXPECT_NE(help.out.find(option), std::string::npos) << option;
    }
    // What is not built yet is not promised.
    for (const char* option : {"--tone-map", "--checkpoint"}) EXPECT_EQ(help.out.find(option), std::string::npos) << option;
    EXPECT_NE(glint("--help").out.find("Keys"), std::string::npos);
    EXPECT_NE(glint("--version").out.find("glint "), std::string::npos);
    const Outcome list = glint("list");
    EXPECT_EQ(list.code, 0);
    for (const char* word : {"builtin:balls", "builtin:cornell", "bvh", "sobol"})
        EXPECT_NE(list.out.find(word), std::string::npos) << word;
    const Outcome info = glint("info builtin:balls,level=2");
    EXPECT_EQ(info.code, 0);
    EXPECT_NE(info.out.find("spheres 91"), std::string::npos);
}

}  // namespace
}  // namespace glint
