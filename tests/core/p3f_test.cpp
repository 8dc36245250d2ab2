#include <cmath>

#include "tests/core/p3f_text.h"

namespace glint {
namespace {

const Material& sphere_material(const Scene& scene, std::uint32_t i = 0) {
    return scene.material(make_id(PrimitiveKind::sphere, i));
}

TEST(P3fLexer, CommentsLineEndsAndBreaksInRecordsDoNotMatter) {
    for (const char* end : {"\n", "\r\n", "\r", "\n\n\t "}) {
        const std::string e = end;
        const auto scene = read_body("# Cena com a c\xe3mara" + e + "s 0 2 0" + e + "0.5#main sphere 7 8" + e + "s 1 # x" + e +
                                     "2 3 4" + e + "p 3 0 0 0 1 0 0" + e + e + "0 1 0");
        ASSERT_EQ(scene->geometry->spheres.size(), 2u);
        EXPECT_EQ(scene->geometry->spheres[0].radius, 0.5f);
        EXPECT_EQ(scene->geometry->spheres[1].center, glm::vec3(1, 2, 3));
        EXPECT_EQ(scene->geometry->triangles.size(), 1u);
        EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    }
}

TEST(P3fLexer, NumbersAreWhatStrtodTakes) {
    const auto scene = read_body("s 1.11022e-16 5. .25 +1\ns -.5E+1 1e-400 -0.35 0012\n");
    const auto& s = scene->geometry->spheres;
    EXPECT_EQ(s[0].center, glm::vec3(1.11022e-16f, 5.0f, 0.25f));
    EXPECT_EQ(s[0].radius, 1.0f);
    EXPECT_EQ(s[1].center, glm::vec3(-5.0f, 0.0f, -0.35f));
    EXPECT_EQ(s[1].radius, 12.0f);
}

TEST(P3fLexer, AByteOrderMarkIsSkipped) {
    EXPECT_TRUE(read_text("\xEF\xBB\xBF" + std::string(kPreamble) + "s 0 0 0 1")->warnings.empty());
}

TEST(P3fView, WordsMayComeInAnyOrderAndSpelling) {
    const auto scene = read_text("v resolution 800 600 angle 50 up 0 0 1 at 1 0 0 from 2 3 4 l 1 1 1 1 1 1 s 0 0 0 1");
    const CameraPose& pose = scene->cameras.at(0);
    EXPECT_EQ(pose.eye, glm::vec3(2, 3, 4));
    EXPECT_EQ(pose.target, glm::vec3(1, 0, 0));
    EXPECT_EQ(pose.up, glm::vec3(0, 0, 1));
    EXPECT_EQ(pose.view_angle, 50.0f);
    EXPECT_EQ(pose.lens_radius, 0.0f);
    EXPECT_EQ(pose.focus_distance, 0.0f);
    EXPECT_EQ(scene->width, 800);
    EXPECT_EQ(scene->height, 600);
    EXPECT_EQ(scene->transfer, Transfer::linear);
    EXPECT_EQ(scene->name, "t.p3f");
    EXPECT_EQ(read_text("v\neye 2 3 4\nat 1 0 0\nupp 0 0 1\nangle 50\nhither 0.01\nresolution 8 6\ntime0 0\ntime1 1\n"
                        "l 1 1 1\ns 0 0 0 1")
                  ->cameras.at(0),
              pose);
}

// dof: 12 pixels of a window of 6.0 units on 512 rows.
constexpr std::string_view kLens = " 7.5 4.5 2 at 0 0 0 up 0 1 0 angle 45 hither 1 resolution 512 512 aperture 12 focal 1.5 ";

TEST(P3fView, TheLensIsCountedInPixelsOfTheWindow) {
    const double distance = std::sqrt(7.5 * 7.5 + 4.5 * 4.5 + 2.0 * 2.0);
    const double size = 12.0 * 2.0 * distance * std::tan(3.14159265358979 / 8.0) / 512.0;
    EXPECT_NEAR(size, 0.1742, 5e-5);
    const auto lens = [](const std::string& before, const std::string& after) {
        return read_text(before + std::string(kLens) + "l 1 1 1 s 0 0 0 1 " + after)->cameras.at(0);
    };
    EXPECT_NEAR(lens("v from", "").lens_radius, size, 1e-7);
    EXPECT_NEAR(lens("v from", "").focus_distance, 1.5 * distance, 1e-6);
    EXPECT_NEAR(lens("accel 2 spp 4 v from", "").lens_radius, size, 1e-7);
    // Each mark of the 2025 dialect, also one behind the view, makes it the diameter.
    for (const char* mark : {"mat 1 1 1 1 1 1 1 0 1 0 1", "light punctual 1 1 1 1 1 1", "npl 0 1 0 2", "accel bvh",
                             "light quad 0 0 0 1 1 1 1 0 0 0 1 0 16"}) {
        EXPECT_NEAR(lens("v from", mark).lens_radius, 0.5 * size, 1e-7) << mark;
    }
    EXPECT_NEAR(lens("camera eye", "").lens_radius, 0.5 * size, 1e-7);
    EXPECT_NEAR(lens("v eye", "").lens_radius, 0.5 * size, 1e-7);
}

TEST(P3fView, WithoutOneEverythingIsFramed) {
    const auto scene = read_text("l 1 1 1 s 10 0 0 2 s 14 0 0 2");
    const CameraPose& pose = scene->cameras.at(0);
    EXPECT_NEAR(pose.target.x, 12.0f, 1e-5f);
    EXPECT_GT(pose.target_distance(), 4.0f);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], "t.p3f: no view: everything is framed");
    EXPECT_EQ(read_text("l 1 1 1 pl 0 0 0 1 0 0 0 1 0")->cameras.size(), 1u);
}

