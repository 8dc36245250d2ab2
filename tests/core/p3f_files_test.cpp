#include <cmath>
#include <cstdlib>

#include <stb/stb_image.h>

#include "core/camera.h"
#include "core/contained_path.h"
#include "tests/core/p3f_text.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct SharedScene {
    const char* name;
    std::size_t spheres, triangles, boxes, planes, lights, materials;
    int width, height;
};

void PrintTo(const SharedScene& s, std::ostream* out) { *out << s.name; }

class P3fSharedScene : public testing::TestWithParam<SharedScene> {};

TEST_P(P3fSharedScene, HoldsWhatThePaperCounts) {
    const SharedScene& expected = GetParam();
    const fs::path folder = fs::path(GLINT_SHARED) / "scenes/p3f";
    const fs::path file = folder / (std::string(expected.name) + ".p3f");
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
    LoadOptions options;
    options.load_environment = false;
    const auto scene = reader::read_p3f(reader::read_file(file), file.string(), folder, options);
    EXPECT_EQ(scene->geometry->spheres.size(), expected.spheres);
    EXPECT_EQ(scene->geometry->triangles.size(), expected.triangles);
    EXPECT_EQ(scene->geometry->boxes.size(), expected.boxes);
    EXPECT_EQ(scene->geometry->planes.size(), expected.planes);
    EXPECT_EQ(scene->lights.size(), expected.lights);
    EXPECT_EQ(scene->materials.size(), expected.materials);
    EXPECT_EQ(scene->width, expected.width);
    EXPECT_EQ(scene->height, expected.height);
    EXPECT_EQ(scene->transfer, Transfer::linear);
    EXPECT_EQ(scene->environment.kind, Environment::Kind::color);
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
}

