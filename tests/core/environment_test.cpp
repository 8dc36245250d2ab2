#include "core/environment.h"

#include <cmath>
#include <limits>

#include "core/image.h"
#include "tests/core/p3f_text.h"

namespace glint {
namespace {

enum Face { right, left, top, bottom, front, back };

CubeFace plain_face(int shade) {
    const auto byte = static_cast<std::uint8_t>(shade);
    return {1, 1, {byte, byte, byte}};
}

// Face i shows the byte i everywhere.
Environment numbered_cube() {
    Environment e;
    e.kind = Environment::Kind::cube;
    for (int i = 0; i < 6; ++i) e.faces[static_cast<std::size_t>(i)] = plain_face(i);
    return e;
}

int face_at(const Environment& e, glm::vec3 d) { return static_cast<int>(std::lround(e.radiance(d).x * 255.99f)); }

TEST(Environment, AColourIsSeenEverywhere) {
    Environment e;
    e.color = {0.1f, 0.2f, 0.3f};
    EXPECT_EQ(e.radiance({1, 2, 3}), e.color);
    EXPECT_EQ(e.radiance({0, -1, 0}), e.color);
}

TEST(Environment, FacesFollowTheCoursesLeftHandedNames) {
    const Environment e = numbered_cube();
    EXPECT_EQ(face_at(e, {1, 0.2f, 0.1f}), left);
    EXPECT_EQ(face_at(e, {-1, 0.2f, 0.1f}), right);
    EXPECT_EQ(face_at(e, {0.2f, 1, 0.1f}), top);
    EXPECT_EQ(face_at(e, {0.2f, -1, 0.1f}), bottom);
    EXPECT_EQ(face_at(e, {0.2f, 0.1f, 1}), front);
    EXPECT_EQ(face_at(e, {0.2f, 0.1f, -1}), back);
}

TEST(Environment, S_ENV_02_EdgesAndCornersBelongToOneFace) {
    const Environment e = numbered_cube();
    EXPECT_EQ(face_at(e, {1, 1, 1}), top);
    EXPECT_EQ(face_at(e, {-1, -1, -1}), bottom);
    EXPECT_EQ(face_at(e, {1, 0, 1}), left);
    EXPECT_EQ(face_at(e, {1, 1, 0}), top);
    EXPECT_EQ(face_at(e, {0, 1, 1}), top);
    const float more = std::nextafter(1.0f, 2.0f);
    EXPECT_EQ(face_at(e, {more, 1, 1}), left);
    EXPECT_EQ(face_at(e, {1, 1, more}), front);
}

TEST(Environment, TheLengthOfADirectionDoesNotMatter) {
    const Environment e = numbered_cube();
    for (const float length : {1e-38f, 1e-20f, 1.0f, 1e20f, 1e38f}) {
        EXPECT_EQ(face_at(e, glm::vec3(0.1f, 0.2f, 1.0f) * length), front);
        Environment sky;
        sky.kind = Environment::Kind::sky;
        const glm::vec3 d(0.3f, 0.5f, 0.1f);
        EXPECT_NEAR(sky.radiance(d * length).x, sky.radiance(d).x, 1e-6f);
    }
}

TEST(Environment, ADirectionWithoutLengthReadsNothingOutside) {
    const Environment e = numbered_cube();
    EXPECT_EQ(face_at(e, glm::vec3(0.0f)), top);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    (void)e.radiance(glm::vec3(nan));
    (void)e.radiance(glm::vec3(std::numeric_limits<float>::infinity()));
}

// Red counts columns from the left, green rows from the bottom.
CubeFace ramp(int width, int height) {
    CubeFace f{width, height, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) f.rgb.insert(f.rgb.end(), {std::uint8_t(x), std::uint8_t(y), 0});
    }
    return f;
}

glm::ivec2 texel_at(const Environment& e, glm::vec3 d) {
    const glm::vec3 c = e.radiance(d) * 255.99f;
    return {std::lround(c.x), std::lround(c.y)};
}

TEST(Environment, ATexelIsTheTruncatedPositionTimesSizeLessOne) {
    Environment e;
    e.kind = Environment::Kind::cube;
    e.faces.fill(ramp(5, 9));
    // front: s from -x, t from y. (5 - 1) * (0.5 + 1) / 2 = 3, and a hair less is 2; (9 - 1) * (0.25 + 1) / 2 = 5.
    EXPECT_EQ(texel_at(e, {-0.5f, 0.25f, 1}), glm::ivec2(3, 5));
    EXPECT_EQ(texel_at(e, {-0.4999f, 0.2499f, 1}), glm::ivec2(2, 4));
    EXPECT_EQ(texel_at(e, {0, 0, 1}), glm::ivec2(2, 4));
    // The last row and column are met at the very edge only: the course's rule.
    EXPECT_EQ(texel_at(e, {-0.9999f, 0.9999f, 1}), glm::ivec2(3, 7));
    EXPECT_EQ(texel_at(e, {0.9999f, -0.9999f, 1}), glm::ivec2(0, 0));
}

TEST(Environment, EachFaceIsTurnedAsTheCourseTurnsIt) {
    Environment e;
    e.kind = Environment::Kind::cube;
    e.faces.fill(ramp(5, 5));
    const float p = 0.5f;
    const float q = -0.5f;
    const auto expect = [&](glm::vec3 d, int s, int t) { EXPECT_EQ(texel_at(e, d), glm::ivec2(s, t)); };
    expect({-1, q, p}, 1, 1);  // right: (-z, y)
    expect({1, q, p}, 3, 1);   // left: (z, y)
    expect({p, 1, q}, 1, 3);   // top: (-x, -z)
    expect({p, -1, q}, 1, 1);  // bottom: (-x, z)
    expect({p, q, 1}, 1, 1);   // front: (-x, y)
    expect({p, q, -1}, 3, 1);  // back: (x, y)
}

// The sides show one panorama from inside: where two meet, the last column of one is beside the first of the other.
TEST(Environment, S_ENV_02_SidesMeetAtTheirEdges) {
    Environment e;
    e.kind = Environment::Kind::cube;
    e.faces.fill(ramp(101, 101));
    const float a = 1.0f;
    const float b = 0.9999f;
    for (const glm::vec2 corner : {glm::vec2(1, 1), glm::vec2(1, -1), glm::vec2(-1, 1), glm::vec2(-1, -1)}) {
        const glm::ivec2 one = texel_at(e, {corner.x * a, 0.3f, corner.y * b});
        const glm::ivec2 other = texel_at(e, {corner.x * b, 0.3f, corner.y * a});
        EXPECT_EQ(one.y, other.y);
        EXPECT_EQ(std::min(one.x, other.x), 0);
        EXPECT_EQ(std::max(one.x, other.x), 99);
    }
}

TEST(Environment, TheSkyIsSmoothFromTheGroundToTheZenith) {
    Environment e;
    e.kind = Environment::Kind::sky;
    EXPECT_EQ(e.radiance({0, 1, 0}), e.zenith);
    EXPECT_EQ(e.radiance({0, -1, 0}), e.ground);
    EXPECT_NEAR(glm::length(e.radiance({1, 0, 0}) - e.horizon), 0.0f, 1e-6f);
    glm::vec3 before = e.radiance({0, -1, 0});
    for (double degrees = -90.0; degrees <= 90.0; degrees += 0.1) {
        const double rad = degrees * 3.14159265358979 / 180.0;
        const glm::vec3 now = e.radiance({static_cast<float>(std::cos(rad)), static_cast<float>(std::sin(rad)), 0.0f});
        EXPECT_LT(glm::length(now - before), 0.1f) << degrees;
        before = now;
    }
}

// Along every direction to a pole, one colour: no seam, and no angle that a rounding pushes out of its range.
TEST(Environment, S_ENV_01_ThePolesHaveOneColourFromEverywhere) {
    Environment e;
    e.kind = Environment::Kind::sky;
    for (const float pole : {1.0f, -1.0f}) {
        const glm::vec3 expected = e.radiance({0, pole, 0});
        for (int i = 0; i < 360; ++i) {
            const double phi = i * 3.14159265358979 / 180.0;
            for (const double off : {1e-30, 1e-10, 1e-7}) {
                const glm::vec3 seen = e.radiance({off * std::cos(phi), pole, off * std::sin(phi)});
                ASSERT_LE(glm::length(seen - expected), 1e-6f) << i << ' ' << off;
            }
            // Round the horizon it is one colour as well: nothing depends on the azimuth.
            const glm::vec3 around = e.radiance({std::cos(phi), 0.2, std::sin(phi)});
            ASSERT_LE(glm::length(around - e.radiance({1, 0.2f, 0})), 1e-6f) << i;
        }
    }
    // A unit vector whose rounded length exceeds 1.
    e.up = glm::vec3(0.57735032f);
    const glm::vec3 over = e.radiance(glm::vec3(1.0f));
    EXPECT_TRUE(std::isfinite(over.x) && std::isfinite(over.y) && std::isfinite(over.z));
    EXPECT_LE(glm::length(over - e.zenith), 1e-6f);
}

// Two smooth faces that agree along their edge: no jump larger than a texel's step, edges and corners included.
TEST(Environment, S_ENV_02_ARampIsContinuousAcrossEdges) {
    Environment e;
    e.kind = Environment::Kind::cube;
    constexpr int kSize = 128;
    // Each texel shows its own direction's height, so all faces are pieces of one function.
    for (int f = 0; f < 6; ++f) {
        CubeFace& face = e.faces[static_cast<std::size_t>(f)];
        face = {kSize, kSize, {}};
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const double s = 2.0 * x / (kSize - 1) - 1.0, t = 2.0 * y / (kSize - 1) - 1.0;
                const double height = f == top ? 1.0 : f == bottom ? -1.0 : t;
                const auto byte = static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * height / std::sqrt(1.0 + s * s + t * t)));
                face.rgb.insert(face.rgb.end(), {byte, byte, byte});
            }
        }
    }
    const auto expect_smooth = [&](glm::dvec3 from, glm::dvec3 to) {
        float before = e.radiance(glm::vec3(from)).x;
        for (int i = 1; i <= 4000; ++i) {
            const float now = e.radiance(glm::vec3(glm::mix(from, to, i / 4000.0))).x;
            ASSERT_LE(std::abs(now - before), 5.0f / 255.0f) << i;
            before = now;
        }
    };
    // Across edges between sides, to the top and to the bottom, and through corners.
    expect_smooth({1, 0.3, 0.2}, {0.2, 0.3, 1}), expect_smooth({-1, -0.7, 0.2}, {0.1, -0.6, -1});
    expect_smooth({1, 0.2, 0.4}, {0.3, 1, 0.1}), expect_smooth({0.1, -0.2, -1}, {0.1, -1, -0.3});
    expect_smooth({1, 0.5, 0.5}, {0.5, 1, 1}), expect_smooth({-1, -0.4, -0.4}, {-0.4, -1, -1});
}