TEST(P3fMaterial, ElevenNumbersTellColoursApart) {
    const Material m = sphere_material(*read_body("f 0.5 0.25 1 0.5 1 0.5 0.25 0.5 30 0 0 s 0 0 0 1"));
    EXPECT_EQ(m.diffuse, glm::vec3(0.25f, 0.125f, 0.5f));
    EXPECT_EQ(m.specular, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(m.mirror, m.specular);
    EXPECT_EQ(m.shininess, 30.0f);
    EXPECT_FALSE(m.glass);
    EXPECT_EQ(m.roughness, 0.0f);
    EXPECT_EQ(m.highlight_scale, 1.0f);
    EXPECT_FALSE(sphere_material(*read_body("mat 1 1 1 1 1 1 1 0 30 0 1 s 0 0 0 1")).has_mirror());
}

TEST(P3fMaterial, EightNumbersMeanAWhiteHighlight) {
    const Material m = sphere_material(*read_body("f 0.5 0.25 1 0.5 0.25 30 0 1\ns 0 0 0 1"));
    EXPECT_EQ(m.diffuse, glm::vec3(0.25f, 0.125f, 0.5f));
    EXPECT_EQ(m.specular, glm::vec3(0.25f));
    EXPECT_EQ(m.shininess, 30.0f);
    EXPECT_TRUE(sphere_material(*read_body("f 0.5 0.25 1 0.5 0.25 30 0.9 1.5\ns 0 0 0 1")).glass);
}

TEST(P3fMaterial, TwelveNumbersAddRoughnessFourteenEmission) {
    EXPECT_EQ(sphere_material(*read_body("f 1 1 1 1 1 1 1 1 30 0 1 0.3 s 0 0 0 1")).roughness, 0.3f);
    const Material m = sphere_material(*read_body("f 1 1 1 1 1 1 1 1 30 0 1 4 5 6 s 0 0 0 1"));
    EXPECT_EQ(m.roughness, 0.0f);
    EXPECT_EQ(m.emission, glm::vec3(4, 5, 6));
}

TEST(P3fMaterial, TransmittanceMeansGlassWithoutMirror) {
    const Material m = sphere_material(*read_body("f 1 1 1 0 1 1 1 0.2 20 1 1.35 s 0 0 0 1"));
    EXPECT_TRUE(m.glass);
    EXPECT_EQ(m.ior, 1.35f);
    EXPECT_EQ(m.mirror, glm::vec3(0.0f));
    EXPECT_EQ(m.transmittance, glm::vec3(1.0f));
    EXPECT_EQ(m.specular, glm::vec3(0.2f));
}

TEST(P3fMaterial, AppliesToWhatFollowsAndHasADefault) {
    const auto scene = read_body("s 0 0 0 1 f 1 0 0 1 0 1 0 1 s 1 0 0 1 s 2 0 0 1 f 0 1 0 1 0 1 0 1 s 3 0 0 1 f 0 0 1 1 0 1 0 1");
    EXPECT_EQ(sphere_material(*scene, 0), Material());
    EXPECT_EQ(sphere_material(*scene, 1).diffuse, glm::vec3(1, 0, 0));
    EXPECT_EQ(sphere_material(*scene, 2).diffuse, glm::vec3(1, 0, 0));
    EXPECT_EQ(sphere_material(*scene, 3).diffuse, glm::vec3(0, 1, 0));
    EXPECT_EQ(scene->materials.size(), 3u);
}

TEST(P3fLight, PointsAddUpAndAreWhiteUnlessSaid) {
    const auto scene = read_text("v from 0 0 5 at 0 0 0 l 1 2 3\nl 4 5 6 0.5 0.25 1\nlight punctual 7 8 9 1 0 0 s 0 0 0 1");
    ASSERT_EQ(scene->lights.size(), 3u);
    EXPECT_EQ(scene->lights[0].emission, glm::vec3(1.0f));
    EXPECT_EQ(scene->lights[1].position, glm::vec3(4, 5, 6));
    EXPECT_EQ(scene->lights[1].emission, glm::vec3(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(scene->lights[2].position, glm::vec3(7, 8, 9));
    for (const Light& light : scene->lights) {
        EXPECT_EQ(light.shape, Light::Shape::point);
        EXPECT_EQ(light.falloff, Light::Falloff::none);
    }
}

TEST(P3fLight, AQuadHasItsEdgesFromTheCorner) {
    const Light light = read_body("light quad 1 2 3 0.5 0.5 1 3 2 3 1 2 7 16 s 0 0 0 1")->lights.back();
    EXPECT_EQ(light.shape, Light::Shape::quad);
    EXPECT_EQ(light.falloff, Light::Falloff::none);
    EXPECT_EQ(light.position, glm::vec3(1, 2, 3));
    EXPECT_EQ(light.edge1, glm::vec3(2, 0, 0));
    EXPECT_EQ(light.edge2, glm::vec3(0, 0, 4));
    EXPECT_EQ(light.emission, glm::vec3(0.5f, 0.5f, 1.0f));
    EXPECT_EQ(read_body("light quad 1 2 3 1 1 1 1 2 3 1 2 3 16 s 0 0 0 1")->lights.back().shape, Light::Shape::point);
}

TEST(P3fLight, AnAreaLightIsCentredAndFacesItsDirection) {
    for (const char* facing : {"0 -1 0", "0 2 0", "1 0 0", "0 0 -3", "1 2 3"}) {
        const Light light = read_body(std::string("al 1 2 3 ") + facing + " 2 4 1 1 1 s 0 0 0 1")->lights.back();
        EXPECT_NEAR(glm::length(light.edge1), 2.0f, 1e-6f);
        EXPECT_NEAR(glm::length(light.edge2), 4.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(light.edge1, light.edge2), 0.0f, 1e-6f);
        const glm::vec3 center = light.position + 0.5f * (light.edge1 + light.edge2);
        EXPECT_NEAR(glm::length(center - glm::vec3(1, 2, 3)), 0.0f, 1e-6f);
        glm::vec3 a;
        std::sscanf(facing, "%f %f %f", &a.x, &a.y, &a.z);
        EXPECT_NEAR(glm::dot(glm::cross(light.edge1, light.edge2), glm::normalize(a)), 8.0f, 1e-5f) << facing;
    }
}

TEST(P3fHeader, BackgroundSamplesAndAcceleratorAreKept) {
    const auto scene = read_body("b 0.5 0.25 1 spp 16 accel 1 s 0 0 0 1");
    EXPECT_EQ(scene->environment.color, glm::vec3(0.5f, 0.25f, 1.0f));
    EXPECT_EQ(scene->spp, 16);
    EXPECT_EQ(scene->accelerator, "grid");
    EXPECT_EQ(read_body("accel 0 s 0 0 0 1")->accelerator, "none");
    EXPECT_EQ(read_body("accel 2 s 0 0 0 1")->accelerator, "bvh");
    for (const std::string name : {"none", "grid", "bvh"})
        EXPECT_EQ(read_body("accel " + name + " s 0 0 0 1")->accelerator, name);
    EXPECT_EQ(read_body("bclr 1 0 0 bclr 0 1 0 s 0 0 0 1")->environment.color, glm::vec3(0, 1, 0));
    EXPECT_EQ(read_body("s 0 0 0 1")->spp, 0);
    EXPECT_EQ(read_body("spp 0 s 0 0 0 1")->spp, 1);
}

TEST(P3fSkipped, UnknownWordsAreNamedOnceWithTheirLine) {
    const auto scene =
        read_body("s 0 0 0 1\nRed Carpet at the left\noldplane 1 2 3\n4 5 6\ns 1 0 0 1 9\nWall\nxyz 1 s 2 0 0 1\nup here\n");
    EXPECT_EQ(scene->geometry->spheres.size(), 3u);
    const std::vector<std::string> expected{
        "t.p3f:2: unknown word 'Red', skipped",    "t.p3f:3: unknown word 'oldplane', skipped",
        "t.p3f:5: unexpected number '9', skipped", "t.p3f:6: unknown word 'Wall', skipped",
        "t.p3f:7: unknown word 'xyz', skipped",    "t.p3f:8: unknown word 'up', skipped"};
    EXPECT_EQ(scene->warnings, expected);
}

TEST(P3fSkipped, ManyWarningsAreSummedUp) {
    std::string text = "s 0 0 0 1\n";
    for (int i = 0; i < 1000; ++i) text += "word\n";
    const auto scene = read_body(text);
    ASSERT_EQ(scene->warnings.size(), 21u);
    EXPECT_EQ(scene->warnings.back(), "t.p3f: 980 further warnings");
}

TEST(P3fSkipped, ControlBytesOfAWordAreNotPrinted) {
    const std::string warning = read_body("s 0 0 0 1\n\x1b[31mred\x07\n")->warnings.at(0);
    EXPECT_EQ(warning, "t.p3f:2: unknown word '?[31mred?', skipped");
}

}  // namespace
}  // namespace glint
