#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/hit_report.h"
#include "tests/long.h"

namespace glint {
namespace {

struct Triangle {
    glm::vec3 a, b, c;
};

bool hits(const Ray& ray, const Triangle& triangle, TriangleHit& hit) {
    Aabb box;
    for (const glm::vec3 p : {triangle.a, triangle.b, triangle.c}) box.grow(p);
    const PreparedRay prepared(ray, box.magnitude());
    return prepared.usable && intersect_triangle(prepared, triangle.a, triangle.b, triangle.c, ray.t_max, hit);
}
bool hits(const Ray& ray, const Triangle& triangle) {
    TriangleHit hit{};
    return hits(ray, triangle, hit);
}

const Ray kForward{glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};

TEST(Triangle, S_TRI_01_APointIsMissed) {
    const glm::vec3 p(0.0f, 0.0f, 5.0f);
    EXPECT_FALSE(hits(kForward, {p, p, p}));
    EXPECT_FALSE(valid_triangle(p, p, p));
}

TEST(Triangle, S_TRI_02_ALineIsMissed) {
    const Triangle line{glm::vec3(-1.0f, 0.0f, 5.0f), glm::vec3(0.0f, 0.0f, 5.0f), glm::vec3(1.0f, 0.0f, 5.0f)};
    EXPECT_FALSE(hits(kForward, line));
    EXPECT_FALSE(valid_triangle(line.a, line.b, line.c));
}

TEST(Triangle, S_TRI_03_ARayInThePlaneMissesAndDoesNotOcclude) {
    auto geometry = std::make_shared<Geometry>();
    add_triangle(*geometry, glm::vec3(-1.0f, 0.0f, 2.0f), glm::vec3(1.0f, 0.0f, 2.0f), glm::vec3(0.0f, 0.0f, 5.0f));
    for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, geometry);
        EXPECT_FALSE(closest_hit(*accelerator, kForward).found());
        EXPECT_FALSE(occluded(*accelerator, kForward));
    }
}

// So many rays that walking the tree or the list for each would take hours.
TEST(Triangle, S_TRI_04_NaNAndInfiniteRaysMissAtOnce) {
    const auto geometry = std::make_shared<const Geometry>(tessellated_ball(glm::dvec3(0.0), 1.0, 200, 100));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, geometry);
        ASSERT_TRUE(closest_hit(*accelerator, kForward).found());
        for (int i = 0; i < 100000; ++i) {
            for (int part = 0; part < 7; ++part) {
                Ray ray{glm::vec3(0.1f, 0.2f, -3.0f), glm::vec3(0.0f, 0.0f, 1.0f), 10.0f};
                const float bad = i % 3 == 0 ? nan : i % 3 == 1 ? kInfinity : -kInfinity;
                if (part < 3) ray.origin[part] = bad;
                if (part >= 3 && part < 6) ray.direction[part - 3] = bad;
                if (part == 6) ray.t_max = i % 3 == 1 ? nan : bad;
                ASSERT_FALSE(closest_hit(*accelerator, ray).found()) << text(ray);
                ASSERT_FALSE(occluded(*accelerator, ray)) << text(ray);
            }
        }
        EXPECT_FALSE(occluded(*accelerator, {glm::vec3(0.0f), glm::vec3(0.0f)})) << "no direction";
        EXPECT_FALSE(occluded(*accelerator, {glm::vec3(0.0f), glm::vec3(1.0f), 0.0f})) << "no length";
        EXPECT_FALSE(occluded(*accelerator, {glm::vec3(0.0f), glm::vec3(1.0f), -1.0f})) << "negative length";
    }
}

TEST(Triangle, S_TRI_05_SizeDoesNotMatter) {
    for (const float s : {1.0f, 2.0e-4f, 1.0e-6f, 1.0e-10f, 1.0e-18f, 1.0e-30f}) {
        TriangleHit hit{};
        const Ray ray{glm::vec3(s / 3.0f, s / 3.0f, -1.0f), glm::vec3(0.0f, 0.0f, 1.0f)};
        ASSERT_TRUE(hits(ray, {glm::vec3(0.0f), glm::vec3(s, 0.0f, 0.0f), glm::vec3(0.0f, s, 0.0f)}, hit)) << s;
        EXPECT_FLOAT_EQ(hit.t, 1.0f) << s;
        EXPECT_FLOAT_EQ(hit.u, 1.0f / 3.0f) << s;
        EXPECT_FLOAT_EQ(hit.v, 1.0f / 3.0f) << s;
    }
}

