#include <cmath>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/hit_report.h"
#include "tests/accel/random.h"

namespace glint {
namespace {

float t_of(const Ray& ray, const Sphere& sphere) {
    const Aabb box{sphere.center - sphere.radius, sphere.center + sphere.radius};
    return intersect_sphere(PreparedRay(ray, box.magnitude()), sphere, ray.t_max);
}

// The spacing of floats at x.
float ulp(float x) { return std::nextafter(std::abs(x), kInfinity) - std::abs(x); }

// The quadratic a t^2 - 2 b t + c = 0 of a ray and a sphere, in long double.
struct Quadratic {
    long double a, b, c;

    Quadratic(const Ray& ray, const Sphere& s) : a(0), b(0), c(0) {
        for (int i = 0; i < 3; ++i) {
            const long double d = ray.direction[i],
                              f = static_cast<long double>(ray.origin[i]) - static_cast<long double>(s.center[i]);
            a += d * d;
            b -= f * d;
            c += f * f;
        }
        c -= static_cast<long double>(s.radius) * static_cast<long double>(s.radius);
    }
};

TEST(Sphere, S_SPH_01_FarSmallSphereKeepsItsRadius) {
    for (const float z : {10.0f, 100.0f, 1000.0f, 4096.0f, 1.0e4f, 1.0e5f}) {
        for (const float x : {0.0f, 0.5f, 0.999f}) {
            const float t = t_of({glm::vec3(x, 0.0f, 0.0f), glm::vec3(0.0f, 0.0f, 1.0f)}, {glm::vec3(0.0f, 0.0f, z), 1.0f});
            const long double exact = z - std::sqrt(1.0L - static_cast<long double>(x) * static_cast<long double>(x));
            EXPECT_NEAR(t, static_cast<double>(exact), 2.0 * static_cast<double>(ulp(z))) << "z " << z << " x " << x;
        }
    }
}

TEST(Sphere, S_SPH_02_HugeFloorSphereIsExactToAMillionth) {
    Random random(1);
    for (const float radius : {1.0e2f, 1.0e3f, 1.0e4f, 1.0e6f}) {
        for (int i = 0; i < 2000; ++i) {
            const float x = random.uniform(-2.0f, 2.0f), y = random.uniform(0.5f, 1.5f), z = random.uniform(-2.0f, 2.0f);
            const glm::vec3 d(random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, -0.5f), random.uniform(-1.0f, 1.0f));
            const Ray ray{glm::vec3(x, y, z), d};
            const Quadratic q(ray, {glm::vec3(0.0f, -radius, 0.0f), radius});
            const long double lx = x, ly = y, lz = z,
                              c = lx * lx + ly * ly + lz * lz + 2.0L * static_cast<long double>(radius) * ly;
            const long double exact = c / (q.b + std::sqrt(q.b * q.b - q.a * c));
            const float t = t_of(ray, {glm::vec3(0.0f, -radius, 0.0f), radius});
            ASSERT_NEAR(static_cast<double>(t / exact), 1.0, 1.0e-6) << "radius " << radius << " " << text(ray);
        }
    }
}

TEST(Sphere, S_SPH_03_StartsInsideOnTheSurfaceAndAtTheCentre) {
    const Sphere sphere{glm::vec3(1.0f, -2.0f, 3.0f), 2.0f};
    const glm::vec3 on_surface = sphere.center + glm::vec3(2.0f, 0.0f, 0.0f);
    EXPECT_FLOAT_EQ(t_of({sphere.center + glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(0.0f, 1.0f, 0.0f)}, sphere), 1.0f);
    EXPECT_FLOAT_EQ(t_of({sphere.center + glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(0.0f, -1.0f, 0.0f)}, sphere), 3.0f);
    EXPECT_EQ(t_of({on_surface, glm::vec3(0.0f, 1.0f, 0.0f)}, sphere), 0.0f) << "touches where it starts";
    Random random(2);
    for (int i = 0; i < 10000; ++i) {
        const glm::vec3 d = random.direction();
        EXPECT_NEAR(t_of({sphere.center, d}, sphere), sphere.radius / glm::length(d), 1.0e-6);
        const float t = t_of({on_surface, d}, sphere);
        if (d.x >= 0.0f) {
            EXPECT_EQ(t, 0.0f) << "leaves the surface: no hit " << text(d);
        } else {
            const long double dx = d.x, dy = d.y, dz = d.z;
            EXPECT_FLOAT_EQ(t, static_cast<float>(-4.0L * dx / (dx * dx + dy * dy + dz * dz))) << text(d);
        }
    }
}

TEST(Sphere, S_SPH_04_TangentIsDecidedByTheNextFloat) {
    const Sphere sphere{glm::vec3(0.0f), 1.0f};
    const auto ray = [](float x) { return Ray{glm::vec3(x, 0.0f, -5.0f), glm::vec3(0.0f, 0.0f, 1.0f)}; };
    EXPECT_GT(t_of(ray(std::nextafter(1.0f, 0.0f)), sphere), 0.0f);
    EXPECT_EQ(t_of(ray(std::nextafter(1.0f, 2.0f)), sphere), 0.0f);
    auto geometry = std::make_shared<Geometry>();
    geometry->spheres = {sphere};
    const BruteForce truth(geometry);
    for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, geometry);
        for (const float x : {1.0f, -1.0f, std::nextafter(1.0f, 0.0f), std::nextafter(1.0f, 2.0f)}) {
            EXPECT_TRUE(same(closest_hit(*accelerator, ray(x)), truth.closest_hit(ray(x))));
            EXPECT_EQ(occluded(*accelerator, ray(x)), truth.closest_hit(ray(x)).found());
        }
    }
}

