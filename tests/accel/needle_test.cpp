// Triangles so thin that a rounding decides which side of an edge a ray is on, against exact arithmetic.
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/exact_triangle.h"
#include "tests/accel/hit_report.h"
#include "tests/long.h"

namespace glint {
namespace {

bool hits(const Ray& ray, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    Aabb box;
    for (const glm::vec3 p : {a, b, c}) box.grow(p);
    const PreparedRay prepared(ray, box.magnitude());
    TriangleHit hit{};
    return prepared.usable && intersect_triangle(prepared, a, b, c, ray.t_max, hit);
}

Ray aimed(glm::vec3 origin, glm::dvec3 target) {
    const glm::dvec3 d = target - glm::dvec3(origin);
    return {origin, glm::vec3(d / std::sqrt(glm::dot(d, d)))};
}

TEST(Needle, S_TRI_11_TheCataloguesNeedleAgreesWithExactArithmetic) {
    const glm::vec3 a(0.0f, 0.0f, 5.0f), b(1.0f, 0.0f, 5.0f), c(0.5f, 1e-6f, 5.0f);
    const Ray straight{glm::vec3(0.5f, 3.33e-7f, 0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};
    EXPECT_TRUE(ExactTriangle(straight, a, b, c).hit());
    EXPECT_TRUE(hits(straight, a, b, c));
    const Ray slanted = aimed(glm::vec3(0.0f), glm::dvec3(0.5, 3.33e-7, 5.0));
    EXPECT_EQ(hits(slanted, a, b, c), ExactTriangle(slanted, a, b, c).hit());
}

// How far a ray passes from the nearest edge's line, in 2^-24 of the largest coordinate that separates it from a corner.
double roundings_from_an_edge(const Ray& ray, const glm::vec3 (&corner)[3]) {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    double nearest = std::numeric_limits<double>::infinity(), reach = 0.0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p = glm::dvec3(corner[k]) - o, q = glm::dvec3(corner[(k + 1) % 3]) - o;
        const glm::dvec3 across = glm::cross(d, q - p), size = glm::abs(p);
        nearest = std::min(nearest, std::abs(glm::dot(across, p)) / std::sqrt(glm::dot(across, across)));
        reach = std::max(reach, std::max(size.x, std::max(size.y, size.z)));
    }
    return nearest / (0x1p-24 * reach);
}

struct Answers {
    int hits = 0, wrong = 0;
    double worst = 0.0;  // of the wrong ones: how far from an edge, in roundings
};

// Needles of the given aspect, and rays to within twice their width of the axis.
Answers answers(double aspect, int count) {
    Random random(static_cast<std::uint64_t>(aspect));
    Answers result;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 a(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f), random.uniform(5.0f, 5.1f));
        const glm::vec3 b(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f), random.uniform(5.0f, 5.1f));
        const glm::dvec3 along = glm::dvec3(b) - glm::dvec3(a);
        const glm::dvec3 across = glm::normalize(glm::dvec3(along.y, -along.x, 0.0)) * (glm::length(along) / aspect);
        const double at = random.uniform();
        const glm::vec3 c(glm::dvec3(a) + at * along + across);
        const double s = random.uniform(), t = 3.0 * random.uniform() - 1.0;
        const Ray ray = aimed(random.in_cube(-0.5f, 0.5f), glm::dvec3(a) + s * along + t * across);
        const ExactTriangle exact(ray, a, b, c);
        result.hits += exact.hit() ? 1 : 0;
        if (hits(ray, a, b, c) == exact.hit()) continue;
        ++result.wrong;
        result.worst = std::max(result.worst, roundings_from_an_edge(ray, {a, b, c}));
    }
    return result;
}

// Vertices relative to the ray and their shear are rounded to float before the edge functions, whose own signs are exact: so
// beyond this aspect a ray may pass beside a needle that it would meet, or the other way round, but never further than those
// roundings move a corner, and always consistently with its neighbours (below).
TEST(Needle, S_TRI_11_AgreesWithExactArithmeticToAspect1000AndToARoundingBeyond) {
    for (const double aspect : {1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7}) {
        const int count = scale(1500, 50000);
        const Answers found = answers(aspect, count);
        RecordProperty("wrong_at_" + std::to_string(static_cast<int>(aspect)), found.wrong);
        RecordProperty("worst_at_" + std::to_string(static_cast<int>(aspect)), std::to_string(found.worst));
        EXPECT_GT(found.hits, count / 20);
        if (aspect <= 1e3) {
            EXPECT_EQ(found.wrong, 0) << aspect;
        }
        EXPECT_LT(found.worst, 1.0) << aspect;
    }
}