// From the smallest scene to the largest valid coordinates: everything scales by 2^k, to the bit.
TEST(Triangle, S_TRI_05_ScalingByAPowerOfTwoScalesTAndKeepsTheWeights) {
    Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const Triangle unit{random.in_cube(-0.8f, 0.8f), random.in_cube(-0.8f, 0.8f), random.in_cube(-0.8f, 0.8f)};
        const Ray ray{random.in_cube(-0.8f, 0.8f), random.direction()};
        TriangleHit expected{};
        const bool found = hits(ray, unit, expected);
        for (const int k : {-100, -60, -20, 20, 45, 60}) {
            const float s = std::ldexp(1.0f, k);
            TriangleHit hit{};
            ASSERT_EQ(hits({s * ray.origin, ray.direction}, {s * unit.a, s * unit.b, s * unit.c}, hit), found) << text(ray) << k;
            if (!found) continue;
            ASSERT_EQ(hit.t, s * expected.t) << text(ray) << " k " << k;
            ASSERT_EQ(hit.u, expected.u) << text(ray) << " k " << k;
            ASSERT_EQ(hit.v, expected.v) << text(ray) << " k " << k;
        }
    }
}

TEST(Triangle, S_TRI_06_NoRayLeaksThroughASharedEdge) {
    Random random(6);
    int leaks = 0;
    for (int rays = 0; rays < scale(1000000, 100000000);) {
        const glm::vec3 a(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f), random.uniform(5.0f, 5.1f));
        const glm::vec3 b(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f), random.uniform(5.0f, 5.1f));
        if (glm::length(b - a) < 0.5f) continue;
        ++rays;
        const glm::vec3 across(a.y - b.y, b.x - a.x, 0.0f);
        glm::vec3 c = a - across, d = a + across;
        c.z = random.uniform(5.0f, 5.1f);
        d.z = random.uniform(5.0f, 5.1f);
        const glm::vec3 origin = random.in_cube(-0.5f, 0.5f), target = a + random.uniform(0.01f, 0.99f) * (b - a);
        const Ray ray{origin, glm::normalize(target - origin)};
        if (!hits(ray, {a, b, c}) && !hits(ray, {b, a, d})) {
            if (leaks++ == 0) ADD_FAILURE() << text(ray) << text(a) << text(b) << text(c) << text(d);
        }
    }
    EXPECT_EQ(leaks, 0);
}

TEST(Triangle, S_TRI_07_NoRayLeaksThroughASharedVertex) {
    Random random(7);
    int leaks = 0;
    for (int i = 0; i < scale(1000000, 100000000); ++i) {
        const glm::vec3 center(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f), random.uniform(5.0f, 5.1f));
        glm::vec3 rim[6];
        const double turn = random.uniform();
        for (int k = 0; k < 6; ++k) {
            const double phi = 6.283185307179586 * (k + turn) / 6.0;
            rim[k] = center + 0.5f * glm::vec3(std::cos(phi), std::sin(phi), 0.0);
            rim[k].z = random.uniform(5.0f, 5.1f);
        }
        const glm::vec3 origin = random.in_cube(-0.5f, 0.5f);
        const Ray ray{origin, glm::normalize(center - origin)};
        bool hit = false;
        for (int k = 0; k < 6 && !hit; ++k) hit = hits(ray, {center, rim[k], rim[(k + 1) % 6]});
        if (!hit && leaks++ == 0) ADD_FAILURE() << text(ray) << text(center);
    }
    EXPECT_EQ(leaks, 0);
}