TEST(Environment, TheSunIsADiskAboveTheGround) {
    Environment e;
    e.kind = Environment::Kind::sky;
    e.sun_direction = glm::normalize(glm::vec3(1, 1, 0));
    e.sun = glm::vec3(50.0f);
    e.sun_cos = std::cos(0.02f);
    const auto at = [&](float degrees) {
        const float rad = degrees * 3.14159265f / 180.0f;
        return e.radiance({std::cos(rad), std::sin(rad), 0.0f}).x;
    };
    EXPECT_GT(at(45.0f), 50.0f);
    EXPECT_GT(at(46.0f), 50.0f);
    EXPECT_LT(at(46.3f), 1.0f);
    e.sun_direction = glm::normalize(glm::vec3(1, -1, 0));
    EXPECT_LT(at(-45.0f), 1.0f);
}

TEST(Environment, PicturesAreReadByNameAndTurnedBottomUp) {
    const TestFolder folder;
    write_sky_box(folder, "sky");
    folder.write("sky/front.png", std::string("P6 1 2 255\n") + "\x01\x01\x01" + "\x02\x02\x02");
    Environment e;
    load_cube(e, folder.path() / "sky");
    ASSERT_EQ(e.kind, Environment::Kind::cube);
    EXPECT_EQ(e.faces[front].height, 2);
    EXPECT_EQ(e.faces[front].rgb, (std::vector<std::uint8_t>{2, 2, 2, 1, 1, 1}));
    EXPECT_EQ(face_at(e, {1, 0, 0}), 20);
    EXPECT_EQ(face_at(e, {-1, 0, 0}), 10);
}

