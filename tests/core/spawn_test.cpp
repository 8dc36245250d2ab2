// Rays that start on a surface must not hit it again: a million per kind of primitive, near and far from the origin, on both
// sides.
#include "core/surface_point.h"

#include <gtest/gtest.h>

#include "tests/core/p3f_text.h"
#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint {
namespace {

using namespace test;

// A primitive of each kind, `size` large, moved to `at`; glass so that both sides are of interest.
std::shared_ptr<const Scene> single(PrimitiveKind kind, glm::vec3 at, float size) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(glass(1.5f));
    switch (kind) {
        case PrimitiveKind::triangle:
            b.add_vertex(at + size * glm::vec3(-1, -0.5f, 0.2f));
            b.add_vertex(at + size * glm::vec3(1, -0.7f, -0.3f));
            b.add_vertex(at + size * glm::vec3(0.1f, 1, 0.4f));
            b.add_triangle(0, 1, 2, m);
            break;
        case PrimitiveKind::sphere: b.add(Sphere{at, size}, m); break;
        case PrimitiveKind::box:
            b.add(Box{at - size * glm::vec3(0.7f, 0.5f, 0.6f), at + size * glm::vec3(0.7f, 0.5f, 0.6f)}, m);
            break;
        case PrimitiveKind::cone:
            b.add(
                Cone{at - size * glm::vec3(0.2f, 0.8f, 0.1f), 0.9f * size, at + size * glm::vec3(0.2f, 0.8f, 0.1f), 0.3f * size},
                m);
            break;
        case PrimitiveKind::plane: b.add(plane_at(glm::dvec3(at), {0.3, 1.0, -0.4}), m); break;
    }
    return b.finish();
}

// The same a million sizes from zero, read from a file that holds all digits. Only the plane needs the view to tell its place.
std::shared_ptr<const Scene> single_in_a_file(PrimitiveKind kind, glm::dvec3 at) {
    const auto p = [at](double x, double y, double z) { return fmt::format(" {} {} {}", at.x + x, at.y + y, at.z + z); };
    std::string text =
        "v from" + p(0, 3, 5) + " at" + p(0, 0, 0) + " up 0 1 0 angle 45 hither 1 resolution 8 8 f 0 0 0 0 1 0 1 1.5";
    switch (kind) {
        case PrimitiveKind::triangle: text += " p 3" + p(-1, -0.5, 0.2) + p(1, -0.7, -0.3) + p(0.1, 1, 0.4); break;
        case PrimitiveKind::sphere: text += " s" + p(0, 0, 0) + " 1"; break;
        case PrimitiveKind::box: text += " box" + p(-0.7, -0.5, -0.6) + p(0.7, 0.5, 0.6); break;
        case PrimitiveKind::cone: text += " c" + p(-0.2, -0.8, -0.1) + " 0.9" + p(0.2, 0.8, 0.1) + " 0.3"; break;
        case PrimitiveKind::plane: text += " pl" + p(0, 0, 0) + p(1, -0.3, 0) + p(0, 0.4, 1); break;
    }
    return read_text(text);
}

// A direction in the hemisphere of n; grazing ones are as frequent as others.
glm::vec3 hemisphere(Random& random, glm::dvec3 n) {
    glm::dvec3 d = random.direction();
    if (glm::dot(d, n) < 0.0) d -= 2.0 * glm::dot(d, n) * n;
    return glm::vec3(d);
}

// How far a ray that starts exactly on the surface and goes inwards has to the surface's other side: the second root of the
// quadric, 2 (-n.f') / d.A.d in general; infinite for flat primitives and where there is none.
double chord(const Scene& scene, const SurfacePoint& s, const Hit& hit, glm::dvec3 d) {
    const Geometry& g = *scene.geometry;
    if (kind_of(hit.primitive) == PrimitiveKind::sphere) {
        return -2.0 * glm::dot(glm::dvec3(s.p) - glm::dvec3(g.spheres[0].center), d) / glm::dot(d, d);
    }
    if (kind_of(hit.primitive) == PrimitiveKind::cone) {
        const Cone& c = g.cones[0];
        const glm::dvec3 base(c.base), axis = glm::dvec3(c.apex) - base, f = glm::dvec3(s.p) - base;
        const double h2 = glm::dot(axis, axis), slope = static_cast<double>(c.apex_radius) - static_cast<double>(c.base_radius);
        const double s0 = glm::dot(f, axis) / h2, s1 = glm::dot(d, axis) / h2;
        const glm::dvec3 p0 = f - s0 * axis, p1 = d - s1 * axis;
        const double r0 = static_cast<double>(c.base_radius) + slope * s0, r1 = slope * s1;
        const double a = glm::dot(p1, p1) - r1 * r1, b = glm::dot(p0, p1) - r0 * r1;
        return a > 0.0 ? -2.0 * b / a : static_cast<double>(kInfinity);
    }
    return static_cast<double>(kInfinity);
}

