// The built-in scenes: equal to the course's files to the printed digits, and checks that need no file.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/mountain.h"
#include "core/scene_io.h"
#include "core/sphereflake.h"

namespace glint {
namespace {

// Half a unit of the sixth digit, which is as far as the files print, and the rounding of two floats.
// Heights of 1e-16 and their like are rounding noise of whoever computed them.
double printed_tolerance(double value) {
    const double magnitude = std::max(std::abs(value), 1e-9);
    return 0.5000001 * std::pow(10.0, std::floor(std::log10(magnitude)) - 5.0) + 2.4e-7 * magnitude + 1e-12;
}

void expect_printed(glm::vec3 made, glm::vec3 printed, const std::string& what) {
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        const double expected = static_cast<double>(printed[axis]);
        ASSERT_NEAR(static_cast<double>(made[axis]), expected, printed_tolerance(expected)) << what << ", axis " << axis;
    }
}

void expect_printed(const Sphere& made, const Sphere& printed, const std::string& what) {
    expect_printed(made.center, printed.center, what);
    const double radius = static_cast<double>(printed.radius);
    ASSERT_NEAR(static_cast<double>(made.radius), radius, printed_tolerance(radius)) << what;
}

// Only what can be seen: the exponent of a highlight of no strength and the index of an opaque rock do not count.
Material seen(Material m) {
    if (!m.has_mirror()) m.mirror = glm::vec3(0.0f);
    if (!m.has_highlight()) m.shininess = m.highlight_scale = 1.0f;
    if (!m.glass) {
        m.ior = 1.0f;
        m.transmittance = glm::vec3(1.0f);
    }
    return m;
}

void expect_same_geometry(const Scene& made, const Scene& read) {
    const Geometry &a = *made.geometry, &b = *read.geometry;
    ASSERT_EQ(a.spheres.size(), b.spheres.size());
    for (std::size_t i = 0; i < a.spheres.size(); ++i) expect_printed(a.spheres[i], b.spheres[i], "sphere " + std::to_string(i));
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (std::size_t i = 0; i < a.triangles.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            expect_printed(a.vertices[a.triangles[i][corner]], b.vertices[b.triangles[i][corner]],
                           "triangle " + std::to_string(i));
        }
    }
    ASSERT_EQ(a.boxes.size(), b.boxes.size());
    for (std::size_t i = 0; i < a.boxes.size(); ++i) {
        expect_printed(a.boxes[i].lo, b.boxes[i].lo, "box");
        expect_printed(a.boxes[i].hi, b.boxes[i].hi, "box");
    }
    EXPECT_EQ(a.cones.size() + a.planes.size(), b.cones.size() + b.planes.size());
}

void expect_same_camera(const CameraPose& made, const CameraPose& read) {
    EXPECT_EQ(made.eye, read.eye);
    EXPECT_EQ(made.target, read.target);
    EXPECT_EQ(made.up, read.up);
    EXPECT_EQ(made.view_angle, read.view_angle);
    EXPECT_FLOAT_EQ(made.lens_radius, read.lens_radius);
    // Without a lens the focus is nowhere to be seen.
    const bool lens = made.lens_radius > 0.0f;
    EXPECT_FLOAT_EQ(lens ? made.focus_distance : 0.0f, lens ? read.focus_distance : 0.0f);
}

struct Pair {
    const char *spec, *file;
};

class BuiltinAndCourseFile : public testing::TestWithParam<Pair> {};

TEST_P(BuiltinAndCourseFile, AreEqualToThePrintedDigitsInTheSameOrder) {
    const auto path = std::filesystem::path(GLINT_SHARED) / "scenes" / "p3f" / GetParam().file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const auto made = load_scene(GetParam().spec);
    const auto read = load_scene(path.string(), {.load_environment = false, .environment = {}});
    expect_same_geometry(*made, *read);
    if (HasFatalFailure()) return;
    for (const PrimitiveId id : made->geometry->bounded_ids()) {
        // One of each material is enough to look at.
        if (index_of(id) > 8) continue;
        EXPECT_EQ(seen(made->material(id)), seen(read->material(id))) << "primitive " << id;
    }
    ASSERT_EQ(made->lights.size(), read->lights.size());
    for (std::size_t i = 0; i < made->lights.size(); ++i) EXPECT_EQ(made->lights[i], read->lights[i]) << "light " << i;
    expect_same_camera(made->cameras.front(), read->cameras.front());
    EXPECT_EQ(made->width, read->width);
    EXPECT_EQ(made->height, read->height);
    EXPECT_EQ(made->transfer, read->transfer);
    EXPECT_EQ(made->environment.color, read->environment.color);
}

