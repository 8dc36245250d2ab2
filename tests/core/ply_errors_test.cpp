// Broken PLY files: refused in one line that names the place, quickly, and never by a crash.
#include <limits>
#include <string>

#include "core/ply.h"
#include "core/scene.h"
#include "tests/core/ply_file.h"

namespace glint {
namespace {

using test::arrow;
using test::kQuad;
using test::PlyFile;

std::string refusal(const std::string& bytes) {
    try {
        (void)read_ply(bytes, "m.ply");
    } catch (const SceneError& e) {
        return e.what();
    }
    return "accepted";
}

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

}  // namespace
}  // namespace glint