// A hit of the surface just left. Outwards no kind can be met again: all are convex. Inwards a box is met on another face,
// ball and cone after their chord, the flat ones never.
bool is_self_hit(const Scene& scene, const SurfacePoint& s, const Hit& from, const Ray& ray, const Hit& hit, bool inwards) {
    if (!hit.found()) return false;
    const PrimitiveKind kind = kind_of(from.primitive);
    if (!inwards || kind == PrimitiveKind::triangle || kind == PrimitiveKind::plane) return true;
    if (kind == PrimitiveKind::box) return hit.u == from.u;
    return static_cast<double>(hit.t) < 0.5 * chord(scene, s, from, glm::dvec3(ray.direction));
}

struct Tally {
    int rays = 0, self_hits = 0, through = 0;
};

// Points seen from ten sizes away, `fan` rays from each, every second one to the far side of the surface.
Tally spawn(const Scene& scene, const AnyAccelerator& accelerator, glm::vec3 at, float size, int points, std::uint32_t seed) {
    constexpr int fan = 24;
    Random random(seed);
    Tally tally;
    for (int i = 0; i < points; ++i) {
        const glm::vec3 eye(glm::dvec3(at) + 10.0 * static_cast<double>(size) * random.direction());
        const glm::vec3 target(glm::dvec3(at) + 0.5 * static_cast<double>(size) * random.uniform() * random.direction());
        const Ray ray{eye, glm::vec3(glm::normalize(glm::dvec3(target) - glm::dvec3(eye))), kInfinity};
        const Hit hit = closest_hit(accelerator, ray);
        if (!hit.found()) continue;
        const SurfacePoint s = surface_point(scene, ray, hit);
        for (int k = 0; k < fan; ++k) {
            const glm::vec3 side = k % 2 == 0 ? s.ng : -s.ng;
            const bool inwards = (side == s.ng) != s.outside;
            const Ray next{spawn_origin(s, side), hemisphere(random, glm::dvec3(side)), kInfinity};
            const Hit again = closest_hit(accelerator, next);
            ++tally.rays;
            tally.through += again.found() ? 1 : 0;
            tally.self_hits += is_self_hit(scene, s, hit, next, again, inwards) ? 1 : 0;
        }
    }
    return tally;
}

void expect_no_self_hits(PrimitiveKind kind, float size, float distance) {
    const glm::vec3 place = size * distance * glm::vec3(1.0f, 0.7f, -0.4f);
    const bool recentred = distance >= 1e6f;
    const auto scene = recentred ? single_in_a_file(kind, glm::dvec3(place)) : single(kind, place, size);
    const glm::vec3 at = scene->local(glm::dvec3(place));
    int rays = 0;
    for (const AcceleratorKind a : {AcceleratorKind::none, AcceleratorKind::bvh}) {
        const Tally tally = spawn(*scene, *build_accelerator(a, scene->geometry), at, size, scale(32000, 260000),
                                  static_cast<std::uint32_t>(a) + 5);
        rays += tally.rays;
        EXPECT_EQ(tally.self_hits, 0) << size << ' ' << distance << ' ' << kAcceleratorNames[static_cast<std::size_t>(a)];
        // Every ray into a closed body must leave it again.
        if (kind == PrimitiveKind::sphere || kind == PrimitiveKind::box) {
            EXPECT_GE(tally.through, tally.rays / 2 - tally.rays / 100);
        }
    }
    EXPECT_GE(rays, 1000000) << size << ' ' << distance;
}

// Distances in sizes of the primitive, the farthest from a file, which is stored relative to its centre; at night of three sizes,
// so that it is 10^8 rays for each kind.
void expect_no_self_hits(PrimitiveKind kind) {
    for (const float distance : {0.0f, 1e3f, 1e5f}) {
        expect_no_self_hits(kind, 1.0f, distance);
        if (!is_long_run()) continue;
        expect_no_self_hits(kind, 1e-4f, distance);
        expect_no_self_hits(kind, 1e4f, distance);
    }
    expect_no_self_hits(kind, 1.0f, 1e6f);
}

TEST(Spawn, S_OFF_01_ATriangleNeverHitsItself) { expect_no_self_hits(PrimitiveKind::triangle); }
TEST(Spawn, S_OFF_01_ASphereNeverHitsItself) { expect_no_self_hits(PrimitiveKind::sphere); }
TEST(Spawn, S_OFF_01_ABoxNeverHitsItself) { expect_no_self_hits(PrimitiveKind::box); }
TEST(Spawn, S_OFF_01_AConeNeverHitsItself) { expect_no_self_hits(PrimitiveKind::cone); }
TEST(Spawn, S_OFF_01_APlaneNeverHitsItself) { expect_no_self_hits(PrimitiveKind::plane); }

// Ten to the power of a uniform number, with a random sign.
float wild(Random& random, double low, double high) {
    const double x = std::pow(10.0, random.uniform(low, high));
    return static_cast<float>(random.uniform() < 0.5 ? -x : x);
}

