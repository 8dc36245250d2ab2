// Light at smooth boundaries: the division by Fresnel, Snell's direction, and the mirror law.
#include "core/fresnel.h"

#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

constexpr double kGlass = 1.5;
constexpr double kFloatUlp = 0x1p-24;

double exact_from_air(double angle, double n = kGlass) { return fresnel_dielectric(std::cos(radians(angle)), 1.0 / n); }
double schlick_from_air(double angle, double n = kGlass) { return fresnel_schlick(std::cos(radians(angle)), 1.0 / n); }

// Mean over a diffusely lit hemisphere: the integral of F(mu) 2 mu over mu in [0, 1] by the midpoint rule.
template <class F>
double hemispherical_mean(const F& f) {
    constexpr int kSteps = 200000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double mu = (i + 0.5) / kSteps;
        sum += f(mu) * 2.0 * mu;
    }
    return sum / kSteps;
}

TEST(Fresnel, O_FRN_01_ExactAndSchlickFromAir) {
    struct Row {
        double angle, exact, schlick;
    };
    constexpr Row kRows[] = {{0, .04, .04},
                             {30, .0415226, .0400414},
                             {45, .0502399, .0420693},
                             {60, .0891867, .07},
                             {75, .2530606, .2547299},
                             {80, .3877044, .4099101},
                             {85, .6127996, .6484917},
                             {89, .9041849, .9191019}};
    for (const Row& row : kRows) {
        EXPECT_NEAR(exact_from_air(row.angle), row.exact, 6e-8) << row.angle;
        EXPECT_NEAR(schlick_from_air(row.angle), row.schlick, 6e-8) << row.angle;
    }
}

TEST(Fresnel, O_FRN_01_SchlicksLargestError) {
    struct Row {
        double n, error, angle;
    };
    constexpr Row kRows[] = {{1.5, .0357, 85.0}, {1.33, .0599, 83.8}, {1.1, .2105, 83.1}, {2.0, .0444, -1}, {2.42, .0757, -1}};
    for (const Row& row : kRows) {
        double worst = 0.0, where = 0.0;
        for (double angle = 0.0; angle < 90.0; angle += 0.01) {
            const double error = std::abs(schlick_from_air(angle, row.n) - exact_from_air(angle, row.n));
            if (error > worst) worst = error, where = angle;
        }
        EXPECT_NEAR(worst, row.error, 6e-5) << row.n;
        if (row.angle > 0.0) {
            EXPECT_NEAR(where, row.angle, 0.3) << row.n;
        }
    }
}

TEST(Fresnel, O_FRN_02_FromInside) {
    constexpr double kRows[][2] = {{0, .04},       {20, .0417285}, {30, .0551902},   {38, .1421812},
                                   {40, .2452912}, {41, .3797513}, {41.5, .5416200}, {41.8, .8907719}};
    for (const auto& row : kRows) EXPECT_NEAR(fresnel_dielectric(std::cos(radians(row[0])), kGlass), row[1], 6e-8) << row[0];
}

TEST(Fresnel, O_FRN_03_HemisphericalMeans) {
    const auto exact = [](double eta) { return hemispherical_mean([eta](double mu) { return fresnel_dielectric(mu, eta); }); };
    EXPECT_NEAR(exact(1.0 / 1.5), .0917780, 1e-6);
    EXPECT_NEAR(exact(1.5), .5963458, 1e-6);
    EXPECT_NEAR(exact(1.5), 1.0 - (1.0 - exact(1.0 / 1.5)) / (1.5 * 1.5), 1e-6);
    EXPECT_NEAR(exact(1.0 / 1.33), .0659308, 1e-6);
    EXPECT_NEAR(exact(1.33), .4719492, 1e-6);
    EXPECT_NEAR(exact(1.0 / 1.1), .0251574, 1e-6);
    EXPECT_NEAR(hemispherical_mean([](double mu) { return fresnel_schlick(mu, 1.0 / 1.5); }), .0857143, 1e-6);
    EXPECT_NEAR(hemispherical_mean([](double mu) { return fresnel_schlick(mu, 1.0 / 1.1); }), .0497786, 1e-6);
}