INSTANTIATE_TEST_SUITE_P(
    Paper, P3fSharedScene,
    testing::Values(
        SharedScene{"balls_low", 10, 2, 0, 0, 3, 2, 512, 512}, SharedScene{"balls_low2", 10, 0, 0, 1, 3, 3, 512, 512},
        SharedScene{"balls_low_plane", 10, 0, 0, 1, 3, 2, 512, 512}, SharedScene{"balls_medium", 91, 2, 0, 0, 3, 2, 512, 512},
        SharedScene{"balls_high", 7381, 2, 0, 0, 3, 2, 512, 512}, SharedScene{"balls_box", 90, 2, 1, 0, 3, 3, 512, 512},
        SharedScene{"dof", 7, 2, 0, 0, 3, 2, 512, 512}, SharedScene{"dof_aperture12", 7, 2, 0, 0, 3, 2, 512, 512},
        SharedScene{"mount_low", 4, 8, 0, 0, 1, 2, 512, 512}, SharedScene{"mount_high", 4, 2048, 0, 0, 1, 2, 512, 512},
        SharedScene{"mount_very_high", 4, 32768, 0, 0, 1, 2, 512, 512}, SharedScene{"dragon", 2, 100002, 1, 0, 2, 5, 800, 600},
        SharedScene{"history_box", 0, 2, 1, 0, 3, 2, 512, 512}, SharedScene{"history_one_ball", 1, 0, 0, 1, 1, 2, 512, 512}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(P3fSharedScenes, TheDragonIsClosedAndItsSkyBoxIsRead) {
    const fs::path folder = fs::path(GLINT_SHARED) / "scenes/p3f";
    if (!fs::exists(folder / "dragon.p3f")) GTEST_SKIP();
    const auto scene = reader::read_p3f(reader::read_file(folder / "dragon.p3f"), "dragon.p3f", folder, {});
    const Geometry& g = *scene->geometry;
    EXPECT_EQ(g.vertices.size(), 50000u + 6u);
    double volume = 0.0;
    for (std::size_t i = 2; i < g.triangles.size(); ++i) {
        const auto& t = g.triangles[i];
        const auto v = [&](int k) { return glm::dvec3(g.vertices[t[static_cast<std::size_t>(k)]]); };
        volume += glm::dot(v(0), glm::cross(v(1), v(2))) / 6.0;
    }
    EXPECT_NEAR(volume, 0.308, 0.001);
    EXPECT_EQ(scene->environment.kind, Environment::Kind::cube);
    EXPECT_GT(scene->environment.faces[0].width, 100);
}

// The course's own picture of the dragon: left of the silver box its first rows show nothing but the sky box.
TEST(P3fSharedScenes, TheDragonsSkyIsThatOfTheCoursesPicture) {
    const fs::path folder = fs::path(GLINT_SHARED) / "scenes/p3f";
    const fs::path picture = fs::path(GLINT_SHARED) / "reference/dragon.png";
    if (!fs::exists(folder / "dragon.p3f") || !fs::exists(picture)) GTEST_SKIP();
    const auto scene = reader::read_p3f(reader::read_file(folder / "dragon.p3f"), "dragon.p3f", folder, {});
    int width = 0;
    int height = 0;
    int channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(stbi_load(picture.c_str(), &width, &height, &channels, 3),
                                                                      &stbi_image_free);
    ASSERT_NE(pixels, nullptr);
    const Camera camera(scene->cameras[0], width, height);
    int equal = 0;
    int close = 0;
    int all = 0;
    for (int y = 0; y < 48; y += 3) {
        for (int x = 0; x < 600; x += 7) {
            const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, glm::vec2(0.0f));
            const glm::vec3 sky = scene->environment.radiance(ray.direction) * 255.99f;
            int off = 0;
            for (int k = 0; k < 3; ++k)
                off = std::max(off, std::abs(static_cast<int>(sky[k]) - pixels.get()[(y * width + x) * 3 + k]));
            ++all;
            equal += off == 0 ? 1 : 0;
            close += off <= 2 ? 1 : 0;
            // Decoders of JPEG interpolate chroma differently: 4 of all 30,000 sky pixels differ by 9 or 10, wrong texels by far
            // more.
            EXPECT_LE(off, 10) << x << ' ' << y;
        }
    }
    EXPECT_GT(equal, all * 6 / 10);
    EXPECT_GT(close, all * 98 / 100);
}

TEST(ContainedPath, OnlyWhatEndsUpBelowIsFound) {
    const TestFolder folder;
    folder.write("scene/in/file", "x");
    folder.write("scene2/file", "x");
    const fs::path scene = folder.path() / "scene";
    fs::create_directory_symlink(folder.path() / "scene2", scene / "out");
    fs::create_symlink(scene / "in" / "file", scene / "link");
    EXPECT_TRUE(path_below(scene, "in/file"));
    EXPECT_TRUE(path_below(scene, "in/../in/file"));
    EXPECT_TRUE(path_below(scene, "link"));
    EXPECT_TRUE(path_below(scene, scene / "in"));
    EXPECT_FALSE(path_below(scene, "missing"));
    EXPECT_FALSE(path_below(scene, "../scene2/file"));
    EXPECT_FALSE(path_below(scene, "out/file"));
    EXPECT_FALSE(path_below(scene, folder.path() / "scene2"));
    EXPECT_TRUE(path_below(scene, "."));
}

std::string first_warning(const Scene& scene) { return scene.warnings.empty() ? "none" : scene.warnings.front(); }

constexpr std::string_view kSphere = "s 0 0 0 1\n";

TEST(P3fFiles, TheSkyBoxIsLookedUpBelowTheScene) {
    const TestFolder folder;
    write_sky_box(folder, "scene/sky");
    write_sky_box(folder, "elsewhere");
    const fs::path own = folder.path() / "scene";
    const auto read = [&](const std::string& statement, const LoadOptions& options) {
        return read_body("bclr 0.25 0.5 0.75 " + std::string(kSphere) + statement, own, options);
    };
    auto scene = read("env sky", {});
    EXPECT_EQ(scene->environment.kind, Environment::Kind::cube);
    EXPECT_EQ(scene->environment.color, glm::vec3(0.25f, 0.5f, 0.75f));
    EXPECT_TRUE(scene->warnings.empty());
    EXPECT_EQ(read("fire sky", {})->environment.kind, Environment::Kind::cube);

    LoadOptions without;
    without.load_environment = false;
    LoadOptions replaced;
    replaced.environment = folder.path() / "elsewhere";
    for (const LoadOptions& options : {without, replaced}) {
        scene = read("env missing", options);
        EXPECT_EQ(scene->environment.kind, Environment::Kind::color);
        EXPECT_TRUE(scene->warnings.empty());
    }

    for (const char* name : {"missing", "../elsewhere", "/", "."}) {
        scene = read(std::string("env ") + name, {});
        EXPECT_EQ(scene->environment.kind, Environment::Kind::color);
        EXPECT_NE(first_warning(*scene).find("t.p3f:2: env '"), std::string::npos) << first_warning(*scene);
    }
    // A picture that is a link out of the folder.
    fs::remove(own / "sky/top.png");
    fs::create_symlink(folder.path() / "elsewhere/top.png", own / "sky/top.png");
    EXPECT_NE(first_warning(*read("env sky", {})).find("outside the scene's folder"), std::string::npos);
    fs::remove(own / "sky/top.png");
    EXPECT_NE(first_warning(*read("env sky", {})).find("top.jpg: sky box picture is missing"), std::string::npos);
}

constexpr std::string_view kPly =
    "ply\nformat ascii 1.0\ncomment a quad and a triangle\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property float nx\nproperty float ny\nproperty float nz\nelement face 2\nproperty list uchar int "
    "vertex_indices\nend_header\n"
    "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 2\n2 2 0 0 0 0\n4 0 1 2 3\n3 1 4 2\n";

TEST(P3fFiles, AnAsciiPlyIsIncluded) {
    const TestFolder folder;
    folder.write("mesh/quad.ply", kPly);
    const auto scene = read_body("f 1 0 0 1 1 1 1 0 1 0 1\nply mesh/quad.ply\nply mesh/quad.ply", folder.path());
    EXPECT_EQ(scene->geometry->vertices.size(), 10u);
    EXPECT_EQ(scene->geometry->triangles.size(), 6u);
    ASSERT_EQ(scene->normals.size(), 10u);
    EXPECT_EQ(scene->normals[3], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene->normals[4], glm::vec3(0));
    EXPECT_EQ(scene->material(make_id(PrimitiveKind::triangle, 5)).diffuse, glm::vec3(1, 0, 0));
    EXPECT_TRUE(scene->warnings.empty());
}

std::string ply_refusal(const TestFolder& folder, std::string ply, std::string_view from, std::string_view to) {
    if (!from.empty()) ply.replace(ply.find(from), from.size(), to);
    folder.write("q.ply", ply);
    try {
        (void)read_body("ply q.ply", folder.path());
    } catch (const SceneError& e) {
        return e.what();
    }
    return "accepted";
}

TEST(P3fFiles, ABrokenPlyIsRefusedWithItsLine) {
    const TestFolder folder;
    const std::string ply(kPly);
    const auto expect = [&](std::string_view from, std::string_view to, const std::string& part) {
        const std::string message = ply_refusal(folder, ply, from, to);
        EXPECT_NE(message.find("q.ply:" + part), std::string::npos) << message << " for " << to;
    };
    expect("vertex 5", "vertex 1000000000000", "4: 'vertex' announces 1000000000000, more than the file can hold");
    expect("face 2", "face -2", "11: 'face' announces '-2', expected a count");
    expect("face 2", "face 3", "20: the file ends too early");
    expect("3 1 4 2", "3 1 5 2", "20: index 5 is out of range");
    expect("3 1 4 2", "2 1 4", "20: a face of 2 vertices");
    expect("3 1 4 2", "900 1 4", "20: a list announces 900, more than the file can hold");
    expect("ascii", "binary", "2: unknown format 'binary'");
    expect("ply\n", "", "1: not a PLY file");
    expect("end_header\n", "", "13: '0' is no word of a PLY header");
    expect("property float z\n", "", "4: 'vertex' has no x, y, z");
    expect("1 1 0 0", "1 nan 0 0", "16: vertex 2 is not finite");
    EXPECT_NE(ply_refusal(folder, "", "", "").find("q.ply:1: not a PLY file"), std::string::npos);
}

TEST(P3fFiles, APlyOutsideTheSceneIsRefused) {
    const TestFolder folder;
    folder.write("quad.ply", kPly);
    folder.write("scene/t.p3f", "");
    for (const std::string& name :
         {std::string("../quad.ply"), (folder.path() / "quad.ply").string(), std::string("missing.ply")}) {
        EXPECT_THROW((void)read_body("ply " + name, folder.path() / "scene"), SceneError);
    }
    EXPECT_THROW((void)read_body("ply scene", folder.path()), SceneError);
}

}  // namespace
}  // namespace glint
