// Where light ends on meshes with normals at their corners: as on the round body that they stand for, and never behind a surface.
#include <gtest/gtest.h>

#include "core/direct_light.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"
#include "tests/smooth_mesh.h"

namespace glint {
namespace {

using namespace test;

constexpr RoundBody kBall{0.0, 1.0}, kRing{1.0, 0.45};
const glm::vec3 kLamp(-6.0f, 3.0f, -0.6f);

std::shared_ptr<const Scene> round_scene(const RoundBody& body, int columns, int rows, std::vector<Light> lights,
                                         bool normals = true) {
    SceneBuilder b;
    const auto same_place = [](glm::dvec3 p) { return glm::vec3(p); };
    add_round_mesh(b, body, columns, rows, b.add_material(matte(1.0f)), same_place, normals);
    b.scene().lights = std::move(lights);
    b.scene().cameras = {camera_at({0, 2.6f, 4.0f}, {0, 0, 0}, 36.0f)};
    return b.finish();
}

// Of every kind: rays that start at the light and at the surface, near and far, small and large.
std::vector<Light> every_light() {
    std::vector<Light> lights{point_light(kLamp), point_light(200.0f * kLamp), sun(glm::dvec3(kLamp)), point_light(kLamp),
                              point_light(kLamp)};
    lights[3].shape = Light::Shape::sphere, lights[3].radius = 0.7f;
    lights[4].shape = Light::Shape::quad, lights[4].edge1 = {0, 0.5f, 0.5f}, lights[4].edge2 = {0.3f, 0, 0.5f};
    for (std::size_t i = 3; i < 5; ++i) lights[i].falloff = Light::Falloff::physical, lights[i].emission = glm::vec3(40.0f);
    return lights;
}

struct Terminator {
    int lit = 0;         // points of the mesh where the round body clearly sees the lamp
    int black = 0;       // those among them without any light
    int leaks = 0;       // points with light where the interpolated normal has turned away
    double error = 0.0;  // of the light at all points that are seen well, root mean square
};

// As the product lights the mesh, or as a textbook does, by the facets' planes.
Terminator measure(const RoundBody& body, const std::shared_ptr<const Scene>& scene, bool textbook) {
    const CameraPose& pose = scene->cameras.front();
    const int size = 192;
    const Image image = render(scene, pose, centred(), {size, size}).image;
    const Bvh tree(scene->geometry);
    const Camera camera(pose, size, size);
    Terminator t;
    double squares = 0.0;
    int points = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, glm::vec2(0.0f));
            const Hit hit = tree.closest_hit(ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*scene, ray, hit);
            const glm::dvec3 p = body.nearest(glm::dvec3(s.p)), n = body.normal(p), l = glm::normalize(glm::dvec3(kLamp) - p);
            // At the silhouette even the interpolated normal shows the mesh.
            if (glm::dot(n, glm::dvec3(ray.direction)) > -0.3) continue;
            double light = static_cast<double>(image.at(x, y).x);
            const glm::vec3 wi = glm::normalize(kLamp - s.p);
            t.leaks += light > 0.0 && !(glm::dot(s.ns, wi) > 0.0f) ? 1 : 0;
            if (textbook && !(glm::dot(s.ng, wi) > 0.0f)) light = 0.0;
            const bool clear = body.sees(p, glm::dvec3(kLamp), 0.05) && glm::dot(s.ns, wi) > 0.05f;
            t.lit += clear ? 1 : 0;
            t.black += clear && !(light > 0.0) ? 1 : 0;
            const double exact = body.sees(p, glm::dvec3(kLamp), 0.0) ? glm::dot(n, l) : 0.0;
            squares += (light - exact) * (light - exact);
            ++points;
        }
    }
    t.error = std::sqrt(squares / points);
    return t;
}

TEST(Terminator, S_TRM_01_NoFacetOfARoundBodyIsCutOff) {
    for (const RoundBody& body : {kBall, kRing}) {
        for (const int columns : {16, 24, 48, 96}) {
            const auto scene = round_scene(body, columns, columns / 2, {point_light(kLamp)});
            const Terminator ours = measure(body, scene, false), textbook = measure(body, scene, true);
            EXPECT_GT(ours.lit, 2000);
            EXPECT_EQ(ours.black, 0) << columns << " of " << ours.lit;
            EXPECT_EQ(ours.leaks, 0) << columns;
            if (columns <= 24) {
                EXPECT_GT(textbook.black, ours.lit / 100) << columns;
            }
        }
    }
}

