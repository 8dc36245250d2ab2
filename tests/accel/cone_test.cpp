#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/hit_report.h"
#include "tests/accel/random.h"

namespace glint {
namespace {

float t_of(const Ray& ray, const Cone& cone) {
    const float magnitude =
        16.0f * (1.0f + glm::length(cone.base) + glm::length(cone.apex) + cone.base_radius + cone.apex_radius);
    const PreparedRay prepared(ray, magnitude);
    return prepared.usable ? intersect_cone(prepared, cone, ray.t_max) : 0.0f;
}

// The distance from the axis minus the radius at that height, along a ray, in long double; knows no quadratic.
class Gap {
public:
    Gap(const Ray& ray, const Cone& cone) : r0_(cone.base_radius), r1_(cone.apex_radius) {
        for (int k = 0; k < 3; ++k) {
            origin_[k] = static_cast<long double>(ray.origin[k]) - static_cast<long double>(cone.base[k]);
            direction_[k] = ray.direction[k];
            axis_[k] = static_cast<long double>(cone.apex[k]) - static_cast<long double>(cone.base[k]);
        }
    }
    // height: 0 at the base, 1 at the apex.
    long double operator()(long double t, long double& height) const {
        long double p[3], along = 0, length2 = 0, across = 0;
        for (int k = 0; k < 3; ++k) {
            p[k] = origin_[k] + t * direction_[k];
            along += p[k] * axis_[k];
            length2 += axis_[k] * axis_[k];
        }
        height = along / length2;
        for (int k = 0; k < 3; ++k) across += (p[k] - height * axis_[k]) * (p[k] - height * axis_[k]);
        return std::sqrt(across) - (r0_ + height * (r1_ - r0_));
    }
    long double operator()(long double t) const {
        long double height;
        return (*this)(t, height);
    }

private:
    long double origin_[3], direction_[3], axis_[3], r0_, r1_;
};

struct Sampled {
    long double t = 0;      // 0: no crossing
    bool doubtful = false;  // a crossing at a rim or at t = 0, or a near-tangency that samples may miss
};

// The first crossing among dense samples in (0, far], bisected.
Sampled sample(const Gap& gap, long double far, int samples) {
    long double before = gap(0.0L);
    Sampled result;
    result.doubtful = std::abs(before) < 1.0e-5L;
    for (int i = 1; i <= samples; ++i) {
        const long double step = far / samples, t = step * i, after = gap(t);
        long double height;
        if ((before < 0) != (after < 0)) {
            long double lo = t - step, hi = t;
            for (int k = 0; k < 60; ++k) ((gap(0.5L * (lo + hi)) < 0) == (before < 0) ? lo : hi) = 0.5L * (lo + hi);
            gap(lo, height);
            result.doubtful = result.doubtful || std::abs(height) < 1.0e-5L || std::abs(height - 1.0L) < 1.0e-5L;
            if (height >= 0.0L && height <= 1.0L) {
                result.t = lo;
                return result;
            }
        } else if (std::min(std::abs(before), std::abs(after)) < step) {
            // Dips of less than a sample's width: look closer before calling it a miss.
            for (int k = 1; k < 16; ++k) result.doubtful = result.doubtful || (gap(t - step * k / 16) < 0) != (before < 0);
            result.doubtful = result.doubtful || std::min(std::abs(before), std::abs(after)) < 0.02L * step;
        }
        before = after;
    }
    return result;
}

Cone random_cone(Random& random, int i) {
    const float radius = random.uniform(0.1f, 1.0f);
    const glm::vec3 base = random.in_cube(-1.0f, 1.0f);
    return {base, radius, base + random.uniform(0.3f, 2.0f) * random.direction(),
            i % 3 == 0   ? radius
            : i % 3 == 1 ? 0.0f
                         : random.uniform(0.0f, 1.0f)};
}

TEST(Cone, S_CON_01_AgreesWithDenseSampling) {
    Random random(1);
    int found = 0, missed = 0, doubtful = 0;
    for (int i = 0; i < 4000; ++i) {
        const Cone cone = random_cone(random, i);
        Ray ray{random.in_cube(-2.0f, 2.0f), random.direction()};
        if (i % 4 == 0) ray.origin = 0.5f * (cone.base + cone.apex);
        const Sampled expected = sample(Gap(ray, cone), 8.0L, 500);
        const float t = t_of(ray, cone);
        if (expected.doubtful) {
            ++doubtful;
            continue;
        }
        ASSERT_EQ(t > 0.0f, expected.t > 0) << i << " " << text(ray);
        (t > 0.0f ? found : missed) += 1;
        ASSERT_NEAR(t, static_cast<double>(expected.t), 2.0e-6) << i << " " << text(ray);
    }
    EXPECT_GT(found, 500);
    EXPECT_GT(missed, 500);
    EXPECT_LT(doubtful, 400);
}

TEST(Cone, S_CON_02_EveryHitLiesOnTheSurface) {
    Random random(2);
    int found = 0;
    for (int i = 0; i < 200000; ++i) {
        const Cone cone = random_cone(random, i);
        const float far = i % 2 == 0 ? 1.0f : random.power_of_ten(0.0f, 4.0f);
        const glm::vec3 target = cone.base + random.uniform(-0.1f, 1.1f) * (cone.apex - cone.base) + 0.5f * random.direction();
        const glm::vec3 d = random.direction();
        const Ray ray{target - 3.0f * far * d, d};
        const float t = t_of(ray, cone);
        if (t == 0.0f) continue;
        ++found;
        long double height;
        const long double gap = Gap(ray, cone)(t, height), tolerance = 4.0e-7L * static_cast<long double>(far + 1.0f);
        ASSERT_LT(std::abs(gap), 2.0L * tolerance) << i << " " << text(ray);
        ASSERT_GE(height, -4.0L * tolerance) << text(ray);
        ASSERT_LE(height, 1.0L + 4.0L * tolerance) << text(ray);
    }
    EXPECT_GT(found, 50000);
}

TEST(Cone, S_CON_03_AlongTheAxisAndParallelToAGenerator) {
    const Cone cylinder{glm::vec3(0.0f), 1.0f, glm::vec3(0.0f, 0.0f, 2.0f), 1.0f};
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    for (const float x : {0.0f, 0.5f, 2.0f}) {  // inside, inside, outside: no caps, no hit
        EXPECT_EQ(t_of({glm::vec3(x, 0.0f, -1.0f), up}, cylinder), 0.0f) << x;
        EXPECT_EQ(t_of({glm::vec3(x, 0.0f, 1.0f), -up}, cylinder), 0.0f) << x;
    }
    EXPECT_EQ(t_of({glm::vec3(1.0f, 0.0f, -1.0f), up}, cylinder), 0.0f) << "in the surface, as in a plane";

    const Cone cone{glm::vec3(0.0f), 1.0f, glm::vec3(0.0f, 0.0f, 1.0f), 0.0f};
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 0.0f, -2.0f), up}, cone), 3.0f) << "along the axis, out of the apex";
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 0.0f, 4.0f), -up}, cone), 3.0f) << "along the axis, onto the apex";
    // Parallel to the generator from (1,0,0) to the apex: the quadratic has lost its square, one root is left.
    const glm::vec3 generator(-1.0f, 0.0f, 1.0f);
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.5f, 0.0f, -0.25f), generator}, cone), 0.875f);
    EXPECT_EQ(t_of({glm::vec3(2.0f, 0.0f, -0.25f), generator}, cone), 0.0f) << "passes outside, parallel to the surface";
    EXPECT_FALSE(std::isnan(t_of({glm::vec3(1.5f, 0.0f, -0.5f), generator}, cone))) << "in the surface";
    EXPECT_EQ(t_of({glm::vec3(0.0f, 0.0f, 1.5f), glm::vec3(1.0f, 0.0f, 0.25f)}, cone), 0.0f) << "meets the mirrored cone only";
}

