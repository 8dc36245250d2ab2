#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tests/core/p3f_text.h"

namespace glint {
namespace {

TEST(P3fShape, SpheresWithTheirRadiusOfEitherSign) {
    const auto scene = read_body("s 1 2 3 4 s 1 2 3 -4");
    for (const Sphere& s : scene->geometry->spheres) {
        EXPECT_EQ(s.center, glm::vec3(1, 2, 3));
        EXPECT_EQ(s.radius, 4.0f);
    }
}

TEST(P3fShape, BoxesWithTheirCornersInAnyOrder) {
    const auto scene = read_body("box -1 -2 -3 1 2 3 aabb 1 -2 3 -1 2 -3 box 0 0 0 1 0 1");
    ASSERT_EQ(scene->geometry->boxes.size(), 3u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(scene->geometry->boxes[i].lo, glm::vec3(-1, -2, -3));
        EXPECT_EQ(scene->geometry->boxes[i].hi, glm::vec3(1, 2, 3));
    }
}

TEST(P3fShape, PlanesByPointsAndByNormal) {
    const auto scene = read_body("pl 12 12 -0.5 -12 12 -0.5 -12 -12 -0.5\nnpl 0 0 2 1");
    ASSERT_EQ(scene->geometry->planes.size(), 2u);
    for (const Plane& p : scene->geometry->planes) {
        EXPECT_EQ(p.normal, glm::dvec3(0, 0, 1));
        EXPECT_EQ(p.offset, 0.5);
    }
}

TEST(P3fShape, ConesWithRadiiOfEitherSignAndOrder) {
    const auto scene = read_body("c 0 0 0 1 0 0 2 0.5\nc 0 0 0 -0.5 0 0 2 -1\nc 0 0 0 1 0 0 2 1\nc 0 0 0 1 0 0 2 0");
    const auto& c = scene->geometry->cones;
    ASSERT_EQ(c.size(), 4u);
    EXPECT_EQ(c[0].apex, glm::vec3(0, 0, 2));
    EXPECT_EQ(c[1].base_radius, 0.5f);
    EXPECT_EQ(c[1].apex_radius, 1.0f);
    EXPECT_TRUE(scene->warnings.empty());
}

TEST(P3fShape, MovingSpheresStandAtTheirFirstPositionWithAWarning) {
    for (const char* text : {"ms 1 2 3 4 5 6 0.5", "ms 1 2 3 4 5 6 0.5 0 1", "ms 1 2 3 4 5 6 0 1 0.5", "sm 1 2 3 4 5 6 0.5 0 1",
                             "ms 1 2 3 4 5 6 0.2 1 0.5"}) {
        const auto scene = read_body(text);
        ASSERT_EQ(scene->geometry->spheres.size(), 1u);
        EXPECT_EQ(scene->geometry->spheres[0].center, glm::vec3(1, 2, 3));
        EXPECT_EQ(scene->geometry->spheres[0].radius, 0.5f) << text;
        ASSERT_EQ(scene->warnings.size(), 1u);
        EXPECT_NE(scene->warnings[0].find("first position"), std::string::npos);
    }
    const auto scene = read_body("a 0 0 0 1 1 1 10\ns 1 2 3 0.5");
    EXPECT_EQ(scene->geometry->spheres.size(), 1u);
    EXPECT_EQ(scene->warnings.at(0), "t.p3f:1: 'a' animates the next sphere, skipped");
}

double area_of(const Geometry& g) {
    double area = 0.0;
    for (const auto& t : g.triangles) {
        const glm::dvec3 a(g.vertices[t[0]]);
        area += 0.5 * glm::length(glm::cross(glm::dvec3(g.vertices[t[1]]) - a, glm::dvec3(g.vertices[t[2]]) - a));
    }
    return area;
}

TEST(P3fPolygon, ATriangleKeepsItsWinding) {
    const auto scene = read_body("p 3 0 0 1 2 0 1 0 2 1");
    ASSERT_EQ(scene->geometry->triangles.size(), 1u);
    EXPECT_EQ(scene->geometry->triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
    EXPECT_EQ(scene->geometry->vertices[1], glm::vec3(2, 0, 1));
    EXPECT_TRUE(scene->normals.empty());
}

TEST(P3fPolygon, AConcaveOneHasTheShoelaceArea) {
    std::string text = "p 144";
    double area = 0.0;
    std::vector<glm::dvec2> outline;
    for (int i = 0; i < 144; ++i) {
        const double phi = 2.0 * std::numbers::pi * i / 144.0;
        const double r = i % 4 < 2 ? 1.0 : 0.8;
        outline.emplace_back(r * std::cos(phi), r * std::sin(phi));
        text += fmt::format("\n{} 0.25 {}", outline.back().x, -outline.back().y);
    }
    for (std::size_t i = 0; i < 144; ++i) {
        const glm::dvec2 a = outline[i];
        const glm::dvec2 b = outline[(i + 1) % 144];
        area += 0.5 * (a.x * b.y - a.y * b.x);
    }
    const auto scene = read_body(text);
    EXPECT_EQ(scene->geometry->triangles.size(), 142u);
    EXPECT_NEAR(area_of(*scene->geometry), area, 1e-6);
    for (const auto& t : scene->geometry->triangles) {
        const auto& v = scene->geometry->vertices;
        EXPECT_GT(glm::cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]).y, 0.0f);
    }
}

TEST(P3fPolygon, PatchesHaveNormalsOrPositionsOnly) {
    const auto smooth = read_body("pp 3\n0 0 0 0 0 2\n1 0 0 1 0 0\n0 1 0 0 0 0\ns 0 0 0 1");
    ASSERT_EQ(smooth->normals.size(), 3u);
    EXPECT_EQ(smooth->normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(smooth->normals[1], glm::vec3(1, 0, 0));
    EXPECT_EQ(smooth->normals[2], glm::vec3(0));
    const auto flat = read_body("pp 3\n0 0 0\n1 0 0\n0 1 0\ns 0 0 0 1");
    EXPECT_EQ(flat->geometry->triangles.size(), 1u);
    EXPECT_TRUE(flat->normals.empty());
    EXPECT_EQ(flat->geometry->spheres.size(), 1u);
    const auto quad = read_body("pp 4 0 0 0 0 0 1 1 0 0 0 0 1 1 1 0 0 0 1 0 1 0 0 0 1 p 3 0 0 1 1 0 1 0 1 1");
    EXPECT_EQ(quad->geometry->triangles.size(), 3u);
    ASSERT_EQ(quad->normals.size(), 7u);
    EXPECT_EQ(quad->normals[6], glm::vec3(0));
}

TEST(P3fMesh, IndicesCountFromOneOrFromTheEnd) {
    const auto scene = read_body("p 3 9 9 9 8 9 9 9 8 9\nmesh 4 2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 2 3\n1 -2 -1\n");
    const Geometry& g = *scene->geometry;
    ASSERT_EQ(g.triangles.size(), 3u);
    EXPECT_EQ(g.triangles[1], (std::array<std::uint32_t, 3>{3, 4, 5}));
    EXPECT_EQ(g.triangles[2], (std::array<std::uint32_t, 3>{3, 5, 6}));
    EXPECT_EQ(g.vertices.size(), 7u);
}

struct Degenerate {
    const char* name;
    const char* text;
    const char* warning;
};

void PrintTo(const Degenerate& d, std::ostream* out) { *out << d.name; }

class P3fDegenerate : public testing::TestWithParam<Degenerate> {};

TEST_P(P3fDegenerate, IsDroppedWithAWarning) {
    const auto scene = read_body(std::string("s 0 0 0 1\n") + GetParam().text);
    EXPECT_EQ(scene->geometry->bounded_count() + scene->geometry->planes.size(), 1u);
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], std::string("t.p3f:2: ") + GetParam().warning);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, P3fDegenerate,
    testing::Values(Degenerate{"sphere", "s 0 0 0 0", "'s' has no size or lies too far out, dropped"},
                    Degenerate{"far_sphere", "s 0 1e20 0 1", "'s' has no size or lies too far out, dropped"},
                    Degenerate{"far_box", "box 0 0 0 1 1 1e30", "'box' lies too far out, dropped"},
                    Degenerate{"collinear_plane", "pl 0 0 0 1 1 1 3 3 3", "'pl' has its three points on a line, dropped"},
                    Degenerate{"plane_without_normal", "npl 0 0 0 1", "'npl' has no normal, dropped"},
                    Degenerate{"cone_without_length", "c 1 1 1 2 1 1 1 1", "'c' has no length or no radius, dropped"},
                    Degenerate{"cone_without_radius", "c 0 0 0 0 0 0 1 0", "'c' has no length or no radius, dropped"},
                    Degenerate{"triangle", "p 3 0 0 0 1 1 1 2 2 2", "'p' has no area, dropped"},
                    Degenerate{"polygon", "p 4 1 1 1 1 1 1 1 1 1 1 1 1", "'p' has no area, dropped"},
                    Degenerate{"patch", "pp 3 0 0 0 0 0 1 0 0 0 0 0 1 0 1 0 0 0 1", "'pp' has no area, dropped"},
                    Degenerate{"mesh", "mesh 3 2 0 0 0 1 0 0 2 0 0 1 2 3 1 1 2", "'mesh': 2 of 2 faces have no area, dropped"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(P3fPolygon, AnOutlineThatCrossesItselfIsTold) {
    const auto scene = read_body("p 4 0 0 0 3 2 0 3 0 0 0 1 0");
    ASSERT_EQ(scene->warnings.size(), 1u);
    EXPECT_EQ(scene->warnings[0], "t.p3f:1: 'p' has an outline that crosses itself");
}

}  // namespace
}  // namespace glint