// The interpolated normal errs by the square of a facet's angle, the staircase by the angle itself.
TEST(Terminator, S_TRM_01_ABallConvergesToTheRoundOneAsFacetsShrink) {
    double before = 0.0;
    for (const int columns : {12, 24, 48, 96}) {
        const auto scene = round_scene(kBall, columns, columns / 2, {point_light(kLamp)});
        const Terminator ours = measure(kBall, scene, false), textbook = measure(kBall, scene, true);
        note(fmt::format("error_{}", columns), ours.error);
        note(fmt::format("textbook_{}", columns), textbook.error);
        EXPECT_LT(ours.error, 0.5 * textbook.error) << columns;
        if (before > 0.0) {
            EXPECT_LT(ours.error, 0.35 * before) << columns;
        }
        before = ours.error;
    }
}

// No light at all along these rays, whatever the lamp.
void expect_dark(const char* what, std::shared_ptr<const Scene> scene, const std::vector<Ray>& rays) {
    for (std::size_t i = 0; i < every_light().size(); ++i) {
        auto lit = std::make_shared<Scene>(*scene);
        lit->lights = {every_light()[i]};
        RenderSettings settings = centred();
        settings.features.set(Feature::soft, true);
        Probe probe(lit, settings);
        int leaks = 0;
        for (const Ray& ray : rays) leaks += probe.radiance(ray).x > 0.0 ? 1 : 0;
        EXPECT_EQ(leaks, 0) << what << " of " << rays.size() << ", light " << i;
    }
}

TEST(Terminator, S_TRM_01_ARoundMeshIsDarkInside) {
    Random random(1);
    for (const int columns : {8, 16, 48}) {
        for (const RoundBody& body : {kBall, kRing}) {
            std::vector<Ray> rays;
            for (int i = 0; i < 3000; ++i) {
                const double phi = random.uniform(0.0, 2.0 * kPi);
                const glm::dvec3 inside = body.ring * glm::dvec3(std::cos(phi), 0.0, std::sin(phi));
                rays.push_back({glm::vec3(inside + 0.5 * body.tube * random.direction()), glm::vec3(random.direction())});
            }
            expect_dark(body.ring > 0.0 ? "ring" : "ball", round_scene(body, columns, columns / 2, {}), rays);
        }
    }
}

// The tangent planes put points outside this shell, but no light gets in to come down from there.
TEST(Terminator, S_TRM_01_ABallCloseUnderAShellStaysDark) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    add_round_mesh(b, kBall, 12, 6, m);
    b.add(Sphere{glm::vec3(0.0f), 1.001f}, m);
    const auto scene = b.finish();
    const BruteForce geometry(scene->geometry);
    Random random(2);
    std::vector<Ray> rays;
    int lifted_out = 0;
    while (rays.size() < 5000) {
        const glm::dvec3 n = random.direction();
        const Ray out{glm::vec3(0.0f), glm::vec3(n)};
        const Ray down{glm::vec3((static_cast<double>(geometry.closest_hit(out).t) + 1e-4) * n), glm::vec3(-n)};
        const Hit hit = geometry.closest_hit(down);
        ASSERT_EQ(kind_of(hit.primitive), PrimitiveKind::triangle);
        lifted_out += glm::length(lifted(surface_point(*scene, down, hit)).p) > 1.001f ? 1 : 0;
        rays.push_back(down);
    }
    EXPECT_GT(lifted_out, 4000);
    expect_dark("shell", scene, rays);
}

// One layer of triangles with a wave's normals, seen from below; all lights stand above it.
TEST(Terminator, S_TRM_01_AThinSheetIsDarkBehind) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(matte(1.0f));
    const int cells = 40;
    const double half = 40.0;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = half * (2.0 * i / cells - 1.0), z = half * (2.0 * j / cells - 1.0);
            const glm::dvec3 n(-0.5 * std::cos(x), 1.0, 0.3 * std::sin(z));
            b.add_vertex(glm::vec3(x, 0.5 * std::sin(x) + 0.3 * std::cos(z), z), glm::vec3(glm::normalize(n)));
        }
    }
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const auto at = [&](int x, int z) { return static_cast<std::uint32_t>((j + z) * (cells + 1) + i + x); };
            b.add_triangle(at(0, 0), at(0, 1), at(1, 1), m);
            b.add_triangle(at(0, 0), at(1, 1), at(1, 0), m);
        }
    }
    Random random(3);
    std::vector<Ray> rays;
    for (int i = 0; i < 5000; ++i) {
        const glm::vec3 below(random.uniform(-4, 4), -3.0, random.uniform(-4, 4));
        rays.push_back({below, glm::vec3(glm::normalize(glm::dvec3(0, 1, 0) + 0.9 * random.direction()))});
    }
    expect_dark("sheet", b.finish(), rays);
}

