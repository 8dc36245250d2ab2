// Whole pictures of scenes that are changed in ways that must not show, or show in a known way: mirrored, turned, shuffled,
// doubled, cut along the other diagonal, and filled with things that no ray can see.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/accel/random.h"
#include "tests/core/render_picture.h"
#include "tests/core/test_scene.h"
#include "tests/long.h"

namespace glint {
namespace {

// New coordinate k is the old one axis[k], times sign[k].
struct AxisMap {
    int axis[3];
    float sign[3];

    glm::vec3 operator()(glm::vec3 v) const { return {sign[0] * v[axis[0]], sign[1] * v[axis[1]], sign[2] * v[axis[2]]}; }
    glm::dvec3 operator()(glm::dvec3 v) const {
        glm::dvec3 r;
        for (int k = 0; k < 3; ++k) r[k] = static_cast<double>(sign[k]) * v[axis[k]];
        return r;
    }
};
constexpr AxisMap kMirror{{0, 1, 2}, {-1, 1, 1}}, kTurn{{1, 2, 0}, {1, 1, 1}};

std::shared_ptr<const Scene> moved(const Scene& scene, const AxisMap& map) {
    auto result = std::make_shared<Scene>(scene);
    auto g = std::make_shared<Geometry>(*scene.geometry);
    for (auto& v : g->vertices) v = map(v);
    for (auto& s : g->spheres) s.center = map(s.center);
    for (auto& b : g->boxes) {
        const glm::vec3 p = map(b.lo), q = map(b.hi);
        b = {glm::min(p, q), glm::max(p, q)};
    }
    for (auto& c : g->cones) c.base = map(c.base), c.apex = map(c.apex);
    for (auto& p : g->planes) p.normal = map(p.normal);
    result->geometry = g;
    for (auto& n : result->normals) n = map(n);
    for (auto& l : result->lights) {
        l.position = map(l.position), l.direction = map(l.direction);
        l.edge1 = map(l.edge1), l.edge2 = map(l.edge2);
        // A mirror turns the edges' cross product round, and the light would face the other way.
        if (map.sign[0] < 0.0f) std::swap(l.edge1, l.edge2);
    }
    result->environment.up = map(result->environment.up);
    result->environment.sun_direction = map(result->environment.sun_direction);
    if (result->up) result->up = map(*result->up);
    for (auto& c : result->cameras) c.eye = map(c.eye), c.target = map(c.target), c.up = map(c.up);
    return result;
}

// Root of the mean over pixels of (a - r)^2 / (r^2 + 0.01) (Rousselle's relMSE).
double relative_rms(const Image& a, const Image& reference) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const glm::dvec3 r(reference.pixels[i]), d = glm::dvec3(a.pixels[i]) - r;
        sum += glm::dot(d * d / (r * r + 0.01), glm::dvec3(1.0 / 3.0));
    }
    return std::sqrt(sum / static_cast<double>(a.pixels.size()));
}

Image flipped(const Image& image) {
    Image result = image;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) result.at(x, y) = image.at(image.width - 1 - x, y);
    }
    return result;
}

class Metamorphic : public testing::TestWithParam<const char*> {
protected:
    std::shared_ptr<const Scene> scene = load_scene(GetParam());

    // One centred ray a pixel, nothing random.
    [[nodiscard]] static Picture centred(int width, int height) {
        Picture p;
        p.width = width, p.height = height;
        p.settings.features = FeatureSet::whitted();
        return p;
    }
    [[nodiscard]] static Picture everything() {
        Picture p;
        p.width = p.height = 48, p.spp = 2;
        return p;
    }
};

TEST_P(Metamorphic, S_MET_02_TheMirroredSceneGivesTheMirroredPicture) {
    const auto mirrored = moved(*scene, kMirror);
    // Whatever the size: a pixel's distance from the middle is exact.
    for (const auto& [width, height] : {std::pair(64, 64), std::pair(50, 38), std::pair(33, 7)}) {
        const Picture p = centred(width, height);
        EXPECT_EQ(differing_pixels(render_picture(scene, p), flipped(render_picture(mirrored, p))), 0u) << width;
    }
}