// The geometry of Mitsuba's test of Embree's robust flag: 1024 rays to one point of the edge that two triangles share.
TEST(Triangle, S_TRI_08_EveryOneOf1024RaysToAnEdgeHits) {
    const double third = 1.0 / 3.0, root = std::sqrt(3.0) / 3.0;
    const glm::dmat3 turn(glm::dvec3(third, third + root, third - root), glm::dvec3(third - root, third, third + root),
                          glm::dvec3(third + root, third - root, third));  // by 90 degrees about (1,1,1)
    glm::vec3 v[4];
    for (int i = 0; i < 4; ++i) v[i] = glm::vec3(turn * glm::dvec3(i % 2, i / 2, 0.0));
    const glm::vec3 middle(turn * glm::dvec3(0.5, 0.5, 0.0));
    int count = 0;
    for (int i = 0; i < 1024; ++i) {
        const double x = 0.05 + 0.9 * (i % 32) / 31.0, y = 0.05 + 0.9 * static_cast<double>(i / 32) / 31.0;
        const double radius = std::sqrt(x), phi = 6.283185307179586 * y;
        const glm::vec3 d(turn * glm::dvec3(radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1.0 - x)));
        const Ray ray{middle + d, -d};
        count += hits(ray, {v[0], v[1], v[2]}) || hits(ray, {v[1], v[3], v[2]}) ? 1 : 0;
    }
    EXPECT_EQ(count, 1024);
}

// Vertices lie on a lattice of 1/64 there. On the finer ball facets collapse, and those without an area are no triangles, so a
// vertex may lie within its neighbours' edge: that ball is closed for rays that do not aim there. The coarser one is closed.
TEST(Triangle, S_TRI_09_AClosedMeshFarFromTheOriginHoldsEveryRay) {
    const glm::dvec3 center(148376.0, 1234.0, -223423.0);
    const Geometry fine = tessellated_ball(center, 2.0, 200, 100), coarse = tessellated_ball(center, 2.0, 24, 12);
    ASSERT_EQ(coarse.triangles.size(), 2 * 24 * 11);
    for (const Geometry& ball : {fine, coarse}) {
        const Bvh bvh(std::make_shared<const Geometry>(ball));
        const bool aimed = ball.triangles.size() == coarse.triangles.size();
        Random random(9);
        int misses = 0;
        // So far out the padding of the boxes is half the ball: a ray to the finer one takes 25 microseconds and more.
        for (int i = 0; i < (aimed ? scale(200000, 20000000) : scale(20000, 1000000)); ++i) {
            Ray ray{glm::vec3(center) + random.in_cube(-1.0f, 1.0f), random.direction()};
            if (aimed) {  // at a vertex, at an edge
                const auto& corners = ball.triangles[random.below(ball.triangles.size())];
                const glm::vec3 a = ball.vertices[corners[0]], b = ball.vertices[corners[1]];
                ray.direction = a - ray.origin + (i % 2 == 0 ? 0.0f : random.uniform(0.0f, 1.0f)) * (b - a);
            }
            if (!bvh.closest_hit(ray).found() && misses++ == 0) ADD_FAILURE() << text(ray);
        }
        EXPECT_EQ(misses, 0) << (aimed ? "vertices and edges" : "anywhere");
    }
}

// A needle or a triangle seen edge-on may leave t ill-conditioned, but never outside the triangle's bounds.
TEST(Triangle, S_TRI_12_AHitLiesInTheTrianglesBounds) {
    Random random(12);
    int found = 0;
    for (int i = 0; i < 300000; ++i) {
        const glm::vec3 a = random.in_cube(-1.0f, 1.0f), b = random.in_cube(-1.0f, 1.0f);
        const Triangle needle{a, b, b + random.power_of_ten(-7.0f, -2.0f) * random.direction()};
        const glm::vec3 along = b - a, tilt = random.power_of_ten(-7.0f, 0.0f) * random.direction();
        const glm::vec3 d = along + tilt, target = a + random.uniform(0.0f, 1.0f) * along;
        const Ray ray{target - 2.0f * d, d};
        TriangleHit hit{};
        if (!hits(ray, needle, hit)) continue;
        ++found;
        Aabb box;
        for (const glm::vec3 p : {needle.a, needle.b, needle.c}) box.grow(p);
        const Interval inside = slab_interval(PreparedRay(ray, box.magnitude()), box);
        ASSERT_GE(hit.t, inside.near) << text(ray);
        ASSERT_LE(hit.t, inside.far) << text(ray);
        const glm::dvec3 p = glm::dvec3(ray.origin) + static_cast<double>(hit.t) * glm::dvec3(ray.direction);
        const glm::vec3 from = glm::abs(ray.origin);
        const double padding = 32.0 * 0x1p-24 * static_cast<double>(std::max(from.x, std::max(from.y, from.z)) + box.magnitude());
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(p[k], static_cast<double>(box.lo[k]) - padding) << text(ray);
            ASSERT_LE(p[k], static_cast<double>(box.hi[k]) + padding) << text(ray);
        }
    }
    EXPECT_GT(found, 10000);
}

