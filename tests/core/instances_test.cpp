// Instances in the light: rays that leave them never hit them again, their normals and media are those of the same shape in the
// world, and so are their pictures.
#include <gtest/gtest.h>

#include "core/accelerator_choice.h"
#include "core/direct_light.h"
#include "core/surface_point.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

glm::dmat4 placed(const glm::dmat3& linear, glm::dvec3 shift) {
    glm::dmat4 m(linear);
    m[3] = glm::dvec4(shift, 1.0);
    return m;
}

glm::dmat3 odd_rotation(Random& random) {
    const glm::dvec3 x = random.direction(), y = glm::normalize(glm::cross(x, random.direction()));
    return {x, y, glm::cross(x, y)};
}

glm::dmat3 stretch(double x, double y, double z) { return {x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z}; }

// A primitive about one unit large at the origin of its own space.
void add_unit(SceneBuilder& b, PrimitiveKind kind, std::uint32_t m) {
    switch (kind) {
        case PrimitiveKind::triangle:
            for (const glm::vec3 v : {glm::vec3(-1, -0.5f, 0.2f), glm::vec3(1, -0.7f, -0.3f), glm::vec3(0.1f, 1, 0.4f)})
                b.add_vertex(v);
            b.add_triangle(0, 1, 2, m);
            break;
        case PrimitiveKind::sphere: b.add(Sphere{glm::vec3(0.0f), 1.0f}, m); break;
        case PrimitiveKind::box: b.add(Box{{-0.7f, -0.5f, -0.6f}, {0.7f, 0.5f, 0.6f}}, m); break;
        default: b.add(Cone{{-0.2f, -0.8f, -0.1f}, 0.9f, {0.2f, 0.8f, 0.1f}, 0.3f}, m); break;
    }
}

std::shared_ptr<const Scene> single(PrimitiveKind kind, const glm::dmat4& map) {
    SceneBuilder b;
    const std::uint32_t m = b.add_material(glass(1.5f));
    b.begin_prototype();
    add_unit(b, kind, m);
    EXPECT_TRUE(b.place(b.end_prototype(), map));
    return b.finish();
}

// Turned, mirrored, stretched up to a hundredfold, moved up to 1e5 away.
glm::dmat4 any_map(Random& random, int i) {
    const auto power = [&](double most) { return std::pow(10.0, random.uniform(-most, most)); };
    const double bend = i % 3 == 0 ? 0.0 : 1.0;
    const glm::dmat3 sizes = stretch(power(bend), (i % 2 == 0 ? 1.0 : -1.0) * power(bend), power(bend));
    const double distance = i % 4 == 0 ? 0.0 : std::pow(10.0, i % 4 + 2.0);
    return placed(power(1.0) * odd_rotation(random) * sizes * odd_rotation(random), distance * random.direction());
}

// A surface point of the one instance, seen from outside; found = false where the ray misses.
struct Seen {
    bool found = false;
    Ray ray;
    Hit hit;
    SurfacePoint s{};
};
Seen look_at(const Scene& scene, const Bvh& tree, Random& random) {
    const AffineMap out = inverse(scene.geometry->instances.front().object_from_world);
    const glm::vec3 eye(out.point(10.0 * random.direction()));
    const glm::dvec3 to = out.point(0.5 * random.uniform() * random.direction()) - glm::dvec3(eye);
    Seen seen;
    seen.ray = {eye, glm::vec3(glm::normalize(to)), kInfinity};
    seen.hit = tree.closest_hit(seen.ray);
    seen.found = seen.hit.found();
    if (seen.found) seen.s = surface_point(scene, seen.ray, seen.hit);
    return seen;
}

glm::vec3 hemisphere(Random& random, glm::dvec3 n) {
    glm::dvec3 d = random.direction();
    if (glm::dot(d, n) < 0.0) d -= 2.0 * glm::dot(d, n) * n;
    // A third of the rays graze.
    return glm::vec3(random.uniform() < 0.33 ? glm::normalize(d - 0.999 * glm::dot(d, n) * n) : d);
}