TEST_P(Metamorphic, S_MET_02_TurnedAxesGiveTheSamePicture) {
    Picture p = centred(64, 64);
    p.settings.depth = 3;  // each reflection by a ball multiplies the roundings
    const double error = relative_rms(render_picture(moved(*scene, kTurn), p), render_picture(scene, p));
    test::note("relative_rms", error);
    EXPECT_LE(error, 1e-6);
}

// The primitives of each kind in another order, each with its material.
std::shared_ptr<const Scene> shuffled(const Scene& scene) {
    auto result = std::make_shared<Scene>(scene);
    auto g = std::make_shared<Geometry>(*scene.geometry);
    Random random(4);
    const auto shuffle = [&](PrimitiveKind kind, auto& primitives) {
        auto& materials = result->material_of[static_cast<std::size_t>(kind)];
        for (std::size_t i = primitives.size(); i > 1; --i) {
            const std::size_t j = random.below(i);
            std::swap(primitives[i - 1], primitives[j]), std::swap(materials[i - 1], materials[j]);
        }
    };
    shuffle(PrimitiveKind::triangle, g->triangles), shuffle(PrimitiveKind::sphere, g->spheres);
    shuffle(PrimitiveKind::box, g->boxes), shuffle(PrimitiveKind::cone, g->cones), shuffle(PrimitiveKind::plane, g->planes);
    result->geometry = g;
    return result;
}

// Everything a second time in the same place.
std::shared_ptr<const Scene> doubled(const Scene& scene) {
    auto result = std::make_shared<Scene>(scene);
    auto g = std::make_shared<Geometry>(*scene.geometry);
    const auto twice = [](auto& list) {
        const auto once = list;
        list.insert(list.end(), once.begin(), once.end());
    };
    twice(g->triangles), twice(g->spheres), twice(g->boxes), twice(g->cones), twice(g->planes);
    for (auto& materials : result->material_of) twice(materials);
    result->geometry = g;
    return result;
}

TEST_P(Metamorphic, S_MET_04_OrderAndDoublesDoNotShow) {
    Picture p = everything();
    const Image expected = render_picture(scene, p);
    for (const AcceleratorKind kind : {AcceleratorKind::grid, AcceleratorKind::bvh}) {
        p.accelerator = kind;
        EXPECT_EQ(differing_pixels(expected, render_picture(shuffled(*scene), p)), 0u) << "shuffled";
        EXPECT_EQ(differing_pixels(expected, render_picture(doubled(*scene), p)), 0u) << "doubled";
    }
}

// Inside each opaque ball and box a smaller one, and a light without light.
std::shared_ptr<const Scene> with_unseen_things(const Scene& scene) {
    auto result = std::make_shared<Scene>(scene);
    auto g = std::make_shared<Geometry>(*scene.geometry);
    const auto opaque = [&](PrimitiveKind kind, std::size_t i) {
        return !scene.material(make_id(kind, static_cast<std::uint32_t>(i))).glass;
    };
    auto& of_balls = result->material_of[static_cast<std::size_t>(PrimitiveKind::sphere)];
    for (std::size_t i = 0, n = g->spheres.size(); i < n; ++i) {
        if (!opaque(PrimitiveKind::sphere, i)) continue;
        g->spheres.push_back({g->spheres[i].center, 0.5f * g->spheres[i].radius});
        of_balls.push_back(0);
    }
    for (std::size_t i = 0, n = g->boxes.size(); i < n; ++i) {
        if (!opaque(PrimitiveKind::box, i)) continue;
        const glm::vec3 size = g->boxes[i].hi - g->boxes[i].lo;
        g->spheres.push_back({g->boxes[i].lo + 0.5f * size, 0.3f * std::min(size.x, std::min(size.y, size.z))});
        of_balls.push_back(0);
        if (!valid(g->spheres.back())) g->spheres.pop_back(), of_balls.pop_back();
    }
    result->geometry = g;
    Light dark = test::point_light({0.3f, 5.0f, 0.2f});
    dark.emission = glm::vec3(0.0f);
    result->lights.push_back(dark);
    return result;
}

TEST_P(Metamorphic, S_MET_05_WhatNoRaySeesDoesNotShow) {
    Picture p = everything();
    const Image expected = render_picture(scene, p);
    const auto crowded = with_unseen_things(*scene);
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        p.accelerator = kind;
        if (kind == AcceleratorKind::none && scene->geometry->bounded_count() > 400) continue;
        EXPECT_EQ(differing_pixels(expected, render_picture(crowded, p)), 0u)
            << kAcceleratorNames[static_cast<std::size_t>(kind)];
    }
}