INSTANTIATE_TEST_SUITE_P(
    All, BuiltinAndCourseFile,
    testing::Values(Pair{"builtin:balls,level=1", "balls_low.p3f"}, Pair{"builtin:balls,level=2", "balls_medium.p3f"},
                    Pair{"builtin:balls,level=4", "balls_high.p3f"}, Pair{"builtin:mount,level=1", "mount_low.p3f"},
                    Pair{"builtin:mount,level=5", "mount_high.p3f"}, Pair{"builtin:mount,level=7", "mount_very_high.p3f"},
                    Pair{"builtin:balls_box", "balls_box.p3f"}, Pair{"builtin:dof", "dof.p3f"}),
    [](const auto& course) {
        const std::string file = course.param.file;
        return file.substr(0, file.find('.'));
    });

TEST(Sphereflake, HasTheTenPrintedBallsAtLevelOne) {
    const std::vector<Sphere> expected{
        {{0.0f, 0.0f, 0.0f}, 0.5f},
        {{0.272166f, 0.272166f, 0.544331f}, 0.166667f},
        {{0.643951f, 0.172546f, 0.0f}, 0.166667f},
        {{0.172546f, 0.643951f, 0.0f}, 0.166667f},
        {{-0.371785f, 0.0996195f, 0.544331f}, 0.166667f},
        {{-0.471405f, 0.471405f, 0.0f}, 0.166667f},
        {{-0.643951f, -0.172546f, 0.0f}, 0.166667f},
        {{0.0996195f, -0.371785f, 0.544331f}, 0.166667f},
        {{-0.172546f, -0.643951f, 0.0f}, 0.166667f},
        {{0.471405f, -0.471405f, 0.0f}, 0.166667f},
    };
    const std::vector<Sphere> made = sphereflake(1);
    ASSERT_EQ(made.size(), expected.size());
    for (std::size_t i = 0; i < made.size(); ++i) expect_printed(made[i], expected[i], "sphere " + std::to_string(i));
}

TEST(Sphereflake, HasNineTimesAsManyNewBallsAtEachLevel) {
    std::size_t expected = 1;
    for (int level = 0; level <= kMaxSphereflakeLevel; ++level) {
        EXPECT_EQ(sphereflake(level).size(), expected) << level;
        expected = 9 * expected + 1;
    }
}

TEST(Sphereflake, StaysInsideTheUnitSphereAndEachChildTouchesItsParent) {
    const std::vector<Sphere> flake = sphereflake(3);
    for (const Sphere& s : flake) EXPECT_LE(glm::length(s.center) + s.radius, 1.0f + 1e-6f);
    // Depth first: the children of the first ball are one subtree of 91 balls apart.
    for (std::size_t child = 1; child < flake.size(); child += 91) {
        EXPECT_NEAR(glm::length(flake[child].center - flake[0].center), flake[child].radius + flake[0].radius, 1e-6f);
    }
}

TEST(Mountain, HasThePrintedHeightsAtLevelOne) {
    const Mountain m = fractal_mountain(1);
    const std::array<float, 9> heights{0.0f, -0.5481f, 0.0f, -0.314742f, 0.529551f, 0.657244f, 0.0f, -0.00294902f, 0.0f};
    ASSERT_EQ(m.vertices.size(), heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const glm::vec3 printed(static_cast<float>(i % 3) - 1.0f, static_cast<float>(i / 3) - 1.0f, heights[i]);
        expect_printed(m.vertices[i], printed, "vertex " + std::to_string(i));
    }
    ASSERT_EQ(m.triangles.size(), 8u);
    EXPECT_EQ(m.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 4}));
    EXPECT_EQ(m.triangles[7], (std::array<std::uint32_t, 3>{7, 6, 3}));
}

TEST(Mountain, FacesUpEverywhereAndCoversItsSquareAtEveryLevel) {
    for (int level = 1; level <= kMaxMountainLevel; ++level) {
        const Mountain m = fractal_mountain(level);
        const std::size_t side = (std::size_t{1} << level) + 1;
        EXPECT_EQ(m.vertices.size(), side * side);
        EXPECT_EQ(m.triangles.size(), 2 * (side - 1) * (side - 1));
        double area = 0.0;
        bool up = true;
        for (const auto& t : m.triangles) {
            const glm::vec3 a = m.vertices[t[0]], b = m.vertices[t[1]], c = m.vertices[t[2]];
            const float twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            up = up && twice > 0.0f;
            area += 0.5 * static_cast<double>(twice);
        }
        EXPECT_TRUE(up) << level;
        EXPECT_DOUBLE_EQ(area, 4.0) << level;
    }
}

TEST(Mountain, BallsDoNotTouch) {
    const auto balls = mountain_balls();
    expect_printed(balls[0], {{-0.8f, 0.8f, 1.20821f}, 0.17f}, "top");
    expect_printed(balls[3], {{-0.98961f, 0.749194f, 0.930598f}, 0.167f}, "last");
    for (std::size_t i = 0; i < balls.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_GT(glm::length(balls[i].center - balls[j].center), balls[i].radius + balls[j].radius);
        }
    }
}

