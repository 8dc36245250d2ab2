// Scenes of instances that break the step between two spaces: bent, sheared and mirrored maps, maps far from everything, ties.
// They know nothing of rays. Invariant: as in adversarial_scenes.h; what place() refuses is left out.
#pragma once

#include <memory>
#include <utility>

#include "tests/accel/adversarial_scenes.h"

namespace glint::scenes {

// A rotation by an odd angle about an odd axis.
inline glm::dmat3 odd_rotation(Random& random) {
    const glm::dvec3 x = random.unit();
    const glm::dvec3 y = glm::normalize(glm::cross(x, random.unit()));
    return {x, y, glm::cross(x, y)};
}

inline glm::dmat4 placed(const glm::dmat3& linear, glm::dvec3 shift) {
    glm::dmat4 m(linear);
    m[3] = glm::dvec4(shift, 1.0);
    return m;
}

inline glm::dmat3 stretch(double x, double y, double z) {
    return {glm::dvec3(x, 0.0, 0.0), glm::dvec3(0.0, y, 0.0), glm::dvec3(0.0, 0.0, z)};
}

inline std::uint32_t add_prototype(Geometry& g, Geometry prototype) {
    prototype.planes.clear();
    g.prototypes.emplace_back(std::make_shared<const Geometry>(std::move(prototype)));
    return static_cast<std::uint32_t>(g.prototypes.size() - 1);
}

inline bool place(Geometry& g, std::uint32_t prototype, const glm::dmat3& linear, glm::dvec3 shift) {
    return g.place(prototype, affine_map(placed(linear, shift)));
}

// Turned and scaled alike on all axes, some mirrored, among primitives of the world.
inline Geometry instances_turned() {
    Geometry g = mixture(11, 60, 5.0f);
    const std::uint32_t soup = add_prototype(g, triangles_in_cube(12, 200, glm::vec3(0.1f), 1.0f, 0.3f));
    const std::uint32_t ball = add_prototype(g, tessellated_ball(glm::dvec3(0.2, 0.0, -0.1), 1.0, 24, 12));
    Random random(13);
    for (int i = 0; i < 30; ++i) {
        const double scale = std::pow(2.0, -1.5 + 3.0 * random.uniform()) * (i % 4 == 0 ? -1.0 : 1.0);
        place(g, i % 2 == 0 ? soup : ball, scale * odd_rotation(random), glm::dvec3(random.in_cube(-5.0f, 5.0f)));
    }
    return g;
}

// Scales of 1e-3 to 1e3 on different axes between two rotations, so sheared as well; every second one is mirrored.
inline Geometry instances_bent() {
    Geometry g;
    const std::uint32_t soup = add_prototype(g, triangles_in_cube(14, 150, glm::vec3(0.0f), 1.0f, 0.4f));
    const std::uint32_t kinds = add_prototype(g, mixture(15, 30, 1.0f));
    Random random(16);
    for (int i = 0; i < 24; ++i) {
        const auto power = [&] { return std::pow(10.0, -3.0 + 6.0 * random.uniform()); };
        const double x = power(), y = power(), z = power();
        const glm::dmat3 linear = odd_rotation(random) * stretch(i % 2 == 0 ? x : -x, y, z) * odd_rotation(random);
        place(g, i % 3 == 0 ? kinds : soup, linear, glm::dvec3(random.in_cube(-50.0f, 50.0f)));
    }
    return g;
}

// As bent as one map may be.
inline Geometry instances_needle_map() {
    Geometry g;
    const std::uint32_t soup = add_prototype(g, triangles_in_cube(17, 200, glm::vec3(0.0f), 1.0f, 0.4f));
    Random random(18);
    for (int i = 0; i < 4; ++i)
        place(g, soup, odd_rotation(random) * stretch(1.0e3, 1.0, 1.0e-3) * odd_rotation(random), glm::dvec3(i));
    place(g, soup, stretch(1.0e3, 1.0, 1.0e-3), glm::dvec3(0.0));
    return g;
}

// All kinds of primitives in one prototype, and the world.
inline Geometry instances_of_all_kinds() {
    Geometry g = mixture(19, 40, 2.0f);
    const std::uint32_t kinds = add_prototype(g, mixture(20, 60, 1.0f));
    Random random(21);
    for (int i = 0; i < 16; ++i)
        place(g, kinds, (0.2 + 1.8 * random.uniform()) * odd_rotation(random), glm::dvec3(random.in_cube(-3.0f, 3.0f)));
    return g;
}

// Far from the world's origin; and a prototype far from its own, brought back.
inline Geometry instances_far() {
    Geometry g;
    const std::uint32_t near = add_prototype(g, triangles_in_cube(22, 150, glm::vec3(0.0f), 1.0f, 0.4f));
    const std::uint32_t far = add_prototype(g, triangles_in_cube(23, 150, glm::vec3(1.0e6f, -3.0e5f, 7.0e5f), 1.0f, 0.5f));
    Random random(24);
    const glm::dvec3 there(-2.0e6, 1.0e6, 4.0e5);
    for (int i = 0; i < 10; ++i) {
        place(g, near, odd_rotation(random), there + glm::dvec3(random.in_cube(-4.0f, 4.0f)));
        const glm::dmat3 turn = odd_rotation(random);
        place(g, far, turn, there - turn * glm::dvec3(1.0e6, -3.0e5, 7.0e5) + glm::dvec3(random.in_cube(-4.0f, 4.0f)));
    }
    return g;
}

// The same mesh in the same place, in the world and three times as an instance: the tie rule decides every hit.
inline Geometry instances_at_one_place() {
    Geometry g = triangles_in_cube(25, 120, glm::vec3(0.0f), 1.0f, 0.4f);
    Geometry twin;
    twin.vertices = g.vertices;
    twin.triangles = g.triangles;
    const std::uint32_t a = add_prototype(g, twin), b = add_prototype(g, twin);
    for (const std::uint32_t prototype : {a, b, a}) place(g, prototype, glm::dmat3(1.0), glm::dvec3(0.0));
    // Turned by a right angle they meet themselves in other planes.
    place(g, a, glm::dmat3(0, 1, 0, 0, 0, 1, 1, 0, 0), glm::dvec3(0.0));
    return g;
}

// A crowd of small ones over sizes of three decades.
inline Geometry instances_crowd() {
    Geometry g;
    const std::uint32_t ball = add_prototype(g, tessellated_ball(glm::dvec3(0.0), 1.0, 8, 5));
    Random random(26);
    for (int i = 0; i < 1200; ++i) {
        const auto scale = static_cast<double>(random.power_of_ten(-2.5f, 0.0f));
        place(g, ball, scale * odd_rotation(random), glm::dvec3(random.in_cube(-10.0f, 10.0f)));
    }
    return g;
}

// Prototypes as large as floats allow, made small, and the other way round.
inline Geometry instances_scaled_by_decades() {
    Geometry g;
    const std::uint32_t huge = add_prototype(g, triangles_in_cube(27, 100, glm::vec3(0.0f), 1.0e17f, 4.0e16f));
    const std::uint32_t tiny = add_prototype(g, triangles_in_cube(28, 100, glm::vec3(0.0f), 1.0e-12f, 4.0e-13f));
    Random random(29);
    for (int i = 0; i < 8; ++i) {
        place(g, huge, 1.0e-17 * odd_rotation(random), glm::dvec3(random.in_cube(-2.0f, 2.0f)));
        place(g, tiny, 1.0e12 * odd_rotation(random), glm::dvec3(random.in_cube(-2.0f, 2.0f)));
    }
    return g;
}

// Sheets: boxes without extent in the prototype, in the world too where they are turned by right angles only.
inline Geometry instances_flat() {
    Geometry g;
    const std::uint32_t floor = add_prototype(g, flat_floor());
    Random random(30);
    for (int i = 0; i < 3; ++i) place(g, floor, glm::dmat3(1.0), glm::dvec3(0.0, 0.0, i));
    place(g, floor, glm::dmat3(0, 1, 0, 0, 0, 1, 1, 0, 0), glm::dvec3(0.0));
    place(g, floor, 0.1 * odd_rotation(random), glm::dvec3(3.0, 2.0, 1.0));
    return g;
}

}  // namespace glint::scenes

namespace glint {

inline constexpr AdversarialScene kInstanceScenes[] = {
    {"instances_turned", scenes::instances_turned, 4000},
    {"instances_bent", scenes::instances_bent, 4000},
    {"instances_needle_map", scenes::instances_needle_map, kManyRays},
    {"instances_of_all_kinds", scenes::instances_of_all_kinds, 4000},
    {"instances_far", scenes::instances_far, 2000},
    {"instances_at_one_place", scenes::instances_at_one_place, kManyRays},
    {"instances_crowd", scenes::instances_crowd, 1000},
    {"instances_scaled_by_decades", scenes::instances_scaled_by_decades, 6000},
    {"instances_flat", scenes::instances_flat, 2500},
};

}  // namespace glint