void expect_no_self_hits(PrimitiveKind kind) {
    Random random(static_cast<std::uint32_t>(kind) + 41);
    int rays = 0, self_hits = 0, shadows = 0, self_shadows = 0;
    for (int i = 0; rays < 1000000; ++i) {
        const auto scene = single(kind, any_map(random, i));
        const Bvh tree(scene->geometry);
        for (int points = 0; points < 400; ++points) {
            const Seen seen = look_at(*scene, tree, random);
            const SurfacePoint& s = seen.s;
            // Inside a hollow body the far side is met rightly.
            if (!seen.found || (!s.outside && kind != PrimitiveKind::triangle)) continue;
            for (int k = 0; k < 20; ++k) {
                // All are convex; the triangle is also left on the far side.
                const glm::vec3 side = k % 2 == 1 && kind == PrimitiveKind::triangle ? -s.ng : s.ng;
                ++rays;
                self_hits += tree.occluded({spawn_origin(s, side), hemisphere(random, glm::dvec3(side)), kInfinity}) ? 1 : 0;
            }
            for (int k = 0; k < 4; ++k) {
                const glm::dvec3 d(hemisphere(random, glm::dvec3(s.ng)));
                const double length = std::pow(10.0, random.uniform(-3.0, 5.0));
                const Light light = point_light(glm::vec3(glm::dvec3(s.p) + length * d));
                const glm::dvec3 to = glm::dvec3(light.position) - glm::dvec3(s.p);
                // Where the ray starts above the light it looks down.
                if (!(glm::dot(to, glm::dvec3(s.ng)) > 2.0 * static_cast<double>(s.error) + 4.0 * 0x1p-24 * glm::length(to)))
                    continue;
                const LightSample l = sample_light(light, s.p, glm::vec2(0.5f));
                for (const bool at_light : {false, true}) {
                    ++shadows;
                    self_shadows += tree.occluded(shadow_ray(light, l, s, at_light)) ? 1 : 0;
                }
            }
        }
    }
    EXPECT_EQ(self_hits, 0) << "of " << rays;
    EXPECT_EQ(self_shadows, 0) << "of " << shadows;
    EXPECT_GT(shadows, 100000);
}

TEST(Instances, S_OFF_01_ATriangleNeverHitsItself) { expect_no_self_hits(PrimitiveKind::triangle); }
TEST(Instances, S_OFF_01_ASphereNeverHitsItself) { expect_no_self_hits(PrimitiveKind::sphere); }
TEST(Instances, S_OFF_01_ABoxNeverHitsItself) { expect_no_self_hits(PrimitiveKind::box); }
TEST(Instances, S_OFF_01_AConeNeverHitsItself) { expect_no_self_hits(PrimitiveKind::cone); }

// The offset is no larger than the rounding asks for: a few units of the coordinates, not of the bend.
TEST(Instances, RaysStartCloseToTheSurface) {
    Random random(45);
    for (int i = 0; i < 200; ++i) {
        const auto scene = single(PrimitiveKind::triangle, placed(odd_rotation(random), 1e3 * random.direction()));
        const Bvh tree(scene->geometry);
        const Seen seen = look_at(*scene, tree, random);
        if (!seen.found) continue;
        EXPECT_LT(seen.s.error, 16.0f * 0x1p-24f * 1e3f);
    }
}

