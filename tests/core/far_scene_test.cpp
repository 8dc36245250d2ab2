// Scenes far from zero: moved by a vector that their numbers can express they keep every bit of their picture, and what an
// absolute rounding would swallow out there (thin walls, small steps, closed meshes) still holds.
#include <gtest/gtest.h>

#include "tests/accel/adversarial_scenes.h"
#include "tests/core/p3f_text.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

// A position in a scene that is moved by t; exact for multiples of 2^-24 up to some 10^6.
std::string at(glm::dvec3 p, glm::dvec3 t) { return fmt::format(" {} {} {}", p.x + t.x, p.y + t.y, p.z + t.z); }

// Every shape, light, material and lens that P3F knows, within a cube of side 2.5.
std::string everything(glm::dvec3 t) {
    std::string s = "v from" + at({0.75, 1.5, 4}, t) + " at" + at({0, 0, 0}, t) +
                    " up 0 1 0 angle 40 hither 1 resolution 48 48 aperture 8 focal 1 b 0.2 0.3 0.4";
    s += " l" + at({2, 3, 1}, t) + " 0.6 0.5 0.4";
    s += " light quad" + at({-1, 2, 0}, t) + " 0.4 0.5 0.6" + at({-0.5, 2, 0}, t) + at({-1, 2, 0.5}, t) + " 4";
    const std::string matte = " f 0.9 0.5 0.3 0.7 1 1 1 0 20 0 1", mirror = " f 0.2 0.2 0.2 0.5 1 1 1 0.6 50 0 1 0.0625",
                      clear = " f 0 0 0 0 1 1 1 0.2 50 1 1.5";
    // No face lies in another: which one is nearer would be a matter of the last bit.
    s += matte + " pl" + at({0, -1.375, 0}, t) + at({0, -1.375, 1}, t) + at({1, -1.375, 0}, t);
    s += " npl 0 0 1 " + fmt::format("{}", 3.0 - t.z);
    s += " box" + at({-1.25, -1.25, -1}, t) + at({-0.5, -0.5, -0.25}, t);
    s += " p 4" + at({0.25, -1, 0.25}, t) + at({1.25, -1, 0.25}, t) + at({1.25, -0.5, -0.5}, t) + at({0.25, -0.5, -0.5}, t);
    s += mirror + " s" + at({0.5, 0.25, -0.5}, t) + " 0.5 c" + at({1, -1.25, 0.75}, t) + " 0.25" + at({1, 0, 0.75}, t) + " 0.125";
    s += " mesh 4 3" + at({-1, 0.5, -1}, t) + at({0, 0.5, -1.25}, t) + at({-0.5, 1.25, -1}, t) + at({-0.25, 0.75, -0.5}, t) +
         " 1 2 3 1 2 4 2 3 4";
    s += clear + " s" + at({-0.25, -0.5, 0.625}, t) + " 0.375 box" + at({0.25, -1.25, 0.5}, t) + at({0.625, -0.75, 0.875}, t);
    s += " pp 3" + at({-1.25, -1, 0.5}, t) + " 0 0 1" + at({-0.75, -1, 0.5}, t) + " 0 0.25 1" + at({-1, 0, 0.25}, t) + " 0 0 1";
    return s;
}