INSTANTIATE_TEST_SUITE_P(Builtin, Metamorphic,
                         testing::Values("builtin:balls,level=2", "builtin:mount,level=4", "builtin:balls_box", "builtin:dof",
                                         "builtin:cornell", "builtin:glass,what=all"),
                         test_name);

// A file may define more than it uses; a mirror that is rough would otherwise decide how rough all others are.
TEST(Unused, S_MET_05_MaterialsThatNothingUsesDoNotShow) {
    const auto picture = [](bool unused) {
        SceneBuilder b;
        if (unused) (void)b.add_material(test::mirror(1.0f, 0.5f)), (void)b.add_material(test::glass(1.7f));
        b.add(Sphere{{0, 0, 0}, 1.0f}, b.add_material(test::mirror(0.9f)));
        b.add(test::plane_at({0, -1, 0}, {0, 1, 0}), b.add_material(test::matte(0.5f)));
        if (unused) (void)b.add_material(test::mirror(1.0f, 0.2f));
        b.scene().lights = {test::point_light({2, 4, 3})};
        b.scene().environment.kind = Environment::Kind::sky;
        return test::render(b.finish(), test::camera_at({0, 1, 6}, {0, 0, 0}), RenderSettings(), {48, 48, 4}).image;
    };
    EXPECT_EQ(differing_pixels(picture(false), picture(true)), 0u);
}

// Parallelograms of short binary coordinates, so that both cuts are the same surface exactly.
TEST(OtherDiagonal, S_MET_04_MovesHitsByTwoUlpAtMost) {
    Random random(44);
    const auto corner = [&random](int half) {
        const auto sixteenth = [&] {
            return static_cast<float>(static_cast<int>(random.below(static_cast<std::size_t>(2 * half + 1))) - half) / 16.0f;
        };
        return glm::vec3(sixteenth(), sixteenth(), sixteenth());
    };
    int compared = 0, worst = 0;
    double from_truth = 0.0;
    for (int i = scale(20000, 2000000); i > 0; --i) {
        const glm::vec3 c = corner(32), e = corner(16), f = corner(16);
        const glm::vec3 n = glm::cross(e, f);
        if (glm::length(n) <= 0.3f * glm::length(e) * glm::length(f)) continue;
        const auto cut = [&](bool other) {
            Geometry g;
            g.vertices = {c, c + e, c + e + f, c + f};
            if (other)
                g.triangles = {{1, 2, 3}, {1, 3, 0}};
            else
                g.triangles = {{0, 1, 2}, {0, 2, 3}};
            return BruteForce(std::make_shared<const Geometry>(g));
        };
        const BruteForce one = cut(false), two = cut(true);
        for (int k = 0; k < 4; ++k) {
            const glm::vec3 at = c + random.uniform(0.01f, 0.99f) * e + random.uniform(0.01f, 0.99f) * f;
            const glm::vec3 d = random.direction(), eye = at - 5.0f * d;
            if (std::abs(glm::dot(d, n)) < 0.3f * glm::length(n)) continue;
            const Hit a = one.closest_hit({eye, d}), b = two.closest_hit({eye, d});
            ASSERT_TRUE(a.found() && b.found());
            const float ulp = std::nextafter(a.t, kInfinity) - a.t;
            const int ulps = static_cast<int>(std::abs(a.t - b.t) / ulp);
            const glm::dvec3 m(n);
            const double exact = glm::dot(glm::dvec3(c) - glm::dvec3(eye), m) / glm::dot(glm::dvec3(d), m);
            for (const Hit& hit : {a, b})
                from_truth = std::max(from_truth, std::abs(static_cast<double>(hit.t) - exact) / static_cast<double>(ulp));
            worst = std::max(worst, ulps), ++compared;
        }
    }
    test::note("worst_ulps", worst), test::note("compared", compared), test::note("ulps_from_truth", from_truth);
    EXPECT_GT(compared, 10000);
    EXPECT_LE(from_truth, 4.0);
    EXPECT_LE(worst, 2);
}

}  // namespace
}  // namespace glint