// Triangles with normals, as one mesh that is placed or baked: points and normals agree, fronts stay fronts in the mirror.
class Twins {
public:
    explicit Twins(const std::vector<glm::dmat4>& maps) {
        std::vector<glm::vec3> ring;
        for (int i = 0; i < 12; ++i) {
            for (int k = 0; k < 7; ++k) {
                const double phi = kPi * i / 6.0, theta = 0.1 + 2.9 * k / 6.0;
                ring.emplace_back(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            }
        }
        SceneBuilder copies, places;
        for (SceneBuilder* b : {&copies, &places}) {
            materials_[0] = b->add_material(matte(0.6f));
            materials_[1] = b->add_material(mirror(0.8f));
        }
        places.begin_prototype();
        add_mesh(places, ring, placed(glm::dmat3(1.0), glm::dvec3(0.0)));
        const std::uint32_t prototype = places.end_prototype();
        for (const glm::dmat4& map : maps) {
            EXPECT_TRUE(places.place(prototype, map));
            add_mesh(copies, ring, map);
        }
        for (SceneBuilder* b : {&copies, &places}) {
            b->scene().lights.push_back(point_light({6.0f, 9.0f, 8.0f}));
            b->scene().environment.color = glm::vec3(0.3f);
            b->scene().cameras.push_back(camera_at({1.0f, 2.0f, 9.0f}, glm::vec3(0.0f)));
        }
        baked = copies.finish();
        shared = places.finish();
    }
    std::shared_ptr<const Scene> baked, shared;

private:
    void add_mesh(SceneBuilder& b, const std::vector<glm::vec3>& ring, const glm::dmat4& map) const {
        const glm::dmat3 linear(map), normals = glm::transpose(glm::inverse(linear));
        const auto first = static_cast<std::uint32_t>(b.geometry().vertices.size());
        for (const glm::vec3 v : ring)
            b.add_vertex(glm::vec3(map * glm::dvec4(v, 1.0)), glm::vec3(glm::normalize(normals * glm::dvec3(v))));
        const bool mirrored = glm::determinant(linear) < 0.0;
        for (std::uint32_t i = 0; i < 12; ++i) {
            for (std::uint32_t k = 0; k < 6; ++k) {
                const std::uint32_t a = first + 7 * i + k, c = first + 7 * ((i + 1) % 12) + k, m = materials_[k % 2];
                b.add_triangle(a, mirrored ? c + 1 : a + 1, mirrored ? a + 1 : c + 1, m);
                b.add_triangle(a, mirrored ? c : c + 1, mirrored ? c + 1 : c, m);
            }
        }
    }
    std::array<std::uint32_t, 2> materials_{};
};

std::vector<glm::dmat4> five_maps() {
    Random random(46);
    std::vector<glm::dmat4> maps;
    for (int i = 0; i < 5; ++i) {
        const glm::dmat3 linear = odd_rotation(random) * stretch(i % 2 == 0 ? 1.0 : -1.0, 0.7, 1.2) * odd_rotation(random);
        maps.push_back(placed(linear, 2.0 * random.direction()));
    }
    return maps;
}

TEST(Instances, PointsAndNormalsAreThoseOfTheBakedMesh) {
    const Twins twins(five_maps());
    const Bvh baked(twins.baked->geometry), shared(twins.shared->geometry);
    Random random(47);
    int compared = 0, other = 0, bent = 0;
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 eye = 8.0 * random.direction(), to = 2.0 * random.direction() - eye;
        const Ray ray{glm::vec3(eye), glm::vec3(glm::normalize(to)), kInfinity};
        const Hit a = baked.closest_hit(ray), b = shared.closest_hit(ray);
        if (!a.found() || !b.found() || std::abs(a.t - b.t) > 1e-4f) {
            other += a.found() != b.found() || a.found() ? 1 : 0;
            continue;
        }
        const SurfacePoint p = surface_point(*twins.baked, ray, a), q = surface_point(*twins.shared, ray, b);
        ++compared;
        if (p.material != q.material) continue;  // beside an edge
        ASSERT_EQ(p.outside, q.outside);
        ASSERT_LT(glm::length(p.p - q.p), 1e-4f);
        ASSERT_GT(glm::dot(p.ng, q.ng), 0.0f);
        // Normals are interpolated before they are stretched, not after; and at silhouettes a hair decides whether they are used.
        bent += glm::length(p.ns - q.ns) > 0.06f ? 1 : 0;
        ASSERT_EQ(&twins.shared->material(b.primitive), &twins.shared->materials[q.material]);
    }
    EXPECT_GT(compared, 5000);
    EXPECT_LT(other, compared / 100);
    EXPECT_LT(bent, compared / 100);
}