// A scene without falloff as text; positions are rounded to 2^-24, so that moved ones have as many digits.
std::string written(const Scene& scene, glm::dvec3 t) {
    const auto p = [t](glm::vec3 v) { return at(glm::round(glm::dvec3(v) * 0x1p24) * 0x1p-24, t); };
    const CameraPose& c = scene.cameras.front();
    std::string s = "v from" + p(c.eye) + " at" + p(c.target) + " up" + at(glm::dvec3(c.up), {}) +
                    fmt::format(" angle {} hither 1 resolution 64 64 b", c.view_angle) +
                    at(glm::dvec3(scene.environment.color), {});
    for (const Light& l : scene.lights) s += " l" + p(l.position) + at(glm::dvec3(l.emission), {});
    const Geometry& g = *scene.geometry;
    std::uint32_t used = ~0u;
    const auto material = [&](PrimitiveId id) {
        const std::uint32_t index = scene.Surfaces::material(id);
        if (std::exchange(used, index) == index) return;
        const Material& m = scene.materials[index];
        s += " f" + at(glm::dvec3(m.diffuse), {}) + " 1" + at(glm::dvec3(m.specular), {}) +
             fmt::format(" 1 {} {} {}", m.shininess, m.glass ? 1 : 0, m.ior);
    };
    for (std::uint32_t i = 0; i < g.triangles.size(); ++i) {
        material(make_id(PrimitiveKind::triangle, i));
        s += " p 3";
        for (const std::uint32_t v : g.triangles[i]) s += p(g.vertices[v]);
    }
    for (std::uint32_t i = 0; i < g.spheres.size(); ++i) {
        material(make_id(PrimitiveKind::sphere, i));
        s += " s" + p(g.spheres[i].center) + fmt::format(" {}", g.spheres[i].radius);
    }
    for (std::uint32_t i = 0; i < g.boxes.size(); ++i) {
        material(make_id(PrimitiveKind::box, i));
        s += " box" + p(g.boxes[i].lo) + p(g.boxes[i].hi);
    }
    return s;
}

Picture all_features() {
    Picture p;
    p.width = p.height = 48;
    p.spp = 4;
    p.settings.features = FeatureSet::all();
    return p;
}

// Nodes that the camera's rays through a grid of pixels visit.
std::uint64_t nodes_visited(const Scene& scene) {
    const Bvh bvh(scene.geometry);
    const Camera camera(scene.cameras.front(), 16, 16);
    RayBatch batch;
    batch.clear(RayOrder::divergent);
    for (int i = 0; i < 256; ++i) {
        batch.push(camera.ray(static_cast<float>(i % 16) + 0.5f, static_cast<float>(i / 16) + 0.5f, glm::vec2(0.0f)));
    }
    return bvh.count_traversal(batch).nodes;
}

void expect_same_picture(const std::shared_ptr<const Scene>& here, const std::shared_ptr<const Scene>& there, glm::dvec3 t) {
    EXPECT_EQ(here->origin, glm::dvec3(0.0));
    EXPECT_EQ(there->origin, t);
    EXPECT_EQ(here->geometry->vertices, there->geometry->vertices);
    EXPECT_EQ(here->lights, there->lights);
    EXPECT_EQ(here->cameras, there->cameras);
    EXPECT_EQ(here->warnings, there->warnings);
    Picture p = all_features();
    Progress near, far;
    const Image expected = render_picture(here, p, &near);
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        p.accelerator = kind;
        EXPECT_EQ(differing_pixels(expected, render_picture(there, p, &far)), 0u) << t.x << ' ' << static_cast<int>(kind);
        EXPECT_EQ(near.rays.total(), far.rays.total());
        EXPECT_EQ(far.rays.non_finite, 0u);
    }
    EXPECT_EQ(nodes_visited(*here), nodes_visited(*there));
}

TEST(FarScene, S_MET_03_EveryFeatureKeepsItsBitsFarOut) {
    const auto here = read_text(everything({}));
    for (const glm::dvec3 t : {glm::dvec3(1000, -2000, 5000), glm::dvec3(1e6, -2e6, 5e5), glm::dvec3(0, 0, 0x1p27)}) {
        expect_same_picture(here, read_text(everything(t)), t);
    }
}

TEST(FarScene, S_MET_03_BuiltInScenesKeepTheirBitsFarOut) {
    for (const char* name : {"balls,level=2", "mount,level=3", "balls_box", "dof"}) {
        const auto scene = reader::make_builtin(name);
        const auto here = read_text(written(*scene, {}));
        for (const double t : {0x1p12, 0x1p20}) {
            SCOPED_TRACE(name);
            expect_same_picture(here, read_text(written(*scene, {t, -t, 3.0 * t})), {t, -t, 3.0 * t});
        }
    }
}