TEST(Cone, S_CON_04_FromInsideAndThroughTheOpenEnd) {
    const Cone cone{glm::vec3(0.0f), 2.0f, glm::vec3(0.0f, 4.0f, 0.0f), 1.0f};
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 2.0f, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f)}, cone), 1.5f);
    EXPECT_FLOAT_EQ(t_of({glm::vec3(-9.0f, 2.0f, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f)}, cone), 7.5f);
    EXPECT_FLOAT_EQ(t_of({glm::vec3(0.0f, 6.0f, 0.0f), glm::vec3(0.75f, -2.0f, 0.0f)}, cone), 2.0f) << "in by the open top";
    EXPECT_EQ(t_of({glm::vec3(0.5f, 6.0f, 0.0f), glm::vec3(0.0f, -1.0f, 0.0f)}, cone), 0.0f) << "in by the top, out by the base";
    EXPECT_EQ(t_of({glm::vec3(0.0f, 5.0f, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f)}, cone), 0.0f) << "above the top";
}

TEST(Cone, S_CON_05_ThroughAnyApexWithoutNaN) {
    Random random(5);
    int found = 0;
    for (int i = 0; i < 100000; ++i) {
        Cone cone = random_cone(random, 1);
        const glm::vec3 axis = cone.apex - cone.base;
        const glm::vec3 d = i % 4 == 0 ? axis : random.direction();
        const float t = t_of({cone.apex - 2.0f * d, d}, cone);
        ASSERT_TRUE(t >= 0.0f && t < kInfinity);
        if (t > 0.0f) ++found;
        cone.apex_radius = cone.base_radius;  // along the axis of a cylinder, whatever its rounding
        const float inside = t_of({cone.base - axis, axis}, cone);
        ASSERT_EQ(inside, 0.0f) << text(axis);
    }
    EXPECT_GT(found, 20000);
}