// A ribbon of needles from rail to rail; rays into its middle must be stopped, whichever needle they meet.
std::shared_ptr<const Geometry> ribbon(double step, int count, glm::dvec3 x, glm::dvec3 y, glm::dvec3 at) {
    auto geometry = std::make_shared<Geometry>();
    for (int i = 0; i <= count; ++i) {
        for (const double side : {-1.0, 1.0}) geometry->vertices.emplace_back(at + step * (i - 0.5 * count) * x + side * y);
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (valid_triangle(geometry->vertices[a], geometry->vertices[b], geometry->vertices[c]))
            geometry->triangles.push_back({a, b, c});
    };
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(2 * count); i += 2) add(i, i + 1, i + 2), add(i + 1, i + 3, i + 2);
    return geometry;
}

TEST(Needle, S_TRI_11_ARibbonOfNeedlesLeaksNothing) {
    Random random(11);
    std::size_t rays = 0, leaks = 0;
    for (const double step : {1e-2, 1e-4, 1e-6, 1e-7}) {
        for (int turn = 0; turn < 8; ++turn) {
            const glm::dvec3 z = random.unit(), x = glm::normalize(glm::cross(z, random.unit())), y = glm::cross(z, x);
            const glm::dvec3 at = turn % 2 == 0 ? glm::dvec3(0.0) : 3.0 * random.unit();
            const auto geometry = ribbon(step, 200, x, y, at);
            for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
                if (!supported(isa)) continue;
                const Bvh bvh(geometry, serial_for, isa);
                RayBatch batch;
                HitBatch found;
                for (int i = 0; i < scale(10, 1000); ++i, rays += kRayBatch) {
                    batch.clear(i % 2 == 0 ? RayOrder::coherent : RayOrder::divergent);
                    while (batch.count < kRayBatch) {
                        // At least 25 needles and the roundings of coordinates from the border.
                        const double margin = 1e-6 / (100.0 * step), half = 100.0 * step * std::max(0.0, 0.5 - margin);
                        const glm::dvec3 target = at + (2.0 * random.uniform() - 1.0) * half * x + (random.uniform() - 0.5) * y;
                        const glm::dvec3 from = target + 2.0 * glm::normalize(z + 0.5 * random.unit());
                        batch.push(aimed(glm::vec3(from), target));
                    }
                    bvh.closest_hits(batch, found);
                    for (int k = 0; k < kRayBatch; ++k) {
                        const bool single = bvh.closest_hit(batch[k]).found();
                        if (found[k].found() && single) continue;
                        if (leaks++ == 0) ADD_FAILURE() << text(batch[k]) << " step " << step;
                    }
                }
            }
        }
    }
    EXPECT_EQ(leaks, 0u) << "of " << rays;
}

// A ray exactly through an edge meets both of its triangles. They report one distance, so that the two are one surface; who
// counted hits to tell inside from outside would be wrong.
TEST(Needle, S_TRI_15_DoubleHitsOfASharedEdgeAreOneSurface) {
    Random random(15);
    const auto integer = [&random](int lo, int hi) {
        return lo + static_cast<int>(random.below(static_cast<std::size_t>(hi - lo + 1)));
    };
    for (int i = 0; i < scale(100000, 10000000); ++i) {
        // Small integers and a ray along z: nothing rounds, and the edge runs through (0, 0).
        const glm::vec2 p(integer(-9, 9), integer(1, 9));
        const glm::vec3 a(p, integer(20, 40)), b(-static_cast<float>(integer(1, 5)) * p, integer(20, 40));
        const glm::vec2 across = static_cast<float>(integer(1, 9)) * glm::vec2(p.y, -p.x);
        auto geometry = std::make_shared<Geometry>();
        add_triangle(*geometry, a, b, glm::vec3(-across + p, integer(20, 40)));
        add_triangle(*geometry, b, a, glm::vec3(across - p, integer(20, 40)));
        const Ray ray{glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};
        const PreparedRay prepared(ray, geometry->bounds().magnitude());
        Hit first, second;
        intersect(prepared, *geometry, make_id(PrimitiveKind::triangle, 0), first);
        intersect(prepared, *geometry, make_id(PrimitiveKind::triangle, 1), second);
        ASSERT_TRUE(first.found() && second.found()) << text(a) << text(b);
        ASSERT_NEAR(first.t, second.t, 2.0f * 0x1p-23f * first.t) << text(a) << text(b);
        const Hit seen = BruteForce(geometry).closest_hit(ray);
        ASSERT_EQ(seen.primitive, first.t <= second.t ? first.primitive : second.primitive) << text(a) << text(b);
    }
}

}  // namespace
}  // namespace glint
