// PLY meshes as scenes: the three formats and their packed forms are one mesh, seen whole on its stage.
#include <cmath>
#include <filesystem>
#include <string>

#include "core/scene_io.h"
#include "tests/core/ply_file.h"

namespace glint {
namespace {

using test::arrow;
using test::gzipped;
using test::kQuad;
using test::PlyFile;

using PlyScene = test::MeshFileTest;

TEST_F(PlyScene, TheThreeFormatsAndTheirPackedFormsAreOneMesh) {
    const PlyFile file = arrow();
    const auto expected = load_scene(write("text.ply", file.text()));
    ASSERT_EQ(expected->geometry->triangles.size(), 2u + 1u + 2u);  // the polygon, the triangle, the floor
    EXPECT_EQ(expected->geometry->vertices[2], glm::vec3(1.7f, 0.0f, static_cast<float>(1.0 / 3.0)));
    EXPECT_EQ(expected->geometry->vertices[1].y, 3e-5f);
    ASSERT_EQ(expected->normals.size(), expected->geometry->vertices.size());
    EXPECT_EQ(expected->normals[0], glm::vec3(0));
    EXPECT_EQ(expected->normals[1], glm::vec3(0, 0, 1));
    EXPECT_EQ(expected->normals[5], glm::vec3(0)) << "a normal that is not finite is none";
    const auto expect_same = [&](const std::string& name, const std::string& bytes) {
        const auto scene = load_scene(write(name, bytes));
        EXPECT_EQ(scene->geometry->vertices, expected->geometry->vertices) << name;
        EXPECT_EQ(scene->geometry->triangles, expected->geometry->triangles) << name;
        EXPECT_EQ(scene->normals, expected->normals) << name;
        EXPECT_EQ(scene->cameras, expected->cameras) << name;
        ASSERT_EQ(scene->warnings.size(), 1u) << name;
        EXPECT_TRUE(scene->warnings[0].ends_with(name + ": 1 of 3 faces have no area, dropped")) << scene->warnings[0];
    };
    expect_same("text.ply", file.text());
    expect_same("little.ply", file.binary(false));
    expect_same("big.PLY", file.binary(true));
    expect_same("text.ply.gz", gzipped(file.text()));
    expect_same("little.PLY.GZ", gzipped(file.binary(false)));
    expect_same("big.ply.gz", gzipped(file.binary(true)));
    // Packed or not is seen by the bytes; members of a packed file follow one another.
    expect_same("odd.ply", gzipped(file.binary(false)));
    const std::string text = file.text();
    expect_same("members.ply.gz", gzipped(text.substr(0, 700)) + gzipped(text.substr(700)));
}

TEST_F(PlyScene, LinesMayEndInAnyWay) {
    const auto expected = load_scene(write("a.ply", arrow().text()));
    for (const std::string ending : {"\r\n", "\r"}) {
        std::string text = arrow().text();
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += ending.size())
            text.replace(at, 1, ending);
        EXPECT_EQ(load_scene(write("b.ply", text))->geometry->vertices, expected->geometry->vertices);
        EXPECT_EQ(load_scene(write("c.ply", text.substr(0, text.find_last_not_of("\r\n") + 1)))->geometry->triangles,
                  expected->geometry->triangles);
    }
    std::string binary = arrow().binary(true);
    for (std::size_t at = 0, end = binary.find("end_header"); (at = binary.find('\n', at)) <= end + 10; at += 2, ++end) {
        binary.replace(at, 1, "\r\n");
    }
    EXPECT_EQ(load_scene(write("d.ply", binary))->geometry->vertices, expected->geometry->vertices);
}

TEST_F(PlyScene, AMeshOnStageIsSeenWholeFromAboveTheFloor) {
    const auto scene = load_scene(write("a.ply", arrow().text()));
    ASSERT_EQ(scene->cameras.size(), 1u);
    ASSERT_EQ(scene->lights.size(), 1u);
    const CameraPose& pose = scene->cameras[0];
    const glm::vec3 forward = glm::normalize(pose.target - pose.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, pose.up)), up = glm::cross(right, forward);
    float fullest = 0.0f;
    const float high = std::tan(glm::radians(0.5f * pose.view_angle));
    const float wide = high * static_cast<float>(scene->width) / static_cast<float>(scene->height);
    for (std::size_t i = 0; i < 6; ++i) {
        const glm::vec3 d = scene->geometry->vertices[i] - pose.eye;
        const float depth = glm::dot(d, forward);
        ASSERT_GT(depth, 0.0f);
        fullest = std::max({fullest, std::abs(glm::dot(d, right)) / depth / wide, std::abs(glm::dot(d, up)) / depth / high});
    }
    EXPECT_LT(fullest, 1.0f);
    EXPECT_GT(fullest, 0.8f);
    EXPECT_GT(pose.eye.y, 0.0f);
    EXPECT_GT(scene->lights[0].position.y, pose.eye.y);
    for (std::size_t i = 6; i < 10; ++i) EXPECT_EQ(scene->geometry->vertices[i].y, 0.0f);
}