TEST(Instances, AnIdentityGivesThePictureOfTheMeshItself) {
    const Twins twins({placed(glm::dmat3(1.0), glm::dvec3(0.0))});
    for_each_isa([&](Isa) {
        for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
            const Picture p{48, 48, 4, 2, kind, {}};
            EXPECT_EQ(differing_pixels(render_picture(twins.baked, p), render_picture(twins.shared, p)), 0u);
        }
    });
}

TEST(Instances, EveryAcceleratorGivesOnePictureThatIsCloseToTheBakedOne) {
    const Twins twins(five_maps());
    Picture p{64, 64, 4, 2, AcceleratorKind::none, {}};
    const Image expected = render_picture(twins.shared, p);
    for_each_isa([&](Isa) {
        for (const AcceleratorKind kind : {AcceleratorKind::grid, AcceleratorKind::bvh}) {
            p.accelerator = kind;
            EXPECT_EQ(differing_pixels(expected, render_picture(twins.shared, p)), 0u);
        }
    });
    // But for rays beside an edge.
    EXPECT_LT(difference(render_picture(twins.baked, p), expected).rmse, 0.01);
}

TEST(Instances, AnEyeInPlacedGlassStartsInThatGlass) {
    for (const PrimitiveKind kind : {PrimitiveKind::sphere, PrimitiveKind::box}) {
        Random random(48);
        const auto scene = single(kind, placed(3.0 * odd_rotation(random), {10.0, 0.0, 0.0}));
        const auto medium = [&](glm::vec3 eye) {
            return plan_render(*scene, RenderSettings(), camera_at(eye, eye + glm::vec3(0.0f, 0.0f, 1.0f))).medium;
        };
        EXPECT_EQ(medium({10.5f, 0.2f, 0.3f}).top(), 0u);
        EXPECT_EQ(medium({0.0f, 0.0f, 0.0f}).top(), MediumStack::kAir);
    }
}

// The ids, the bounds and the cost model know what is seen, the memory what is stored.
TEST(Instances, ABuildIsCheapAndALoopIsNot) {
    const auto crowd = load_scene("builtin:crowd,n=100");
    EXPECT_EQ(crowd->geometry->seen_count(), 100u * 10000u + 3u);
    EXPECT_EQ(crowd->geometry->prototypes.size(), 5u);
    const auto seconds = estimated_seconds(*crowd->geometry, {1.0e6});
    const auto knot = estimated_seconds(*load_scene("builtin:knot,n=1000000")->geometry, {1.0e6});
    EXPECT_NEAR(seconds[0] / knot[0], 1.0, 0.01);
    EXPECT_LT(seconds[2], 0.5 * knot[2]);
    EXPECT_EQ(automatic_accelerator(*crowd, {1.0e6}).kind, AcceleratorKind::bvh);
    const auto tree = build_accelerator(AcceleratorKind::bvh, crowd->geometry);
    EXPECT_LT(memory_bytes(*tree), 5u * 10000u * 70u);
}

TEST(Instances, MoreThanThereAreIdsForIsAnErrorOfTheScene) {
    SceneBuilder b;
    b.begin_prototype();
    const std::uint32_t m = b.add_material(matte(0.5f));
    b.add_vertex({0, 0, 0}), b.add_vertex({1, 0, 0}), b.add_vertex({0, 1, 0});
    for (int i = 0; i < 1 << 20; ++i) b.add_triangle(0, 1, 2, m);
    const std::uint32_t prototype = b.end_prototype();
    EXPECT_THROW(
        {
            for (int i = 0; i < 2000; ++i) b.place(prototype, glm::dmat4(1.0));
        },
        SceneError);
}

}  // namespace
}  // namespace glint