TEST(Fresnel, O_FRN_04_CriticalAndBrewsterAngles) {
    EXPECT_NEAR(degrees(std::asin(1.0 / kGlass)), 41.8103149, 5e-8);
    EXPECT_EQ(fresnel_dielectric(std::cos(radians(41.8103150)), kGlass), 1.0);
    EXPECT_LT(fresnel_dielectric(std::cos(radians(41.8103148)), kGlass), 1.0);
    // At Brewster's angle the p part vanishes, so the mean is half the s part, ((n^2-1)/(n^2+1))^2 / 2, from both sides.
    const double half_s = 0.5 * std::pow((kGlass * kGlass - 1.0) / (kGlass * kGlass + 1.0), 2);
    EXPECT_NEAR(half_s, .0739645, 5e-8);
    EXPECT_NEAR(exact_from_air(56.3099325), half_s, 1e-9);
    EXPECT_NEAR(fresnel_dielectric(std::cos(radians(33.6900675)), kGlass), half_s, 1e-8);
    const glm::vec3 wo(std::sin(radians(45.0)), 0.0, std::cos(radians(45.0)));
    const glm::vec3 t = refract(wo, {0, 0, 1}, 1.0 / kGlass);
    EXPECT_NEAR(degrees(std::atan2(-t.x, -t.z)), 28.1255057, 1e-5);
}

TEST(Fresnel, S_FRN_01_SchlickFromTheDenseSideUsesTheTransmittedCosine) {
    EXPECT_NEAR(fresnel_schlick(std::cos(radians(41.0)), kGlass), .4010, 5e-5);
    EXPECT_NEAR(fresnel_dielectric(std::cos(radians(41.0)), kGlass), .3798, 5e-5);
    EXPECT_EQ(fresnel_schlick(std::cos(radians(42.0)), kGlass), 1.0);
}

TEST(Fresnel, S_FRN_03_GrazingReflectsAllAndEqualMediaNothing) {
    for (const double eta : {1.0 / 2.42, 1.0 / 1.5, 1.0 / 1.0003, 1.0003, 1.5, 2.42}) {
        EXPECT_EQ(fresnel_dielectric(0.0, eta), 1.0) << eta;
        EXPECT_EQ(fresnel_schlick(0.0, eta), 1.0) << eta;
    }
    Random random(1);
    for (double cos_i = 1.0; cos_i > 1e-12; cos_i *= 0.37) {
        EXPECT_EQ(fresnel_dielectric(cos_i, 1.0), 0.0) << cos_i;
        const glm::vec3 wo(random.direction());
        EXPECT_EQ(refract(wo, glm::vec3(random.direction()), 1.0), -wo);
    }
}

TEST(Fresnel, S_FRN_03_BothSidesOfABoundaryAgree) {
    for (const double n : {1.0003, 1.1, 1.33, 1.5, 2.42}) {
        for (double angle = 0.0; angle < 90.0; angle += 0.5) {
            const double cos_i = std::cos(radians(angle));
            const double cos_t = std::sqrt(transmitted_cos2(cos_i, 1.0 / n));
            EXPECT_NEAR(fresnel_dielectric(cos_i, 1.0 / n), fresnel_dielectric(cos_t, n), 1e-6) << n << ' ' << angle;
            EXPECT_NEAR(fresnel_schlick(cos_i, 1.0 / n), fresnel_schlick(cos_t, n), 1e-6) << n << ' ' << angle;
        }
    }
}

// The integrator's branches at one glass surface under a white sky; the ray reaches it at `angle` from inside or outside.
struct Boundary {
    Probe probe;
    glm::vec3 origin, direction;
};

Boundary boundary(double angle, bool inside, int depth) {
    SceneBuilder b;
    b.add(Box{{-1e6f, -1e6f, inside ? -1e3f : -1e6f}, {1e6f, 1e6f, 0.0f}}, b.add_material(glass(1.5f)));
    b.scene().environment.color = glm::vec3(1.0f);
    RenderSettings settings = centred();
    settings.depth = depth;
    const glm::vec3 eye(0.0f, 0.0f, inside ? -1.0f : 1.0f);
    const glm::vec3 direction(std::sin(radians(angle)), 0.0, std::cos(radians(angle)) * (inside ? 1.0 : -1.0));
    return {Probe(b.finish(), settings, camera_at(eye, glm::vec3(0.0f))), eye, direction};
}

TEST(Fresnel, S_FRN_04_BothBranchesTogetherCarryAllLight) {
    for (const bool inside : {false, true}) {
        for (double angle = 0.0; angle < 89.9; angle += 0.7) {
            // At depth 0 both branches are cut off, and counted with their weights.
            Boundary cut = boundary(angle, inside, 0);
            EXPECT_EQ(cut.probe.radiance(cut.origin, cut.direction).x, 0.0);
            EXPECT_NEAR(cut.probe.counts().depth_cut_weight, 1.0, kFloatUlp) << angle;
            const bool total = inside && std::sin(radians(angle)) > 1.0 / 1.5;
            EXPECT_EQ(cut.probe.counts().depth_cut, total ? 1u : 2u) << angle;
        }
    }
}