// Where the vector is no multiple of the step, positions are rounded anew: as near zero, not as far out.
TEST(FarScene, S_MET_03_AnyVectorLeavesThePictureNearlyTheSame) {
    const auto here = read_text(everything({}));
    Picture p = all_features();
    p.settings.features = FeatureSet::whitted();
    p.spp = 1;
    const Image expected = render_picture(here, p);
    for (const double size : {1e2, 1e4, 1e6, 1e9}) {
        const auto there = read_text(everything(size * glm::dvec3(1.234567, -0.7654321, 0.3456789)));
        const Image moved = render_picture(there, p);
        const ImageDifference d = difference(expected, moved);
        note(fmt::format("rmse_{:g}", size), d.rmse);
        EXPECT_LE(d.rmse, 1e-6) << size;
        EXPECT_LE(d.max, 1e-4) << size;
        EXPECT_NEAR(static_cast<double>(nodes_visited(*there)), static_cast<double>(nodes_visited(*here)),
                    0.01 * static_cast<double>(nodes_visited(*here)));
    }
}

// A wall on a floor between it and a light; no thickness: a sheet. All others are 8 units long.
std::string wall(glm::dvec3 t, double thickness, bool soft) {
    std::string s =
        "v from" + at({-3, 3, 0}, t) + " at" + at({0, 0, 0}, t) + " up 0 1 0 angle 40 hither 1 resolution 8 8 b 0 0 0";
    s += soft ? " light quad" + at({2, 2, 0}, t) + " 1 1 1" + at({2, 2.5, 0}, t) + at({2, 2, 0.5}, t) + " 4"
              : " l" + at({2, 2.5, 0}, t) + " 1 1 1";
    s += " f 1 1 1 1 0 1 0 1 p 4" + at({-4, 0, -4}, t) + at({-4, 0, 4}, t) + at({4, 0, 4}, t) + at({4, 0, -4}, t);
    return s + (thickness > 0.0 ? " box" + at({0, 0, -4}, t) + at({thickness, 3, 4}, t)
                                : " p 4" + at({0, 0, -4}, t) + at({0, 0, 4}, t) + at({0, 3, 4}, t) + at({0, 3, -4}, t));
}

// The points at the wall's foot behind it are dark, those before it are lit.
TEST(FarScene, S_OFF_04_AThinWallLeaksNoLightAtItsFoot) {
    int dark = 0, lit = 0;
    for (const double distance : {0.0, 1e3, 1e6, 1e6 + 0.3}) {
        const glm::dvec3 t = distance * glm::dvec3(1.0, 0.7, -0.4);
        for (const double thickness : {0.0, 8e-6, 8e-4, 8e-2}) {
            for (const bool soft : {false, true}) {
                const auto scene = read_text(wall(t, thickness, soft));
                Probe probe(scene);
                test::Random random(4);
                for (int i = 0; i < 150; ++i) {
                    const double delta = i < 50 ? 8e-2 : i < 100 ? 8e-4 : 8e-6;
                    const double side = i % 2 == 0 ? -1.0 : 1.0, z = random.uniform(-3.0, 3.0);
                    const glm::dvec3 point(side < 0.0 ? -delta : thickness + delta, 0.0, z);
                    const glm::vec3 eye = scene->local(glm::dvec3(3.0 * side, 3.0, 0.5 * z) + t);
                    const glm::vec3 to((point + t - scene->origin) - glm::dvec3(eye));
                    const double seen = probe.radiance(eye, to, static_cast<std::uint64_t>(i)).x;
                    dark += side < 0.0 && seen == 0.0 ? 1 : 0;
                    lit += side > 0.0 && seen > 0.2 ? 1 : 0;
                    EXPECT_TRUE(side < 0.0 ? seen == 0.0 : seen > 0.2)
                        << seen << " at " << distance << ", wall " << thickness << ", point " << delta * side;
                }
            }
        }
    }
    EXPECT_EQ(dark, 2400);
    EXPECT_EQ(lit, 2400);
}

std::string ply_text(const Geometry& g, glm::dvec3 t) {
    std::string s = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n"
        "property list uchar int vertex_indices\nend_header\n",
        g.vertices.size(), g.triangles.size());
    for (const glm::vec3 v : g.vertices) s += at(glm::round(glm::dvec3(v) * 0x1p24) * 0x1p-24, t) + "\n";
    for (const auto& f : g.triangles) s += fmt::format("3 {} {} {}\n", f[0], f[1], f[2]);
    return s;
}