std::string cube_refusal(const std::filesystem::path& folder) {
    Environment e;
    e.color = glm::vec3(0.5f);
    try {
        load_cube(e, folder);
    } catch (const SceneError& error) {
        EXPECT_EQ(e.kind, Environment::Kind::color);
        EXPECT_TRUE(e.faces[0].rgb.empty());
        return error.what();
    }
    return "accepted";
}

TEST(Environment, AMissingBrokenOrHugePictureIsNamed) {
    const TestFolder folder;
    EXPECT_NE(cube_refusal(folder.path() / "none").find("none: no such folder"), std::string::npos);
    write_sky_box(folder, "sky");
    const auto sky = folder.path() / "sky";
    std::filesystem::remove(sky / "bottom.png");
    EXPECT_NE(cube_refusal(sky).find("bottom.jpg: sky box picture is missing"), std::string::npos);
    folder.write("sky/bottom.png", "this is no picture");
    EXPECT_NE(cube_refusal(sky).find("bottom.png: cannot read the picture"), std::string::npos);
    // Claimed, not there: refused by the header, before anything of that size is allocated.
    folder.write("sky/bottom.png", "P6 16000 16000 255\n");
    EXPECT_NE(cube_refusal(sky).find("bottom.png: 16000 x 16000 pixels are too many"), std::string::npos);
    folder.write("sky/bottom.png", "P6 8000 8000 255\n");
    EXPECT_NE(cube_refusal(sky).find("bottom.png: the file is too short for 8000 x 8000 pixels"), std::string::npos);
    std::string png = encode_png({1, 1, {7, 7, 7}}, Transfer::srgb);
    png[png.find("IDAT") - 4] = '\x3f';
    folder.write("sky/bottom.png", png);
    EXPECT_NE(cube_refusal(sky).find("bottom.png: the file is too short for 1 x 1 pixels"), std::string::npos);
    std::filesystem::remove(sky / "bottom.png");
    std::filesystem::create_directory(sky / "bottom.png");
    EXPECT_NE(cube_refusal(sky).find("missing"), std::string::npos);
}

}  // namespace
}  // namespace glint
