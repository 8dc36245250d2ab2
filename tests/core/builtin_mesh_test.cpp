// The built-in meshes: a knot that is closed and the same everywhere, a stadium of the promised proportions, a soup.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "core/scene_io.h"
#include "core/torus_knot.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

// FNV-1a over the bits of the coordinates.
std::uint64_t hash_of(const std::vector<glm::vec3>& vertices) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (const glm::vec3& v : vertices) {
        for (int i = 0; i < 3; ++i) hash = (hash ^ std::bit_cast<std::uint32_t>(v[i])) * 0x100000001b3ull;
    }
    return hash;
}

class Knot : public testing::TestWithParam<int> {};

TEST_P(Knot, HasTheTrianglesAskedForAndEachEdgeOnceInEitherDirection) {
    const KnotMesh mesh = torus_knot(GetParam());
    ASSERT_EQ(mesh.triangles.size(), static_cast<std::size_t>(GetParam() / 2 * 2));
    EXPECT_EQ(mesh.vertices.size() * 2, mesh.triangles.size()) << "Euler: a torus";
    std::vector<std::uint64_t> edges, reversed;
    std::vector<bool> used(mesh.vertices.size());
    for (const auto& t : mesh.triangles) {
        ASSERT_TRUE(valid_triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t from = t[k], to = t[(k + 1) % 3];
            edges.push_back(from << 32 | to);
            reversed.push_back(to << 32 | from);
            used[t[k]] = true;
        }
    }
    std::sort(edges.begin(), edges.end());
    std::sort(reversed.begin(), reversed.end());
    EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
    EXPECT_EQ(edges, reversed);
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Knot, testing::Values(10000, 10001, 99998, 100000, 868870),
                         [](const auto& n) { return std::to_string(n.param); });

TEST(KnotShape, IsTheSameOnEveryMachine) {
    EXPECT_EQ(hash_of(torus_knot(10000).vertices), 0x408155010ed96dfdull);
    EXPECT_EQ(hash_of(torus_knot(868870).vertices), 0x7ce76fd3899c911aull);
}

TEST(KnotShape, IsCentredAHundredAcrossWoundOutwardsAndUneven) {
    const KnotMesh mesh = torus_knot(100000);
    Aabb box;
    for (const glm::vec3& v : mesh.vertices) box.grow(v);
    EXPECT_NEAR(glm::length(box.size()), 100.0f, 1.0f);
    EXPECT_LT(glm::length(0.5f * (box.lo + box.hi)), 1.5f);
    double volume = 0.0;
    std::vector<double> areas;
    for (const auto& t : mesh.triangles) {
        const glm::dvec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
        volume += glm::dot(a, glm::cross(b, c)) / 6.0;
        areas.push_back(0.5 * glm::length(glm::cross(b - a, c - a)));
    }
    EXPECT_GT(volume, 0.0);
    std::sort(areas.begin(), areas.end());
    EXPECT_GT(areas[areas.size() * 95 / 100] / areas[areas.size() * 5 / 100], 4.0);
}

TEST(KnotShape, NoRayLeavesTheTubeUnseen) {
    const KnotMesh mesh = torus_knot(20000);
    auto geometry = std::make_shared<Geometry>();
    geometry->vertices = mesh.vertices;
    geometry->triangles = mesh.triangles;
    const auto accelerator = build_accelerator(AcceleratorKind::bvh, geometry);
    test::Random random(7);
    int lost = 0;
    for (int i = 0; i < 10000; ++i) {
        const double u = random.uniform(0.0, 2.0 * test::kPi), r = 2.0 + std::cos(3.0 * u);
        const glm::dvec3 center(r * std::cos(2.0 * u), r * std::sin(2.0 * u), std::sin(3.0 * u));
        const Ray ray{glm::vec3(kKnotScale * (center - kKnotCenter)), glm::vec3(random.direction()), kInfinity};
        if (!closest_hit(*accelerator, ray).found()) ++lost;
    }
    EXPECT_EQ(lost, 0);
}

TEST(BuiltinMesh, TheKnotStandsOnItsFloor) {
    const auto scene = load_scene("builtin:knot,n=10000");
    ASSERT_EQ(scene->geometry->triangles.size(), 10002u);
    const auto& v = scene->geometry->vertices;
    const float floor = v.back().y;
    for (std::size_t i = 0; i + 4 < v.size(); ++i) ASSERT_GE(v[i].y, floor);
    EXPECT_EQ(scene->lights.size(), 1u);
    EXPECT_EQ(scene->lights[0].falloff, Light::Falloff::none);
    EXPECT_EQ(load_scene("builtin:knot")->geometry->triangles.size(), 868872u);
}

TEST(BuiltinMesh, TheStadiumIsAThousandTimesItsKnotAndTheCameraStandsByTheKnot) {
    const auto scene = load_scene("builtin:stadium,n=20000");
    const Geometry& g = *scene->geometry;
    ASSERT_EQ(g.triangles.size(), 20002u);
    Aabb knot;
    for (std::uint32_t i = 0; i < 20000; ++i) knot.grow(g.bounds(make_id(PrimitiveKind::triangle, i)));
    const float size = glm::length(knot.size()), field = glm::length(g.bounds().size());
    EXPECT_GT(field / size, 1000.0f);
    EXPECT_LT(field / size, 2000.0f);
    EXPECT_GE(knot.lo.y, 0.0f);
    EXPECT_LT(knot.lo.y, 0.02f) << "it lies on the grass";
    EXPECT_LT(glm::length(knot.hi), 0.02f * field) << "in a corner";
    EXPECT_LT(scene->cameras[0].target_distance(), 3.0f * size);
    EXPECT_FALSE(g.boxes.empty());
    EXPECT_FALSE(g.spheres.empty());
    EXPECT_GT(scene->geometry->bounds().lo.y, -1.0f);
}

TEST(BuiltinMesh, TheSoupFillsItsCubeWithTrianglesOfManySizes) {
    const auto scene = load_scene("builtin:soup,n=5000");
    const Geometry& g = *scene->geometry;
    ASSERT_EQ(g.triangles.size(), 5000u);
    std::vector<double> areas;
    glm::dvec3 lean(0.0);
    for (const auto& t : g.triangles) {
        const glm::dvec3 a(g.vertices[t[0]]), b(g.vertices[t[1]]), c(g.vertices[t[2]]);
        const glm::dvec3 n = glm::cross(b - a, c - a);
        areas.push_back(glm::length(n));
        lean += glm::abs(n / glm::length(n)) / 5000.0;
    }
    std::sort(areas.begin(), areas.end());
    EXPECT_GT(areas[4750] / areas[250], 50.0);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(lean[i], 0.5, 0.03) << "no direction is preferred";
    EXPECT_EQ(hash_of(g.vertices), 3677469160673356189ull) << "the same on every machine";
    EXPECT_EQ(load_scene("builtin:soup,n=1")->geometry->triangles.size(), 1u);
}

TEST(BuiltinMesh, SizesAreChecked) {
    for (const char* spec : {"knot,n=9999", "knot,n=10000001", "knot,n=", "knot,n=1e5", "stadium,n=0", "soup,n=0", "soup,n=-1",
                             "soup,n=10000001", "soup,m=3", "knot,10000"}) {
        EXPECT_THROW((void)load_scene(std::string("builtin:") + spec), SceneError) << spec;
    }
}

}  // namespace
}  // namespace glint