TEST(FarScene, S_TRI_09_AClosedMeshFromAFileHoldsEveryRay) {
    const glm::dvec3 center(148376.0, 1234.0, -223423.0);
    const Geometry ball = tessellated_ball(glm::dvec3(0.0), 2.0, 200, 100);
    const TestFolder folder;
    folder.write("ball.ply", ply_text(ball, center));
    const auto scene = reader::read_mesh(folder.path() / "ball.ply");
    // All of the ball arrived: far out its triangles at the poles had no area left.
    EXPECT_EQ(scene->geometry->triangles.size(), ball.triangles.size() + 2);
    const glm::vec3 middle = scene->local(center);
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        const auto accelerator = build_accelerator(kind, scene->geometry);
        test::Random random(9);
        int misses = 0;
        for (int i = 0; i < (kind == AcceleratorKind::none ? 500 : 50000); ++i) {
            const glm::vec3 from(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            const Hit hit = closest_hit(*accelerator, {middle + from, glm::vec3(random.direction()), kInfinity});
            // The last two triangles are the floor's: nobody in the ball sees them.
            misses += hit.found() && index_of(hit.primitive) < ball.triangles.size() ? 0 : 1;
        }
        EXPECT_EQ(misses, 0) << kAcceleratorNames[static_cast<std::size_t>(kind)];
    }
}

TEST(FarScene, S_MET_03_AMeshFileKeepsItsBitsFarOut) {
    const TestFolder folder;
    const Geometry ball = tessellated_ball(glm::dvec3(0.0), 1.0, 40, 20);
    const glm::dvec3 t(1e6, -2e6, 5e5);
    folder.write("here.ply", ply_text(ball, {}));
    folder.write("there.ply", ply_text(ball, t));
    folder.write("packed.p3f", "v from" + at({0, 1, 4}, t) + " at" + at({0, 0, 0}, t) +
                                   " up 0 1 0 angle 40 hither 1 resolution 8 8 l" + at({2, 3, 4}, t) +
                                   " 1 1 1 f 1 1 1 1 0 1 0 1 ply there.ply");
    const auto here = reader::read_mesh(folder.path() / "here.ply");
    expect_same_picture(here, reader::read_mesh(folder.path() / "there.ply"), t);
    const auto included = load_scene((folder.path() / "packed.p3f").string());
    EXPECT_EQ(included->origin, t);
    EXPECT_EQ(std::vector(here->geometry->vertices.begin(), here->geometry->vertices.end() - 4), included->geometry->vertices);
}

// A billion sizes out all corners of a mesh round to a few points; it is read again until its shape is there.
TEST(FarScene, ShapesThatFloatsCannotTellAtAllComeBack) {
    const Geometry ball = tessellated_ball(glm::dvec3(0.0), 1.0, 40, 20);
    const TestFolder folder;
    folder.write("ball.ply", ply_text(ball, {0x1p26, 0x1p26, 0x1p26}));
    EXPECT_EQ(reader::read_mesh(folder.path() / "ball.ply")->geometry->triangles.size(), ball.triangles.size() + 2);
    const glm::dvec3 t(1e12);
    const auto scene =
        read_text("v from" + at({0, 0, 4}, t) + " at" + at({0, 0, 0}, t) + " up 0 1 0 angle 40 hither 1 resolution 8 8 p 3" +
                  at({0, 0, 0}, t) + at({1, 0, 0}, t) + at({0, 1, 0.5}, t));
    ASSERT_EQ(scene->geometry->triangles.size(), 1u);
    EXPECT_EQ(scene->geometry->bounds().size(), glm::vec3(1.0f, 1.0f, 0.5f));
    EXPECT_EQ(scene->cameras.front().target_distance(), 4.0f);
}

// Planes have no bounds: the view tells where their scene is.
TEST(FarScene, APlaneAloneIsRelativeToItsView) {
    const glm::dvec3 t(1e6, -2e6, 5e5);
    const auto text = [](glm::dvec3 by) {
        return "v from" + at({0, 1, 4}, by) + " at" + at({0, 0, 0}, by) + " up 0 1 0 angle 40 hither 1 resolution 8 8 pl" +
               at({0, 0, 0}, by) + at({0, 0, 1}, by) + at({1, 0, 0.5}, by) + " l" + at({2, 3, 4}, by) + " 1 1 1";
    };
    expect_same_picture(read_text(text({})), read_text(text(t)), t);
}

}  // namespace
}  // namespace glint