TEST(Fresnel, S_REF_03_OneMicroradianAroundTheCriticalAngle) {
    const double critical = std::asin(1.0 / 1.5);
    for (const double offset : {-1e-6, 1e-6}) {
        Boundary b = boundary(degrees(critical + offset), true, 1);
        const glm::dvec3 light = b.probe.radiance(b.origin, b.direction);
        EXPECT_TRUE(std::isfinite(light.x));
        EXPECT_EQ(b.probe.counts().refraction, offset < 0.0 ? 1u : 0u) << offset;
        EXPECT_EQ(b.probe.counts().reflection, 1u);
        const double f = fresnel_dielectric(std::cos(critical + offset), 1.5);
        EXPECT_TRUE(offset < 0.0 ? f < 1.0 && f > 0.98 : f == 1.0) << f;
    }
}

TEST(Fresnel, S_REF_04_RefractionObeysSnellAndIsReversible) {
    Random random(4);
    double length_error = 0.0, snell_error = 0.0, plane_error = 0.0, way_back = 0.0;
    int transmitted = 0;
    for (int i = 0; i < 2500000; ++i) {
        const glm::vec3 n(random.direction());
        glm::vec3 wo(random.direction());
        if (glm::dot(wo, n) < 0.0f) wo = -wo;
        const double eta = random.uniform(0.3, 3.0);
        const glm::dvec3 d(wo), m = glm::normalize(glm::dvec3(n));
        const double cos_i = glm::dot(d, m);
        if (cos_i < 1e-3 || transmitted_cos2(cos_i, eta) < 1e-6) continue;
        const glm::vec3 t = refract(wo, n, eta);
        const glm::dvec3 e(t);
        ++transmitted;
        length_error = std::max(length_error, std::abs(glm::length(e) - 1.0));
        const glm::dvec3 sin_i = glm::cross(m, d), sin_t = glm::cross(e, m);
        // Both crosses are normals of the plane of incidence: equal up to eta means Snell's law and one common plane.
        snell_error = std::max(snell_error, std::abs(eta * glm::length(sin_i) - glm::length(sin_t)));
        plane_error = std::max(plane_error, glm::length(eta * sin_i - sin_t));
        const double cos_t = -glm::dot(e, m);
        if (cos_t < 0.1 || cos_i < 0.1) continue;  // grazing rays magnify the rounding of t by 1/cos
        way_back = std::max(way_back, glm::length(glm::dvec3(refract(t, -n, 1.0 / eta)) - d));
    }
    EXPECT_GT(transmitted, 1000000);
    EXPECT_LE(length_error, 4.0 * kFloatUlp);
    EXPECT_LE(snell_error, 1e-6);
    EXPECT_LE(plane_error, 1e-6);
    EXPECT_LE(way_back, 1e-5);
}

TEST(Fresnel, S_REF_01_ACornerReflectorReturnsEveryRay) {
    Random random(11);
    for (int i = 0; i < 100000; ++i) {
        const glm::vec3 wo(random.direction());
        // Axis-aligned mirrors only change signs: bit-exact.
        glm::vec3 d = wo;
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 n(0.0f);
            n[axis] = 1.0f;
            d = -reflect(d, n);
        }
        ASSERT_EQ(d, -wo);
    }
    // A rotated corner: each rounded normal is off by up to half a unit, which a reflection doubles.
    double worst = 0.0;
    for (int i = 0; i < 100000; ++i) {
        const glm::dvec3 x = random.direction();
        const glm::dvec3 y = glm::normalize(glm::cross(x, random.direction()));
        const glm::dvec3 corner[3] = {x, y, glm::cross(x, y)};
        const glm::vec3 wo(random.direction());
        glm::vec3 d = wo;
        for (const glm::dvec3& n : corner) d = -reflect(d, glm::vec3(n));
        for (int axis = 0; axis < 3; ++axis)
            worst = std::max(worst, std::abs(static_cast<double>(d[axis]) + static_cast<double>(wo[axis])));
    }
    EXPECT_LE(worst, 8.0 * kFloatUlp);
}

TEST(Fresnel, S_REF_01_ThreeMirrorPlanesReturnTheRay) {
    SceneBuilder b;
    const std::uint32_t silver = b.add_material(mirror(1.0f));
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 n(0.0);
        n[axis] = 1.0;
        b.add(plane_at(glm::dvec3(0.0), n), silver);
    }
    b.scene().environment.color = glm::vec3(1.0f);
    Probe probe(b.finish(), centred());
    Random random(12);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 d = -glm::vec3(glm::abs(random.direction()));
        const Ray ray{glm::vec3(random.uniform(1, 2), random.uniform(1, 2), random.uniform(1, 2)), d, kInfinity};
        EXPECT_EQ(probe.radiance(ray).x, 1.0);
        ASSERT_EQ(probe.rays().size(), 4u);
        EXPECT_EQ(probe.rays().back().direction, -d);
    }
}

}  // namespace
}  // namespace glint
