// The camera: pixels, windows and silhouettes of the pinhole, focus and blur of the thin lens.
#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// From the origin along -z, as wide as high.
CameraPose lens_camera(float lens_radius, float focus_distance, float view_angle = 90.0f) {
    CameraPose c = camera_at(glm::vec3(0.0f), {0, 0, -1}, view_angle);
    c.lens_radius = lens_radius;
    c.focus_distance = focus_distance;
    return c;
}

// Where a ray meets the plane at distance `s` before the camera, in units of the tangent (x / s).
glm::dvec2 tangent_at(const Ray& ray, double s) {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    return glm::dvec2(o + d * ((-s - o.z) / d.z)) / s;
}

template <class Visit>
void for_lens_points(const Visit& visit) {
    for (int i = 0; i < 64; ++i) visit(disk_from_square((glm::vec2(i % 8, i / 8) + 0.5f) / 8.0f));
    for (int i = 0; i < 16; ++i) visit(glm::vec2(std::cos(kPi * i / 8.0), std::sin(kPi * i / 8.0)));
}

TEST(Lens, S_DOF_01_ThePlaneAtTheFocusDistanceAlongTheAxisIsSharp) {
    const Camera camera(lens_camera(0.1f, 4.0f), 64, 64);
    double worst = 0.0;
    for (const float x : {0.0f, 13.5f, 32.0f, 63.5f, 64.0f}) {
        for (const float y : {0.0f, 32.0f, 64.0f}) {
            const glm::dvec2 sharp = tangent_at(camera.ray(x, y, glm::vec2(0.0f)), 4.0);
            for_lens_points(
                [&](glm::vec2 lens) { worst = std::max(worst, glm::length(tangent_at(camera.ray(x, y, lens), 4.0) - sharp)); });
        }
    }
    EXPECT_LE(worst, 1e-6);  // focused by the ray's length, the corner would blur to 0.0414 / 4
}

TEST(Lens, O_DOF_01_BlurOfAPoint) {
    constexpr double kRows[][2] = {{2, .025}, {3, .0083333}, {6, .0083333}, {8, .0125}, {1e6, .025}};
    for (const auto& row : kRows) {
        for (const float radius : {0.1f, 0.2f}) {
            const Camera camera(lens_camera(radius, 4.0f), 64, 64);
            for (const float x : {32.0f, 64.0f}) {
                const glm::dvec2 centre = tangent_at(camera.ray(x, 32.0f, glm::vec2(0.0f)), row[0]);
                double largest = 0.0;
                for_lens_points([&](glm::vec2 lens) {
                    const double blur = glm::length(tangent_at(camera.ray(x, 32.0f, lens), row[0]) - centre);
                    largest = std::max(largest, blur);
                    // Each lens point moves the picture in proportion, so a uniform disk stays one.
                    EXPECT_NEAR(blur, row[1] * static_cast<double>(radius) / 0.1 * static_cast<double>(glm::length(lens)), 1e-6);
                });
                EXPECT_NEAR(largest, row[1] * static_cast<double>(radius) / 0.1, 1e-6) << row[0];
            }
        }
    }
}

struct Spot {
    double energy = 0.0, mean_square = 0.0;
};

// A small glowing ball on the axis at distance 8, rendered: its light and the mean square of its distance from the axis in
// units of the tangent.
Spot render_spot(float lens_radius) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -8}, 0.06f}, b.add_material(emitter(1.0f)));
    RenderSettings settings;
    settings.features = without(FeatureSet::all(), {Feature::soft});
    settings.features.set(Feature::dof, lens_radius > 0.0f);
    constexpr int kSide = 64;
    const float angle = 6.0f;
    const Image image = render(b.finish(), lens_camera(lens_radius, 4.0f, angle), settings, {kSide, kSide, 256}).image;
    const double half = std::tan(radians(3.0));
    Spot spot;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const auto light = static_cast<double>(image.at(x, y).x);
            const double u = (2.0 * (x + 0.5) / kSide - 1.0) * half, v = (2.0 * (y + 0.5) / kSide - 1.0) * half;
            spot.energy += light / (kSide * kSide);
            spot.mean_square += light / (kSide * kSide) * (u * u + v * v);
        }
    }
    spot.mean_square /= spot.energy;
    return spot;
}