TEST_F(PlyScene, DamagedPackedFilesAreRefusedInOneLine) {
    const auto refused = [&](const std::string& bytes) -> std::string {
        const std::string path = write("m.ply.gz", bytes);
        try {
            (void)load_scene(path);
        } catch (const SceneError& e) {
            return std::string(e.what()).substr(path.size());
        }
        return "accepted";
    };
    const std::string packed = gzipped(arrow().binary(false));
    const std::string damaged = ": the gzip data are damaged or cut off";
    EXPECT_EQ(refused(packed), "accepted");
    EXPECT_EQ(refused(packed + "x"), damaged);
    for (std::size_t size = 2; size < packed.size(); size += 7) EXPECT_EQ(refused(packed.substr(0, size)), damaged) << size;
    for (std::size_t i = 20; i + 8 < packed.size(); i += 5) {
        std::string wrong = packed;
        wrong[i] = static_cast<char>(wrong[i] ^ 0x55);
        // Damage may also lengthen the data, which then do not fit into what the file says.
        EXPECT_NE(refused(wrong), "accepted") << i;
    }
    std::string lie = packed;
    lie[lie.size() - 1] = '\x7f';
    EXPECT_EQ(refused(lie), damaged);
    EXPECT_EQ(refused(gzipped("hello")), ":1: not a PLY file: expected 'ply'");
    EXPECT_EQ(refused(gzipped(std::string(std::size_t{80} << 20, ' '))), ": unpacks to more than 67108864 bytes");
    EXPECT_NE(refused("ply\n").find(":1: the header has no 'end_header'"), std::string::npos);
}

TEST_F(PlyScene, AMeshWithNothingToShowIsRefused) {
    const auto refused = [&](const std::string& from, const std::string& to) -> std::string {
        std::string text = kQuad;
        text.replace(text.find(from), std::string::npos, to);
        try {
            (void)load_scene(write("m.ply", text));
        } catch (const SceneError& e) {
            return e.what();
        }
        return "accepted";
    };
    EXPECT_NE(refused("element face", "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n").find("nothing to show: 0 faces"),
              std::string::npos);
    EXPECT_NE(refused("3 0 1 2", "3 0 0 1\n3 2 2 2\n").find("nothing to show: 2 faces, none with an area"), std::string::npos);
    EXPECT_NE(refused("3 0 1 2", "3 0 1 2\n3 2 2 2\n"), "refused");
}

TEST(PlyShared, TheDragonHasAllItsTriangles) {
    const auto path = std::filesystem::path(GLINT_SHARED) / "scenes" / "mesh" / "dragon_vrip.ply.gz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const auto scene = load_scene(path.string());
    // 108 of its 871414 faces name a vertex twice or two vertices at one point; two triangles are the floor's.
    EXPECT_EQ(scene->geometry->triangles.size(), 871414u - 108u + 2u);
    EXPECT_EQ(scene->geometry->vertices.size(), 437645u + 4u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_NE(scene->warnings[0].find("108 of 871414 faces have no area, dropped"), std::string::npos);
    EXPECT_TRUE(scene->normals.empty());
}

}  // namespace
}  // namespace glint