// Coordinates are small integers, so the discriminant's sign is known exactly.
TEST(Sphere, S_SPH_04_AgreesWithExactArithmeticOnIntegers) {
    Random random(4);
    const auto integer = [&random](std::uint32_t half) { return static_cast<std::int64_t>(random.below(2 * half + 1)) - half; };
    int tangents = 0;
    for (int i = 0; i < 300000; ++i) {
        const std::int64_t o[3] = {integer(12), integer(12), integer(12)}, d[3] = {integer(3), integer(3), integer(3)};
        const std::int64_t r = 1 + random.below(10);
        std::int64_t a = 0, b = 0, c = -r * r;
        for (int k = 0; k < 3; ++k) a += d[k] * d[k], b -= o[k] * d[k], c += o[k] * o[k];
        if (a == 0) continue;
        const std::int64_t discriminant = b * b - a * c;
        tangents += discriminant == 0 ? 1 : 0;
        if (discriminant == 0) continue;  // either answer
        const bool expected = discriminant > 0 && (c < 0 || b > 0);
        const Ray ray{glm::vec3(o[0], o[1], o[2]), glm::vec3(d[0], d[1], d[2])};
        ASSERT_EQ(t_of(ray, {glm::vec3(0.0f), static_cast<float>(r)}) > 0.0f, expected) << text(ray) << " radius " << r;
    }
    EXPECT_GT(tangents, 100) << "close calls are missing";
}

TEST(Sphere, S_SPH_05_DirectionTimesPowerOfTwoScalesTToTheBit) {
    Random random(5);
    for (int i = 0; i < 20000; ++i) {
        const Sphere sphere{random.in_cube(-1.0f, 1.0f), random.power_of_ten(-3.0f, 1.0f)};
        const Ray ray{random.in_cube(-4.0f, 4.0f), random.direction()};
        const float t = t_of(ray, sphere);
        for (int k = -20; k <= 20; k += 5) {
            ASSERT_EQ(t_of({ray.origin, std::ldexp(1.0f, k) * ray.direction}, sphere), std::ldexp(t, -k))
                << text(ray) << " k " << k;
        }
    }
}

TEST(Sphere, S_SPH_06_RadiusOfNoUseIsRejectedAndNoneGivesNaN) {
    const auto nan = std::numeric_limits<float>::quiet_NaN();
    for (const float radius : {0.0f, -1.0f, nan, kInfinity, 2.0e19f})
        EXPECT_FALSE(valid(Sphere{glm::vec3(0.0f), radius})) << radius;
    for (const float x : {nan, kInfinity, 2.0e19f}) EXPECT_FALSE(valid(Sphere{glm::vec3(0.0f, x, 0.0f), 1.0f})) << x;
    for (const float radius : {1.0e-45f, 1.0e-38f, 1.0e-20f, 1.0e9f, 1.0e18f}) {
        const Sphere sphere{glm::vec3(0.0f), radius};
        EXPECT_TRUE(valid(sphere)) << radius;
        // Seen from five radii away, where float can say that; from the centre; and from a unit away.
        if (radius > 1.0e-37f) {
            EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 0.0f, -5.0f * radius), glm::vec3(0.0f, 0.0f, 1.0f)}, sphere), 4.0f * radius);
            EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)}, sphere), radius);
        }
        const float t = t_of({glm::vec3(0.0f, 0.0f, -1.0f), glm::vec3(0.0f, 0.0f, 1.0f)}, sphere);
        EXPECT_FLOAT_EQ(t, radius < 1.0f ? 1.0f - radius : radius - 1.0f) << radius;
    }
}

// Points with integer coordinates exactly on a sphere of integer radius (Euler's quadruples): a ray that leaves from
// there must not meet the sphere again, and one that enters leaves at the other end of its chord.
TEST(Sphere, S_SPH_07_RayFromAnExactSurfacePointDoesNotMeetItAgain) {
    Random random(7);
    for (int i = 0; i < 1000; ++i) {
        const auto number = [&random] { return static_cast<int>(random.below(61)) - 30; };
        const int m = number(), n = number(), p = number(), q = number();
        const int radius = m * m + n * n + p * p + q * q;
        if (radius == 0) continue;
        const glm::vec3 offset(m * m + n * n - p * p - q * q, 2 * (m * q + n * p), 2 * (n * q - m * p));
        const float scale = std::ldexp(1.0f, static_cast<int>(random.below(61)) - 30);
        const glm::vec3 center(number(), number(), number());
        const Sphere sphere{scale * center, scale * static_cast<float>(radius)};
        for (int k = 0; k < 200; ++k) {
            const glm::vec3 d = random.direction();
            const Ray ray{scale * (center + offset), d};
            const double outwards = glm::dot(glm::dvec3(offset), glm::dvec3(d));
            const float t = t_of(ray, sphere);
            if (outwards >= 0.0) {
                ASSERT_EQ(t, 0.0f) << text(ray) << " radius " << sphere.radius;
            } else {
                const double chord = -2.0 * static_cast<double>(scale) * outwards / glm::dot(glm::dvec3(d), glm::dvec3(d));
                ASSERT_FLOAT_EQ(t, static_cast<float>(chord)) << text(ray) << " radius " << sphere.radius;
            }
        }
    }
}

}  // namespace
}  // namespace glint