TEST(Lens, S_DOF_04_S_DOF_05_ADefocusedPointKeepsItsLightAndBlursByTheRadius) {
    const Spot sharp = render_spot(0.0f);
    const double half = std::tan(radians(3.0));
    EXPECT_NEAR(sharp.energy / (kPi * std::pow(0.06 / 8.0, 2) / (4.0 * half * half)), 1.0, 3e-3);
    for (const float radius : {0.1f, 0.2f}) {
        const Spot blurred = render_spot(radius);
        // The mean square of a uniform disk is half its radius squared; blur and ball add.
        const double blur = std::sqrt(2.0 * (blurred.mean_square - sharp.mean_square));
        note(fmt::format("blur_{}", radius), blur);
        note(fmt::format("energy_{}", radius), blurred.energy / sharp.energy);
        EXPECT_NEAR(blur / (static_cast<double>(radius) * (8.0 - 4.0) / (8.0 * 4.0)), 1.0, 3e-3);
        EXPECT_NEAR(blurred.energy / sharp.energy, 1.0, 3e-3);
    }
}

TEST(Lens, S_DOF_02_ALensThatIsOffIsAPinhole) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -3}, 1.0f}, b.add_material(mirror(0.9f, 0.2f)));
    b.scene().environment.kind = Environment::Kind::sky;
    b.scene().cameras.push_back(lens_camera(0.0f, 2.0f));
    const auto scene = b.finish();
    RenderSettings off;
    off.features.set(Feature::dof, false);
    const Image pinhole = render(scene, lens_camera(0.0f, 0.0f), off, {32, 32, 4}).image;
    EXPECT_TRUE(same_bits(render(scene, lens_camera(0.1f, 4.0f), off, {32, 32, 4}).image, pinhole));
    RenderSettings on;
    EXPECT_FALSE(same_bits(render(scene, lens_camera(0.1f, 4.0f), on, {32, 32, 4}).image, pinhole));
    // A lens in focus of everything there is changes no hit: what it draws disturbs no other dimension.
    const Camera none(lens_camera(0.0f, 4.0f), 32, 32), lens(lens_camera(0.1f, 4.0f), 32, 32);
    EXPECT_FALSE(none.has_lens());
    const Ray a = none.ray(3.7f, 9.1f, {0.3f, 0.4f}), c = none.ray(3.7f, 9.1f, glm::vec2(0.0f));
    EXPECT_EQ(a.origin, c.origin);
    EXPECT_EQ(a.direction, c.direction);
    EXPECT_NE(lens.ray(3.7f, 9.1f, {0.3f, 0.4f}).origin, a.origin);
}

TEST(Lens, S_DOF_03_LensPointsAreUniformInTheDisk) {
    constexpr int kPoints = 1 << 18;
    constexpr int kCells = 16;
    std::vector<int> count(kCells * kCells);
    double r1 = 0.0, r2 = 0.0, x1 = 0.0, y1 = 0.0;
    for (int i = 0; i < kPoints; ++i) {
        const Sampler sampler(SamplerKind::random, 3, 4, static_cast<std::uint64_t>(i), 5);
        const glm::dvec2 p(disk_from_square(sampler.square(dimension::lens)));
        const double r = glm::length(p);
        ASSERT_LE(r, 1.0 + 0x1p-23);
        r1 += r, r2 += r * r, x1 += p.x, y1 += p.y;
        // Equal areas: rings of equal r^2, sectors of equal angle.
        const int ring = std::min(kCells - 1, static_cast<int>(r * r * kCells));
        const int sector = std::min(kCells - 1, static_cast<int>((std::atan2(p.y, p.x) / (2.0 * kPi) + 0.5) * kCells));
        ++count[static_cast<std::size_t>(ring * kCells + sector)];
    }
    // Variances of r, r^2, x under the uniform disk: 1/18, 1/12, 1/4.
    const double n = kPoints;
    EXPECT_NEAR(r1 / n, 2.0 / 3.0, 3.0 * std::sqrt(1.0 / 18.0 / n));
    EXPECT_NEAR(r2 / n, 0.5, 3.0 * std::sqrt(1.0 / 12.0 / n));
    EXPECT_NEAR(x1 / n, 0.0, 3.0 * std::sqrt(0.25 / n));
    EXPECT_NEAR(y1 / n, 0.0, 3.0 * std::sqrt(0.25 / n));
    const double expected = n / (kCells * kCells);
    double chi2 = 0.0;
    for (const int c : count) chi2 += (c - expected) * (c - expected) / expected;
    const double freedom = kCells * kCells - 1;
    EXPECT_NEAR(chi2, freedom, 3.0 * std::sqrt(2.0 * freedom));
}