// A flat face's corners have its own normal: nothing is lifted, and the picture is that of the face without normals.
TEST(Terminator, S_TRM_01_NormalsOfAFlatFaceChangeNothing) {
    const auto roof = [](bool normals) {
        SceneBuilder b;
        const std::uint32_t m = b.add_material(matte(1.0f));
        for (const glm::vec3 n : {glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
            const glm::vec3 x(2, 0, 0), y = glm::cross(n, x);
            for (const glm::vec3 p : {-x - y, x - y, x + y, -x + y}) b.add_vertex(p, normals ? n : glm::vec3(0.0f));
        }
        for (const std::uint32_t i : {0u, 4u}) b.add_triangle(i, i + 1, i + 2, m), b.add_triangle(i, i + 2, i + 3, m);
        b.scene().lights = every_light();
        b.scene().cameras = {camera_at({1, 2.6f, 4.0f}, {0, 0, 0}, 60.0f)};
        return b.finish();
    };
    Picture p;
    p.settings.features = FeatureSet::all();
    EXPECT_EQ(differing_pixels(render_picture(roof(true), p), render_picture(roof(false), p)), 0u);
}

TEST(Terminator, S_TRM_01_SameBitsFromEveryInstructionSetAndAccelerator) {
    Picture p;
    p.settings.features = FeatureSet::all();
    p.spp = 2;
    const auto scene = round_scene(kRing, 24, 12, every_light());
    const Image expected = render_picture(scene, p);
    for_each_isa([&](Isa) {
        for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
            p.accelerator = kind;
            p.threads = kind == AcceleratorKind::grid ? 3 : 1;
            EXPECT_EQ(differing_pixels(expected, render_picture(scene, p)), 0u);
        }
    });
}

TEST(Terminator, S_TRM_01_ScalingByAPowerOfTwoKeepsEveryBit) {
    const auto scaled = [](float size) {
        SceneBuilder b;
        const auto at = [size](glm::dvec3 p) { return size * glm::vec3(p); };
        add_round_mesh(b, kRing, 24, 12, b.add_material(matte(1.0f)), at);
        b.scene().lights = {point_light(size * kLamp), point_light(size * 200.0f * kLamp)};
        return render(b.finish(), camera_at(size * glm::vec3(0, 2.6f, 4.0f), {0, 0, 0}, 36.0f), centred(), {96, 96}).image;
    };
    const Image expected = scaled(1.0f);
    for (const float size : {0x1p-20f, 0x1p-3f, 0x1p20f}) EXPECT_TRUE(same_bits(expected, scaled(size))) << size;
}

// Of an instance that is turned, mirrored and stretched: wherever the normal faces the lamp, a convex body is lit.
TEST(Terminator, S_TRM_01_AStretchedInstanceHasNoStaircase) {
    for (const bool mirrored : {false, true}) {
        SceneBuilder b;
        const std::uint32_t m = b.add_material(matte(1.0f));
        b.begin_prototype();
        add_round_mesh(b, kBall, 16, 8, m);
        glm::dmat4 map(1.0);
        map[0] = {mirrored ? -0.9 : 0.9, 0.3, 0.0, 0.0};
        map[1] = {-0.4, 0.5, 0.2, 0.0};
        map[2] = {0.0, -0.2, 1.6, 0.0};
        map[3] = {0.1, -0.2, 0.3, 1.0};
        ASSERT_TRUE(b.place(b.end_prototype(), map));
        b.scene().lights = {point_light(kLamp)};
        const auto scene = b.finish();
        const Bvh tree(scene->geometry);
        Probe probe(scene, centred());
        Random random(4);
        int lit = 0, black = 0, cut = 0;
        for (int i = 0; i < 40000; ++i) {
            const glm::vec3 eye(6.0 * random.direction());
            const Ray ray{eye, glm::vec3(glm::normalize(0.8 * random.direction() - glm::dvec3(eye)))};
            const Hit hit = tree.closest_hit(ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*scene, ray, hit);
            const glm::vec3 wi = glm::normalize(kLamp - s.p);
            // Past the silhouette the facet's own normal counts, and there is no lift.
            if (!(glm::dot(s.ns, wi) > 0.02f) || s.lift == glm::vec3(0.0f)) continue;
            ++lit;
            black += probe.radiance(ray).x > 0.0 ? 0 : 1;
            cut += glm::dot(s.ng, wi) > 0.0f ? 0 : 1;
        }
        EXPECT_GT(lit, 10000);
        EXPECT_GT(cut, lit / 100);
        EXPECT_EQ(black, 0) << "of " << lit << (mirrored ? ", mirrored" : "");
    }
}

}  // namespace
}  // namespace glint