TEST(Cone, S_CON_06_ScalesByPowersOfTwo) {
    Random random(6);
    for (int i = 0; i < 20000; ++i) {
        const Cone cone = random_cone(random, i);
        const Ray ray{random.in_cube(-2.0f, 2.0f), random.direction()};
        const float t = t_of(ray, cone);
        for (const int k : {-60, -20, 20, 58}) {
            const float s = std::ldexp(1.0f, k);
            const Cone scaled{s * cone.base, s * cone.base_radius, s * cone.apex, s * cone.apex_radius};
            ASSERT_EQ(t_of({s * ray.origin, ray.direction}, scaled), s * t) << text(ray) << " k " << k;
        }
        for (const int k : {-20, 20}) {
            ASSERT_EQ(t_of({ray.origin, std::ldexp(1.0f, k) * ray.direction}, cone), std::ldexp(t, -k))
                << text(ray) << " k " << k;
        }
    }
}

// Down to heights of 10^-30 radii: a ring, met between its rims and nowhere else.
TEST(Cone, S_CON_07_AFlatConeIsARing) {
    Random random(7);
    int found = 0;
    for (int i = 0; i < 200000; ++i) {
        const glm::vec3 axis = random.power_of_ten(-30.0f, -3.0f) * random.direction();
        const float outer = random.uniform(0.5f, 1.0f), inner = outer * random.uniform(0.0f, 0.8f);
        const glm::vec3 base(0.0f);
        const Cone cone = i % 2 == 0 ? Cone{base, outer, axis, inner} : Cone{base, inner, axis, outer};
        const glm::dvec3 n = glm::normalize(glm::dvec3(axis)), x = glm::normalize(glm::cross(n, glm::dvec3(random.direction())));
        const double off = random.uniform(0.0f, 1.2f) * outer;
        const glm::vec3 d = random.direction(), target(off * x);
        const double slant = std::abs(glm::dot(n, glm::dvec3(d)) / glm::length(glm::dvec3(d)));
        if (slant < 0.1) continue;
        const Ray ray{target - 3.0f * d, d};
        const float t = t_of(ray, cone);
        found += t > 0.0f ? 1 : 0;
        const double margin = 3e-6 + 2.0 * static_cast<double>(glm::length(axis)) / slant;
        if (off < inner - margin || off > outer + margin) {
            ASSERT_EQ(t, 0.0f) << text(ray) << text(axis) << off;
        }
        if (off > inner + margin && off < outer - margin) {
            ASSERT_NEAR(t, 3.0, margin) << text(ray) << text(axis) << off;
        }
    }
    EXPECT_GT(found, 50000);
}

}  // namespace
}  // namespace glint