TEST(Camera, S_CAM_01_DegenerateViewsGiveFiniteUnitRays) {
    for (const glm::vec3 target : {glm::vec3(0, 5, 0), glm::vec3(0, -5, 0), glm::vec3(0, 5, 1e-30f), glm::vec3(3, 1e-20f, 0)}) {
        for (const float angle : {1e-3f, 45.0f, 179.9f}) {
            for (const auto& [w, h] : {std::pair(1, 1), std::pair(1, 7), std::pair(333, 1), std::pair(1921, 1081)}) {
                const Camera camera(camera_at(glm::vec3(0.0f), target, angle), w, h);
                const auto fw = static_cast<float>(w), fh = static_cast<float>(h);
                for (const glm::vec2 at : {glm::vec2(0, 0), glm::vec2(fw, fh), glm::vec2(fw, 0), 0.5f * glm::vec2(fw, fh)}) {
                    const glm::dvec3 d(camera.ray(at.x, at.y, glm::vec2(0.0f)).direction);
                    ASSERT_NEAR(glm::length(d), 1.0, 2e-7);
                }
                const glm::dvec3 middle(camera.ray(0.5f * fw, 0.5f * fh, glm::vec2(0.0f)).direction);
                EXPECT_LE(glm::length(middle - glm::normalize(glm::dvec3(target))), 2e-7);
            }
        }
    }
}

// Squares of the size of a pixel, every second one glowing: each pixel shows its own square and nothing of its neighbours.
TEST(Camera, S_CAM_02_APixelCoversExactlyItsSquare) {
    constexpr int kSide = 16;
    SceneBuilder b;
    const std::uint32_t light = b.add_material(emitter(1.0f));
    for (int y = 0; y < kSide; ++y) {
        for (int x = (y + 1) % 2; x < kSide; x += 2) {
            add_quad(b, glm::vec3(x - kSide / 2, kSide / 2 - y - 1, -kSide / 2), {1, 0, 0}, {0, 1, 0}, light);
        }
    }
    RenderSettings settings;
    settings.features = without(FeatureSet::all(), {Feature::soft, Feature::dof});
    const Image image = render(b.finish(), camera_at(glm::vec3(0.0f), {0, 0, -1}, 90.0f), settings, {kSide, kSide, 1024}).image;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) ASSERT_EQ(image.at(x, y).x, (x + y) % 2 == 1 ? 1.0f : 0.0f) << x << ' ' << y;
    }
}

TEST(Camera, O_SIL_01_TheAreaOfASpheresImage) {
    struct Row {
        glm::vec3 center;
        float radius, view_angle;
        double area;
    };
    for (const Row& row :
         {Row{{0, 0, 5}, 1, 60, .130899694}, {{3, 0, 5}, 1, 90, .153493497}, {{2, 2, 4}, 1.5, 120, .646558721}}) {
        SceneBuilder b;
        b.add(Sphere{row.center, row.radius}, b.add_material(emitter(1.0f)));
        RenderSettings settings;
        settings.features = without(FeatureSet::all(), {Feature::soft, Feature::dof});
        const Image image =
            render(b.finish(), camera_at(glm::vec3(0.0f), {0, 0, 1}, row.view_angle), settings, {128, 128, 64}).image;
        const double window = std::pow(2.0 * std::tan(radians(static_cast<double>(row.view_angle) / 2.0)), 2);
        note(fmt::format("area_{}", row.area), mean_of(image) * window);
        EXPECT_NEAR(mean_of(image) * window / row.area, 1.0, 1e-3);
    }
}

}  // namespace
}  // namespace glint