TEST(Spawn, S_OFF_02_WildTrianglesNeverHitThemselves) {
    Random random(2);
    int rays = 0, self_hits = 0;
    for (int i = 0; i < 1000; ++i) {
        SceneBuilder b;
        glm::dvec3 corner[3];
        for (glm::dvec3& c : corner) {
            const glm::vec3 v(wild(random, -8, 8), wild(random, -8, 8), wild(random, -8, 8));
            c = glm::dvec3(v);
            b.add_vertex(v);
        }
        if (!b.add_triangle(0, 1, 2, b.add_material(black()))) continue;
        const auto scene = b.finish();
        const AnyAccelerator accelerator = BruteForce(scene->geometry);
        // A point of the triangle, as a hit of a ray along the normal would report it.
        Hit hit;
        hit.primitive = make_id(PrimitiveKind::triangle, 0);
        hit.u = static_cast<float>(random.uniform(0, 0.5)), hit.v = static_cast<float>(random.uniform(0, 0.5));
        const glm::dvec3 n = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
        const SurfacePoint s = surface_point(*scene, Ray{glm::vec3(0.0f), glm::vec3(-n), kInfinity}, hit);
        for (int k = 0; k < 1000; ++k, ++rays) {
            const glm::vec3 side = k % 2 == 0 ? s.ng : -s.ng;
            self_hits +=
                closest_hit(accelerator, Ray{spawn_origin(s, side), hemisphere(random, glm::dvec3(side)), kInfinity}).found() ? 1
                                                                                                                              : 0;
        }
    }
    EXPECT_GT(rays, 900000);
    EXPECT_EQ(self_hits, 0);
}

// Points near the origin of triangles a thousand units wide: their coordinates are small, the numbers in the test are not.
TEST(Spawn, S_TRI_16_AWideTriangleNeverHitsItselfNearTheOrigin) {
    Random random(16);
    int rays = 0, self_hits = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 a = random.direction(), b = glm::normalize(glm::cross(a, random.direction()));
        SceneBuilder builder;
        for (int k = 0; k < 3; ++k) {
            const double angle = 2.0 * kPi * (k + random.uniform(0.0, 0.5)) / 3.0;
            // The first hundred lie flat, a hair above the plane of the axes.
            if (i < 100)
                builder.add_vertex(glm::vec3(1e3 * std::cos(angle), 1e-6, 1e3 * std::sin(angle)));
            else
                builder.add_vertex(glm::vec3(1e3 * (std::cos(angle) * a + std::sin(angle) * b)));
        }
        builder.add_triangle(0, 1, 2, builder.add_material(black()));
        const auto scene = builder.finish();
        const AnyAccelerator accelerator = BruteForce(scene->geometry);
        for (int p = 0; p < 20; ++p) {
            const glm::dvec3 eye = random.direction();
            const Ray ray{glm::vec3(eye), glm::vec3(glm::normalize(1e-3 * random.direction() - eye)), kInfinity};
            const Hit hit = closest_hit(accelerator, ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*scene, ray, hit);
            for (int k = 0; k < 50; ++k, ++rays) {
                const glm::vec3 side = k % 2 == 0 ? s.ng : -s.ng;
                const Ray next{spawn_origin(s, side), hemisphere(random, glm::dvec3(side)), kInfinity};
                self_hits += closest_hit(accelerator, next).found() ? 1 : 0;
            }
        }
    }
    EXPECT_GT(rays, 300000);
    EXPECT_EQ(self_hits, 0);
}

TEST(Spawn, S_SPH_07_WildSpheresNeverHitThemselves) {
    Random random(7);
    int points = 0, self_hits = 0;
    for (int i = 0; i < 1000; ++i) {
        SceneBuilder b;
        const glm::vec3 center(wild(random, -8, 8), wild(random, -8, 8), wild(random, -8, 8));
        const float radius = std::abs(wild(random, -4, 4));
        b.add(Sphere{center, radius}, b.add_material(black()));
        const auto scene = b.finish();
        const AnyAccelerator accelerator = BruteForce(scene->geometry);
        // Seen from a few radii away, but never from where the coordinates' rounding exceeds the ball.
        for (int p = 0; p < 10; ++p) {
            const glm::vec3 eye(glm::dvec3(center) +
                                random.uniform(1.5, 20.0) * static_cast<double>(radius) * random.direction());
            const glm::dvec3 d = glm::dvec3(center) - glm::dvec3(eye);
            if (!(glm::length(d) > 1.2 * static_cast<double>(radius))) continue;
            const Ray ray{eye, glm::vec3(glm::normalize(d)), kInfinity};
            const Hit hit = closest_hit(accelerator, ray);
            if (!hit.found()) continue;
            ++points;
            const SurfacePoint s = surface_point(*scene, ray, hit);
            for (int k = 0; k < 100; ++k) {
                self_hits +=
                    closest_hit(accelerator, Ray{spawn_origin(s, s.ng), hemisphere(random, glm::dvec3(s.ng)), kInfinity}).found()
                        ? 1
                        : 0;
            }
        }
    }
    EXPECT_GT(points, 5000);
    EXPECT_EQ(self_hits, 0);
}

}  // namespace
}  // namespace glint