void expect_complete(const Scene& scene) {
    for (std::uint32_t kind = 0; kind < kPrimitiveKinds; ++kind) {
        EXPECT_EQ(scene.material_of[kind].size(), scene.geometry->count(static_cast<PrimitiveKind>(kind)));
        for (const std::uint32_t m : scene.material_of[kind]) ASSERT_LT(m, scene.materials.size());
        for (std::size_t i = 0; i < scene.prototypes.size(); ++i) {
            const auto& materials = scene.prototypes[i].material_of[kind];
            EXPECT_EQ(materials.size(), scene.geometry->prototypes[i].geometry->count(static_cast<PrimitiveKind>(kind)));
            for (const std::uint32_t m : materials) ASSERT_LT(m, scene.materials.size());
        }
    }
    EXPECT_EQ(scene.prototypes.size(), scene.geometry->prototypes.size());
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_GT(scene.cameras.front().target_distance(), 0.0f);
    EXPECT_FALSE(scene.lights.empty());
    EXPECT_TRUE(scene.warnings.empty());
    const glm::vec3 size = scene.geometry->bounds().size();
    EXPECT_TRUE(size.x < 1e4f && size.y < 1e4f && size.z < 1e4f);
}

TEST(Builtin, EveryListedSceneIsCompleteAndNamedAfterItsSpec) {
    for (const BuiltinScene& listed : builtin_scenes()) {
        SCOPED_TRACE(listed.name);
        const std::string spec = "builtin:" + std::string(listed.name);
        const auto scene = load_scene(spec);
        EXPECT_EQ(scene->name, spec);
        EXPECT_FALSE(listed.description.empty());
        expect_complete(*scene);
    }
}

TEST(Builtin, EachPieceOfGlassStandsAloneWhenAskedFor) {
    const auto glasses = [](const std::string& what) {
        const auto scene = load_scene("builtin:glass,what=" + what);
        expect_complete(*scene);
        std::vector<float> found;
        for (const PrimitiveId id : scene->geometry->bounded_ids()) {
            if (scene->material(id).glass) found.push_back(scene->material(id).ior);
        }
        return found;
    };
    EXPECT_EQ(glasses("ball"), (std::vector<float>{1.5f}));
    EXPECT_EQ(glasses("slab"), (std::vector<float>{1.5f}));
    EXPECT_EQ(glasses("nested"), (std::vector<float>{1.5f, 1.33f}));
    EXPECT_EQ(glasses("shell"), (std::vector<float>{1.5f, 1.0f}));
    EXPECT_EQ(glasses("all").size(), 6u);
}

TEST(Builtin, LampOfTheCornellBoxIsNotShadowedByItsOwnPanel) {
    const auto scene = load_scene("builtin:cornell");
    const Light& lamp = scene->lights.front();
    EXPECT_LT(glm::cross(lamp.edge1, lamp.edge2).y, 0.0f);
    bool panel = false;
    for (const PrimitiveId id : scene->geometry->bounded_ids()) {
        if (scene->material(id).emission == glm::vec3(0.0f)) continue;
        panel = true;
        EXPECT_GT(scene->geometry->bounds(id).lo.y, lamp.position.y);
    }
    EXPECT_TRUE(panel);
}

TEST(Builtin, BadSpecsAreRefusedInOneLineThatSaysWhatThereIs) {
    const struct {
        const char *spec, *expected;
    } cases[] = {
        {"builtin:ball", "builtin:ball: unknown scene; there are balls, mount, balls_box, dof, cornell, glass"},
        {"builtin:", "unknown scene; there are balls"},
        {"builtin:balls,level=7", "builtin:balls,level=7: bad value '7'; balls takes level=0..6 (4)"},
        {"builtin:balls,level=-1", "bad value '-1'"},
        {"builtin:balls,level=1.5", "bad value '1.5'"},
        {"builtin:balls,level=99999999999999999999", "bad value"},
        {"builtin:balls,level=", "bad value ''"},
        {"builtin:balls,level", "unknown 'level'; balls takes level=0..6"},
        {"builtin:balls,depth=2", "unknown 'depth'"},
        {"builtin:balls,", "unknown ''"},
        {"builtin:balls,level=2,", "unknown ''"},
        {"builtin:mount,level=0", "mount takes level=1..7"},
        {"builtin:mount,level=8", "bad value '8'"},
        {"builtin:dof,level=1", "dof takes no parameters"},
        {"builtin:glass,what=lens", "bad value 'lens'; glass takes what=all|ball|slab|nested|shell"},
    };
    for (const auto& c : cases) {
        try {
            (void)load_scene(c.spec);
            ADD_FAILURE() << c.spec << " was accepted";
        } catch (const SceneError& error) {
            const std::string message = error.what();
            EXPECT_NE(message.find(c.expected), std::string::npos) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
    }
}

}  // namespace
}  // namespace glint