TEST(Triangle, S_TRI_13_WeightsAndDistanceAgreeWithin16Ulp) {
    constexpr double kTolerance = 16.0 * 0x1p-23;
    const Triangle triangle{glm::vec3(0.0f), glm::vec3(1.0f, 0.0f, 0.0f), glm::vec3(0.0f, 1.0f, 0.0f)};
    Random random(13);
    for (int i = 0; i < 100000; ++i) {
        float u = random.uniform(0.0f, 1.0f), v = random.uniform(0.0f, 1.0f);
        if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
        const glm::dvec3 o(0.0, 0.0, -1.0), d = glm::dvec3(u, v, 0.0) - o;
        const Ray ray{glm::vec3(o), glm::vec3(d)};
        TriangleHit hit{};
        if (!hits(ray, triangle, hit)) continue;  // on an edge, decided by a rounding
        ASSERT_NEAR(hit.u, u, kTolerance) << text(ray);
        ASSERT_NEAR(hit.v, v, kTolerance) << text(ray);
        ASSERT_NEAR(hit.t, 1.0, kTolerance) << text(ray);
        const glm::dvec3 p = o + static_cast<double>(hit.t) * glm::dvec3(ray.direction);
        ASSERT_NEAR(p.x, hit.u, kTolerance) << text(ray);
        ASSERT_NEAR(p.y, hit.v, kTolerance) << text(ray);
        ASSERT_GE(std::min(hit.u, hit.v), 0.0f);
        ASSERT_LE(std::max(hit.u, hit.v), 1.0f);
    }
}

// Coordinates are small integers and the ray runs along z, so that nothing rounds and the truth is known exactly.
TEST(Triangle, S_TRI_14_OrderOfVerticesAndFaceDoNotMatter) {
    Random random(14);
    const auto integer = [&random] { return static_cast<int>(random.below(17)) - 8; };
    int on_edges = 0;
    for (int i = 0; i < 100000; ++i) {
        const int x[3] = {integer(), integer(), integer()}, y[3] = {integer(), integer(), integer()};
        int edge[3];
        for (int k = 0; k < 3; ++k) edge[k] = x[k] * y[(k + 1) % 3] - y[k] * x[(k + 1) % 3];
        const int low = std::min({edge[0], edge[1], edge[2]}), high = std::max({edge[0], edge[1], edge[2]});
        const bool expected = (low >= 0 || high <= 0) && edge[0] + edge[1] + edge[2] != 0;
        on_edges += expected && low * high == 0 ? 1 : 0;
        glm::vec3 v[3];
        for (int k = 0; k < 3; ++k) v[k] = glm::vec3(x[k], y[k], 10 + integer());
        for (const float from : {0.0f, 40.0f}) {  // from either face
            const Ray ray{glm::vec3(0.0f, 0.0f, from), glm::vec3(0.0f, 0.0f, from > 0.0f ? -1.0f : 1.0f)};
            TriangleHit first{};
            for (const auto& order : {glm::ivec3(0, 1, 2), glm::ivec3(1, 2, 0), glm::ivec3(2, 0, 1), glm::ivec3(0, 2, 1),
                                      glm::ivec3(2, 1, 0), glm::ivec3(1, 0, 2)}) {
                TriangleHit hit{};
                ASSERT_EQ(hits(ray, {v[order.x], v[order.y], v[order.z]}, hit), expected)
                    << text(v[0]) << text(v[1]) << text(v[2]);
                if (order == glm::ivec3(0, 1, 2)) first = hit;
                ASSERT_FLOAT_EQ(hit.t, first.t);
            }
        }
    }
    EXPECT_GT(on_edges, 1000);
}

}  // namespace
}  // namespace glint
