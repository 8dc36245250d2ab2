// PLY meshes: the three formats and their packed forms are one mesh; broken files are refused in one line, and quickly.
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "core/ply.h"
#include "core/scene_io.h"
#include "tests/core/ply_file.h"

namespace glint {
namespace {

using test::gzipped;
using test::PlyFile;
using test::PlyValue;

using PlyScene = test::MeshFileTest;

const std::string kMeshHeader =
    "comment properties in no usual order\nobj_info none\nelement material 2\nproperty list ushort double weights\n"
    "property char kind\nelement vertex 6\nproperty uchar red\nproperty double z\nproperty float nx\nproperty float x\n"
    "property list uchar short links\nproperty float ny\nproperty float y\nproperty float nz\nelement face 3\n"
    "property int flags\nproperty list uchar uint vertex_indices\nproperty list uchar float texcoord\nelement edge 1\n"
    "property int vertex1\nproperty int vertex2\nend_header\n";

// An arrow head (concave) with its notch at vertex 2, a triangle above it, and one without area.
PlyFile arrow() {
    PlyFile file(kMeshHeader);
    file.add({{"ushort", 2}, {"double", 0.5}, {"double", -1e300}, {"char", -7}});
    file.add({{"ushort", 0}, {"char", 1}});
    const double third = 1.0 / 3.0;
    const double points[6][3] = {{-1.1, 0, third}, {0, 3e-5, third}, {1.7, 0, third}, {0, 2.5, third}, {0, 1, 2}, {0, 1, 2}};
    for (int i = 0; i < 6; ++i) {
        const double n = i == 5 ? std::numeric_limits<double>::quiet_NaN() : 2.0 * (i % 3);
        std::vector<PlyValue> record{{"uchar", 200.0}, {"double", points[i][2]}, {"float", 0.0}, {"float", points[i][0]}};
        record.push_back({"uchar", static_cast<double>(i)});
        for (int k = 0; k < i; ++k) record.push_back({"short", -300.0 * k});
        record.push_back({"float", 0.0});
        record.push_back({"float", points[i][1]});
        record.push_back({"float", n});
        file.add(record);
    }
    file.add({{"int", -5}, {"uchar", 4}, {"uint", 0}, {"uint", 1}, {"uint", 2}, {"uint", 3}, {"uchar", 1}, {"float", 0.25}});
    file.add({{"int", 1}, {"uchar", 3}, {"uint", 2}, {"uint", 3}, {"uint", 4}, {"uchar", 0}});
    file.add({{"int", 1}, {"uchar", 3}, {"uint", 3}, {"uint", 4}, {"uint", 5}, {"uchar", 0}});
    file.add({{"int", 0}, {"int", 1}});
    return file;
}

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

std::string refusal(const std::string& bytes) {
    try {
        (void)read_ply(bytes, "m.ply");
    } catch (const SceneError& e) {
        return e.what();
    }
    return "accepted";
}

const std::string kQuad =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
    "property list char int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

TEST(PlyErrors, ABrokenTextIsRefusedWithItsLine) {
    const struct {
        std::string from, to, expected;
    } cases[] = {
        {"ply\n", "plx\n", "m.ply:1: not a PLY file: expected 'ply'"},
        {kQuad, "", "m.ply:1: not a PLY file: expected 'ply'"},
        {"format ascii 1.0\n", "", "m.ply:8: not a PLY file: the header has no 'format'"},
        {"ascii", "utf8", "m.ply:2: unknown format 'utf8', expected ascii, binary_little_endian or binary_big_endian"},
        {"element vertex 4", "element vertex -4", "m.ply:3: 'vertex' announces '-4', expected a count"},
        {"element vertex 4", "element vertex", "m.ply:3: 'vertex' announces '', expected a count"},
        {"vertex 4", "vertex 99999999999999999999999", "m.ply:3: 'vertex' announces 18446744073709551615, more than the file"},
        {"vertex 4", "vertex 4000000000", "m.ply:3: 'vertex' announces 4000000000, more than the file can hold"},
        {"face 2", "face 4000000000", "m.ply:7: 'face' announces 4000000000, more than the file can hold"},
        {"face 2", "face 3", "m.ply:15: the file ends too early"},
        {"vertex 4", "vertex 5", "m.ply:14: a face of 2 vertices"},
        {"element vertex 4\n", "property int a\nelement vertex 4\n", "m.ply:3: 'property' before any 'element'"},
        {"property float y", "property half y", "m.ply:5: unknown type 'half'"},
        {"property float y", "property float", "m.ply:5: 'property' needs a name"},
        {"property float y", "property float w", "m.ply:3: 'vertex' has no x, y, z"},
        {"property float y", "property list uchar float y", "m.ply:3: 'vertex' has no x, y, z"},
        {"property float y", "poperty float y", "m.ply:5: 'poperty' is no word of a PLY header"},
        {"list char int", "list float int", "m.ply:8: the length of a list must be an integer"},
        {"list char int", "list char float", "m.ply:7: vertex_indices must be integers"},
        {"list char int", "int", "m.ply:7: 'face' has no list vertex_indices"},
        {"vertex_indices", "indices", "m.ply:7: 'face' has no list vertex_indices"},
        {"end_header\n", "", "m.ply:9: '0' is no word of a PLY header"},
        {"1 1 0", "1 nan 0", "m.ply:12: vertex 2 is not finite"},
        {"1 1 0", "1 -inf 0", "m.ply:12: vertex 2 is not finite"},
        {"1 1 0", "1 1e39 0", "m.ply:12: vertex 2 is not finite"},
        {"1 1 0", "1 1x 0", "m.ply:12: '1x' is not a number"},
        {"3 0 2 3", "3 0 2 4", "m.ply:15: index 4 is out of range: the file has 4 vertices so far"},
        {"3 0 2 3", "3 0 2 -1", "m.ply:15: index -1 is out of range"},
        {"3 0 2 3", "3 0 2 3.5", "m.ply:15: '3.5' is not an integer"},
        {"3 0 2 3", "3 0 2 99999999999999999999", "m.ply:15: '99999999999999999999' is not an integer"},
        {"3 0 2 3", "3 0 2 +", "m.ply:15: '+' is not an integer"},
        {"3 0 2 3\n", "3 0 2 -", "m.ply:15: '-' is not an integer"},
        {"3 0 2 3", "-3 0 2 3", "m.ply:15: a list of negative length -3"},
        {"3 0 2 3", "2 0 2", "m.ply:15: a face of 2 vertices, expected 3 to 10000"},
        {"3 0 2 3", "1000000 0 2", "m.ply:15: a list announces 1000000, more than the file can hold"},
    };
    ASSERT_EQ(refusal(kQuad), "accepted");
    for (const auto& c : cases) {
        std::string text = kQuad;
        text.replace(text.find(c.from), c.from.size(), c.to);
        const std::string message = refusal(text);
        EXPECT_EQ(message.substr(0, c.expected.size()), c.expected) << "for " << c.to;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
}

TEST(PlyErrors, ABrokenBinaryIsRefusedWithItsByte) {
    const std::string header =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list char int vertex_indices\nend_header\n";
    const auto file = [&](double last, double length, double corner) {
        PlyFile f(header);
        f.add({{"float", 0}, {"float", 0}, {"float", 0}});
        f.add({{"float", 1}, {"float", 0}, {"float", 0}});
        f.add({{"float", 0}, {"float", last}, {"float", 0}});
        f.add({{"char", length}, {"int", 0}, {"int", 1}, {"int", corner}});
        return f;
    };
    for (const bool big : {false, true}) {
        const auto refused = [&](double last, double length, double corner) {
            const std::string bytes = file(last, length, corner).binary(big);
            std::string message = refusal(bytes);
            // Places as counted from the end, so that they can be read here.
            const std::size_t at = message.find("byte ");
            if (at == std::string::npos) return message;
            std::size_t digits = 0;
            const auto place = std::stoul(message.substr(at + 5), &digits);
            return message.substr(0, at + 5) + std::to_string(bytes.size() - place) + message.substr(at + 5 + digits);
        };
        EXPECT_EQ(refused(1, 3, 2), "accepted");
        EXPECT_EQ(refused(1, 3, 3), "m.ply:byte 0: index 3 is out of range: the file has 3 vertices so far");
        EXPECT_EQ(refused(1, 3, -1), "m.ply:byte 0: index -1 is out of range: the file has 3 vertices so far");
        EXPECT_EQ(refused(1, -3, 2), "m.ply:byte 12: a list of negative length -3");
        EXPECT_EQ(refused(1, 4, 2), "m.ply:byte 12: a list announces 4, more than the file can hold");
        EXPECT_EQ(refused(std::numeric_limits<double>::quiet_NaN(), 3, 2), "m.ply:byte 13: vertex 2 is not finite");
    }
}

TEST(PlyErrors, NoCutFileIsAcceptedOrCrashes) {
    for (const std::string& bytes : {arrow().text(), arrow().binary(false), arrow().binary(true)}) {
        // A text may lose its last line break, and the last number a digit.
        for (std::size_t size = 0; size + 2 < bytes.size(); ++size) {
            const std::string message = refusal(bytes.substr(0, size));
            EXPECT_EQ(message.substr(0, 6), "m.ply:") << size;
            EXPECT_EQ(message.find('\n'), std::string::npos);
        }
    }
}

TEST(PlyErrors, AnyByteMayBeWrong) {
    for (const std::string& bytes : {arrow().text(), arrow().binary(false)}) {
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            for (const char wrong : {'\0', '\xff', '9', '-', ' ', '\n'}) {
                std::string damaged = bytes;
                damaged[i] = wrong;
                (void)refusal(damaged);  // accepted or not, but by an exception that says so
            }
        }
    }
}

TEST(PlyErrors, AHeaderWithoutEndIsNotReadForever) {
    const std::string endless = "ply\nformat ascii 1.0\n" + std::string(std::size_t{1} << 21, '\n');
    EXPECT_NE(refusal(endless).find("the header is longer than 1 MiB"), std::string::npos);
    std::string wide = "ply\nformat ascii 1.0\nelement a 1\n";
    for (int i = 0; i < 2000; ++i) wide += "property int a\n";
    EXPECT_NE(refusal(wide).find("more than 1000 properties"), std::string::npos);
    // A record of nothing, as often as one likes.
    std::string empty = kQuad;
    empty.replace(empty.find("element vertex"), 0, "element nothing 18446744073709551615\n");
    EXPECT_EQ(refusal(empty), "accepted");
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
