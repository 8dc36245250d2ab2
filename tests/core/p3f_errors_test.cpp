#include <random>

#include "tests/core/p3f_text.h"
#include "tests/core/rich_files.h"

namespace glint {
namespace {

struct BadText {
    const char* name;
    std::string text;
    const char* message;
};

void PrintTo(const BadText& b, std::ostream* out) { *out << b.name; }

class P3fRefused : public testing::TestWithParam<BadText> {};

TEST_P(P3fRefused, NamesTheLineAndTheReason) {
    const std::string message = refusal(GetParam().text);
    EXPECT_EQ(message.find(std::string("t.p3f:") + GetParam().message), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

// The view that follows is fine but for one replaced line; its lines are counted from 1.
std::string view_with(int line, const std::string& replacement) {
    std::string text;
    int at = 0;
    for (const char* each :
         {"v", "from 0 0 5", "at 0 0 0", "up 0 1 0", "angle 45", "hither 1", "resolution 64 64", "aperture 0", "focal 1"}) {
        ++at;
        text += (at == line ? replacement : each) + std::string("\n");
    }
    return text + "l 1 1 1\ns 0 0 0 1\n";
}

const std::string kZeroByte("s 0 0 0 1\nxy\0z", 14);

INSTANTIATE_TEST_SUITE_P(Files, P3fRefused,
                         testing::Values(BadText{"empty", "", "1: the file holds no statement"},
                                         BadText{"blank", "\n\n  # nothing\n", "1: the file holds no statement"},
                                         BadText{"prose", "\nDear Sir,\nall is well.\n",
                                                 "2: not a P3F or NFF file: 'Dear' is no statement"},
                                         BadText{"binary",
                                                 "\x7f"
                                                 "ELF\x02\x01\xff\xfe",
                                                 "1: not a P3F or NFF file: '?ELF"},
                                         BadText{"zero_byte", kZeroByte, "2: not a text file (a zero byte)"}),
                         [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Views, P3fRefused,
    testing::Values(
        BadText{"eye_at_target", view_with(2, "from 0 0 0"), "1: the view has its eye at the point it looks at"},
        BadText{"eye_at_target_in_float", view_with(3, "at 0 1e-300 5"), "1: the view has its eye at"},
        BadText{"no_eye", view_with(2, ""), "1: the view has no 'from'"},
        BadText{"no_target", view_with(3, ""), "1: the view has no 'at'"},
        BadText{"far_eye", view_with(2, "from 1e30 0 0"), "1: the view lies too far out"},
        BadText{"angle_zero", view_with(5, "angle 0"), "5: angle 0 is out of range"},
        BadText{"angle_flat", view_with(5, "angle 180"), "5: angle 180 is out of range"},
        BadText{"angle_nan", view_with(5, "angle nan"), "5: 'nan' is not a finite number"},
        BadText{"resolution_zero", view_with(7, "resolution 0 64"), "7: resolution 0 x 64 is out of range"},
        BadText{"resolution_negative", view_with(7, "resolution 64 -1"), "7: resolution 64 x -1 is out of range"},
        BadText{"resolution_wide", view_with(7, "resolution 65536 1"), "7: resolution 65536 x 1 is out of range"},
        BadText{"resolution_huge", view_with(7, "resolution 60000 60000"), "7: resolution 60000 x 60000 is out"},
        BadText{"resolution_half", view_with(7, "resolution 64.5 64"), "7: 'resolution' needs a whole number, found 64.5"},
        BadText{"resolution_one", view_with(7, "resolution 64"), "7: 'resolution' needs 1 number, found 0 before 'aperture'"},
        BadText{"aperture_negative", view_with(8, "aperture -1"), "8: aperture -1 is negative"},
        BadText{"focal_zero", view_with(8, "aperture 5 focal 0") + "focal 0", "1: focal 0 is not above 0"},
        BadText{"up_short", view_with(4, "up 0 1"), "4: 'up' needs 3 numbers, found 2 before 'angle'"},
        BadText{"up_nothing", view_with(4, "up"), "4: 'up' needs 3 numbers, found 0 before 'angle'"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Statements, P3fRefused,
    testing::Values(BadText{"sphere_short", "s 0 0 0\n", "1: 's' needs 4 numbers, found 3 before the end of the file"},
                    BadText{"sphere_cut", "s 0 0 0\ns 0 0 0 1", "1: 's' needs 4 numbers, found 3 before 's'"},
                    BadText{"sphere_word", "\ns 0 0 zero 1", "2: 's' needs 4 numbers, found 2 before 'zero'"},
                    BadText{"sphere_nan", "\n\ns 0\n0 nan 1", "4: 'nan' is not a finite number"},
                    BadText{"sphere_infinite", "s 0 0 inf 1", "1: 'inf' is not a finite number"},
                    BadText{"sphere_overflow", "s 0 0 1e999 1", "1: '1e999' is not a finite number"},
                    BadText{"sphere_beyond_float", "s 0 0 1e39 1", "1: '1e39' is too large"},
                    BadText{"comma", "s 0,5 0 0 1", "1: 's' needs 4 numbers, found 0 before '0,5'"},
                    BadText{"hexadecimal", "s 0x10 0 0 1", "1: 's' needs 4 numbers, found 0 before '0x10'"},
                    BadText{"material_nine", "f 1 1 1 1 1 1 1 1 1\ns 0 0 0 1", "1: 'f' needs 8, 11, 12 or 14 numbers, found 9"},
                    BadText{"material_none", "mat\ns 0 0 0 1", "1: 'mat' needs 8, 11, 12 or 14 numbers, found 0"},
                    BadText{"material_bright", "f 1e30 1 1 1e30 1 1 0 1", "1: 'f' is too bright"},
                    BadText{"light_four", "l 1 2 3 4", "1: 'l' needs 3 or 6 numbers, found 4"},
                    BadText{"light_far", "l 1e30 2 3", "1: 'l' lies too far out"},
                    BadText{"quad_short", "light quad 1 2 3 1 1 1", "1: 'light quad' needs 13 numbers, found 6"},
                    BadText{"area_light_nowhere", "al 0 0 0 0 0 0 1 1 1 1 1", "1: 'al' faces nowhere"},
                    BadText{"box_short", "box 0 0 0 1 1", "1: 'box' needs 6 numbers, found 5"},
                    BadText{"plane_short", "pl 0 0 0 1 1 1 2 2", "1: 'pl' needs 9 numbers, found 8"},
                    BadText{"cone_short", "c 0 0 0 1\n", "1: 'c' needs 8 numbers, found 4"},
                    BadText{"moving_eight", "ms 0 0 0 1 1 1 1 1", "1: 'ms' needs 7 or 9 numbers, found 8"},
                    BadText{"samples_negative", "spp -1", "1: spp -1 is out of range"},
                    BadText{"samples_huge", "spp 1e12", "1: spp 1000000000000 is out of range"},
                    BadText{"accelerator_missing", "accel", "1: 'accel' needs none, grid, bvh"},
                    BadText{"environment_unnamed", "env\ns 0 0 0 1", "1: 'env' needs a name"},
                    BadText{"mesh_include_unnamed", "ply\n", "1: 'ply' needs a name"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Polygons, P3fRefused,
    testing::Values(
        BadText{"two_corners", "p 2 0 0 0 1 1 1", "1: 'p' needs at least 3 vertices, found 2"},
        BadText{"negative_corners", "p -3 0 0 0 1 1 1 2 2 2", "1: 'p' announces -3"},
        BadText{"half_a_corner", "p 3.5 0 0 0 1 1 1 2 2 2", "1: 'p' needs a whole number, found 3.5"},
        BadText{"cut_polygon", "p 3 0.0 0.0 0.0 1.0 1.0 1.0\n2.0 2.0", "2: a vertex of 'p' needs 3 numbers, found 2 before"},
        BadText{"endless_polygon", "p 1000000000000 0 0 0", "1: 'p' announces 1000000000000, more than the file can hold"},
        BadText{"cut_patch", "pp 3 0 0 0 0 0 1 0 0 0 1\n\n", "1: 'pp' needs 18 numbers, or 9 without normals, found 10"},
        BadText{"index_zero", "mesh 3 1 0 0 0 1 0 0 0 1 0\n0 1 2", "2: index 0 is out of range: the mesh has 3 vertices"},
        BadText{"index_high", "mesh 3 1 0 0 0 1 0 0 0 1 0\n1 2 4", "2: index 4 is out of range"},
        BadText{"index_low", "mesh 3 1 0 0 0 1 0 0 0 1 0\n1 2 -4", "2: index -4 is out of range"},
        BadText{"index_half", "mesh 3 1 0 0 0 1 0 0 0 1 0\n1 2 2.5", "2: an index of 'mesh' needs a whole number, found 2.5"},
        BadText{"cut_mesh", "mesh 3 1\n0 0 0\n1 0 0\n0 1 ", "4: a vertex of 'mesh' needs 3 numbers, found 2 before"},
        BadText{"mesh_without_faces", "mesh 3 1\n0 0 0 1 0 0 0 1 0\ns 0 0 0 1", "2: an index of 'mesh' needs 1 number, found 0"},
        BadText{"endless_vertices", "mesh 1000000000000 1 0 0 0", "1: 'mesh' vertices announces 1000000000000, more than"},
        BadText{"endless_faces", "mesh 1 1e15 0 0 0", "1: 'mesh' faces announces 1000000000000000, more than"},
        BadText{"uncountable", "mesh 1e300 1 0 0 0", "1: '1e300' is too large"}),
    [](const auto& test) { return std::string(test.param.name); });

struct Warned {
    const char* name;
    std::string text;
    const char* warning;
};

void PrintTo(const Warned& w, std::ostream* out) { *out << w.name; }

class P3fWarned : public testing::TestWithParam<Warned> {};

TEST_P(P3fWarned, SaysWhatItDidInstead) {
    const auto scene = read_text(GetParam().text);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0].find(std::string("t.p3f") + GetParam().warning), 0u) << scene->warnings[0];
    EXPECT_EQ(scene->cameras.size(), 1u);
    EXPECT_FALSE(scene->materials.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Odd, P3fWarned,
    testing::Values(
        Warned{"no_shape", "v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 resolution 8 8 l 1 1 1", ": no shape"},
        Warned{"no_light", "v from 0 0 5 at 0 0 0 up 0 1 0 angle 45 resolution 8 8 s 0 0 0 1", ": no light"},
        Warned{"up_along_view", view_with(4, "up 0 0 3"), ":1: 'up' runs along the view"},
        Warned{"up_zero", view_with(4, "up 0 0 0"), ":1: 'up' runs along the view"},
        Warned{"no_up", view_with(4, ""), ":1: the view has no 'up'"},
        Warned{"no_angle", view_with(5, ""), ":1: the view has no 'angle', 45 is used"},
        Warned{"no_resolution", view_with(7, ""), ":1: the view has no 'resolution', 512 512 is used"},
        Warned{"glass_without_ior", view_with(0, "") + "f 1 1 1 1 1 1 1 1 10 1 0\ns 0 0 0 1", ":12: 'f' lets light through"},
        Warned{"negative_colour", view_with(0, "") + "f 1 -1 1 1 1 1 1 1 10 0 0", ":12: 'f': negative numbers are taken as 0"},
        Warned{"negative_light", view_with(0, "") + "l 1 1 1 1 1 -1", ":12: 'l': a negative colour is taken as 0"},
        Warned{"negative_background", view_with(0, "") + "bclr 0 -1 0", ":12: a negative background colour is taken as 0"},
        Warned{"unknown_accelerator", view_with(0, "") + "accel 7", ":12: unknown accelerator '7', skipped"},
        Warned{"unknown_light", view_with(0, "") + "light sphere 1 2 3 4\ns 0 0 0 1", ":12: unknown light 'sphere', skipped"},
        Warned{"no_samples", view_with(0, "") + "spp 0", ":12: spp 0 asks for one centred sample"},
        Warned{"sky_box_missing", view_with(0, "") + "env no/such/folder", ":12: env 'no/such/folder': no such folder"},
        Warned{"material_of_fifteen", view_with(0, "") + "f 1 1 1 1 1 1 1 1 10 0 0 1 1 1 9",
               ":12: unexpected number '9', skipped"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(P3fMutations, NeverDoWorseThanASceneError) {
    std::mt19937 random(20240607);
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
    const std::string alphabet = "0123456789+-.eE #\n\r\t nainfvspmbxl\x01\x80\xff";
    int accepted = 0;
    for (int round = 0; round < 6000; ++round) {
        // Without the last line every second text would end at a missing file.
        std::string text(
            test::kEveryStatement.substr(0, round % 2 == 0 ? test::kEveryStatement.size() : test::kEveryStatement.rfind("ply")));
        for (std::size_t change = 1 + below(4); change > 0; --change) {
            const std::size_t at = below(text.size());
            switch (below(4)) {
                case 0: text.replace(at, 1, 1, alphabet[below(alphabet.size())]); break;
                case 1: text.erase(at, 1 + below(20)); break;
                case 2: text.insert(at, 1 + below(3), alphabet[below(alphabet.size())]); break;
                default: text.resize(at + 1); break;
            }
        }
        try {
            const auto scene = read_text(text);
            ASSERT_LE(scene->warnings.size(), 21u);
            ASSERT_FALSE(scene->cameras.empty());
            for (const auto& t : scene->geometry->triangles) {
                for (const std::uint32_t i : t) ASSERT_LT(i, scene->geometry->vertices.size());
            }
            ++accepted;
        } catch (const SceneError& e) {
            ASSERT_EQ(std::string_view(e.what()).find("t.p3f:"), 0u) << e.what();
        }
    }
    EXPECT_GT(accepted, 100);
}

}  // namespace
}  // namespace glint
