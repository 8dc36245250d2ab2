// Scenes that break accelerators: each was chosen for one way to fail. They know nothing of rays.
// Invariant: every primitive is valid(), so the answers of brute force are the truth to agree with.
#pragma once

#include <string_view>
#include <vector>

#include "accel/geometry.h"
#include "tests/accel/random.h"

namespace glint {

inline void add_triangle(Geometry& g, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    if (!valid_triangle(a, b, c)) return;
    const auto first = static_cast<std::uint32_t>(g.vertices.size());
    g.vertices.insert(g.vertices.end(), {a, b, c});
    g.triangles.push_back({first, first + 1, first + 2});
}

inline Geometry triangles_in_cube(std::uint64_t seed, std::size_t count, glm::vec3 center, float half, float size) {
    Geometry g;
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 p = center + random.in_cube(-half, half);
        const glm::vec3 a = p + random.in_cube(-size, size), b = p + random.in_cube(-size, size);
        add_triangle(g, a, b, p + random.in_cube(-size, size));
    }
    return g;
}

// A closed ball of 2 * columns * (rows - 1) triangles that share their vertices; its columns meet exactly.
inline Geometry tessellated_ball(glm::dvec3 center, double radius, std::uint32_t columns, std::uint32_t rows) {
    Geometry g;
    for (std::uint32_t row = 0; row <= rows; ++row) {
        const double theta = 3.141592653589793 * row / rows;
        const double ring = row == 0 || row == rows ? 0.0 : std::sin(theta);
        for (std::uint32_t column = 0; column < columns; ++column) {
            const double phi = 6.283185307179586 * column / columns;
            g.vertices.emplace_back(center + radius * glm::dvec3(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta)));
        }
    }
    const auto add = [&g](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (valid_triangle(g.vertices[a], g.vertices[b], g.vertices[c])) g.triangles.push_back({a, b, c});
    };
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::uint32_t next = (column + 1) % columns, above = row * columns, below = above + columns;
            add(above + column, below + column, below + next);
            add(above + column, below + next, above + next);
        }
    }
    return g;
}

namespace scenes {

inline Geometry triangle_soup() { return triangles_in_cube(1, 2000, glm::vec3(0.0f), 1.0f, 0.2f); }

// Each sphere carries nine of a third of its radius, half sunk into it.
inline void add_flake(Geometry& g, glm::dvec3 center, double radius, int levels) {
    g.spheres.push_back({glm::vec3(center), static_cast<float>(radius)});
    if (levels == 0) return;
    Random random(static_cast<std::uint64_t>(levels));
    for (int i = 0; i < 9; ++i) add_flake(g, center + radius * random.unit(), radius / 3.0, levels - 1);
}
inline Geometry sphereflake() {
    Geometry g;
    add_flake(g, glm::dvec3(0.1, 0.2, 0.3), 1.0, 3);
    return g;
}

// Ten thousand cells in a row: a walk that sums up its steps is a cell off at the end.
inline Geometry sphere_row() {
    Geometry g;
    for (int i = 0; i < 10000; ++i) g.spheres.push_back({glm::vec3(0.1f * static_cast<float>(i), 0.0f, 0.0f), 0.04f});
    return g;
}

// "Teapot in a stadium": everything in one corner, and a few primitives that make the bounds huge.
inline Geometry stadium() {
    Geometry g = triangles_in_cube(2, 6000, glm::vec3(-50.0f), 1.0e-3f, 1.0e-4f);
    g.spheres = {{glm::vec3(50.0f), 1.0f}, {glm::vec3(50.0f, -50.0f, 0.0f), 3.0f}};
    add_triangle(g, glm::vec3(-50.0f, -51.0f, -50.0f), glm::vec3(50.0f, -51.0f, -50.0f), glm::vec3(0.0f, -51.0f, 50.0f));
    add_triangle(g, glm::vec3(-49.0f), glm::vec3(50.0f, 0.0f, 0.0f), glm::vec3(0.0f, 50.0f, 1.0e-3f));
    return g;
}

// Unit squares of two triangles in the plane where coordinate `axis` is 0: bounds without extent there.
inline Geometry flat(int axis) {
    Geometry g;
    const auto point = [axis](int x, int y) {
        glm::vec3 p(0.0f);
        p[(axis + 1) % 3] = static_cast<float>(x);
        p[(axis + 2) % 3] = static_cast<float>(y);
        return p;
    };
    for (int x = -20; x < 20; ++x) {
        for (int y = -20; y < 20; ++y) {
            add_triangle(g, point(x, y), point(x + 1, y), point(x + 1, y + 1));
            add_triangle(g, point(x, y), point(x + 1, y + 1), point(x, y + 1));
        }
    }
    return g;
}
inline Geometry flat_floor() { return flat(2); }
inline Geometry flat_wall() { return flat(0); }

// Cones from slim to so flat that their height is lost beside their radius.
inline Geometry flat_cones() {
    Geometry g;
    Random random(19);
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 base = random.in_cube(-2.0f, 2.0f), axis = random.power_of_ten(-25.0f, 0.0f) * random.direction();
        const float radius = random.uniform(0.1f, 0.6f);
        const Cone cone{i % 3 == 0 ? glm::vec3(0.0f) : base, radius, i % 3 == 0 ? axis : base + axis,
                        radius * random.uniform(0.0f, 1.0f)};
        if (valid(cone)) g.cones.push_back(cone);
    }
    return g;
}

inline Geometry concentric_spheres() {
    Geometry g;
    for (int i = 1; i <= 3000; ++i)
        g.spheres.push_back({glm::vec3(1.0f, 2.0f, 3.0f), 0.001f * static_cast<float>((i * 7) % 3001)});
    return g;
}

// Every triangle three times, far apart in the list: the tie rule decides every hit.
inline Geometry duplicates() {
    Geometry g = triangles_in_cube(3, 700, glm::vec3(0.0f), 1.0f, 0.3f);
    const auto once = g.triangles;
    for (int copy = 0; copy < 2; ++copy) g.triangles.insert(g.triangles.end(), once.rbegin(), once.rend());
    return g;
}

inline Geometry powers_of_two() {
    Geometry g;
    for (int i = -60; i < 60; ++i) g.spheres.push_back({glm::vec3(std::ldexp(1.0f, i), 0.0f, 0.0f), std::ldexp(0.125f, i)});
    return g;
}

inline Geometry far_from_origin() {
    Geometry g = triangles_in_cube(4, 1500, glm::vec3(1.0e6f, -1.0e6f, 5.0e5f), 10.0f, 2.0f);
    Random random(4);
    for (int i = 0; i < 300; ++i) {
        g.spheres.push_back({glm::vec3(1.0e6f, -1.0e6f, 5.0e5f) + random.in_cube(-10.0f, 10.0f), random.uniform(0.01f, 1.0f)});
    }
    return g;
}

// All five kinds, sizes over three decades, at the given scale.
inline Geometry mixture(std::uint64_t seed, int count, float scale) {
    Random random(seed);
    Geometry g = triangles_in_cube(seed, static_cast<std::size_t>(count), glm::vec3(0.0f), scale, 0.2f * scale);
    for (int i = 0; i < count; ++i) {
        const glm::vec3 p = random.in_cube(-scale, scale);
        const float size = scale * random.power_of_ten(-3.0f, -0.7f);
        g.spheres.push_back({p, size});
        const glm::vec3 q = random.in_cube(-scale, scale);
        g.boxes.push_back({q, q + scale * random.in_cube(0.0f, 0.2f) * glm::vec3(i % 5 == 0 ? 0.0f : 1.0f, 1.0f, 1.0f)});
        const glm::vec3 apex = p + 3.0f * size * random.direction();
        const Cone cone{p, size, apex, i % 3 == 0 ? size : size * random.uniform(0.0f, 2.0f)};
        if (valid(cone)) g.cones.push_back(cone);
    }
    for (int i = 0; i < 3; ++i) g.planes.push_back({random.unit(), 1.1 * static_cast<double>(scale)});
    g.planes.push_back({glm::dvec3(0.0, 0.0, 1.0), 0.0});
    return g;
}
inline Geometry mixed() { return mixture(5, 500, 1.0f); }
inline Geometry tiny() { return mixture(6, 400, 1.0e-6f); }
// So small that long directions make t subnormal.
inline Geometry speck() { return mixture(10, 50, 1.0e-12f); }
inline Geometry astronomic() { return mixture(7, 300, 5.0e17f); }

inline Geometry needles() {
    Geometry g;
    Random random(8);
    while (g.triangles.size() < 2000) {
        const glm::vec3 a = random.in_cube(-1.0f, 1.0f), b = random.in_cube(-1.0f, 1.0f);
        add_triangle(g, a, b, b + random.power_of_ten(-7.0f, -2.0f) * random.direction());
    }
    return g;
}

inline Geometry one_triangle() { return triangles_in_cube(9, 1, glm::vec3(0.5f), 0.1f, 1.0f); }
inline Geometry one_sphere() {
    Geometry g;
    g.spheres.push_back({glm::vec3(0.3f, -0.2f, 0.7f), 0.9f});
    return g;
}
inline Geometry empty() { return {}; }
inline Geometry planes_only() {
    Geometry g;
    g.planes = {{glm::dvec3(0.0, 1.0, 0.0), 0.5}, {glm::dvec3(0.0, 1.0, 0.0), 0.5}, {glm::dvec3(0.6, 0.0, 0.8), -2.0}};
    return g;
}

inline Geometry closed_ball() { return tessellated_ball(glm::dvec3(0.3, -0.1, 0.2), 1.7, 60, 30); }

inline Geometry same_triangle_70000() {
    Geometry g = one_triangle();
    g.triangles.assign(70000, g.triangles.front());
    return g;
}

}  // namespace scenes

struct AdversarialScene {
    std::string_view name;
    Geometry (*build)();
    std::size_t rays;  // kManyRays, or what brute force ends in a second or so
};

// The three tests that draw them take 2.25 times as many in all: a hundred thousand.
inline constexpr std::size_t kManyRays = 45000;

inline constexpr AdversarialScene kAdversarialScenes[] = {
    {"triangle_soup", scenes::triangle_soup, kManyRays},
    {"sphereflake", scenes::sphereflake, kManyRays},
    {"sphere_row", scenes::sphere_row, 3000},
    {"stadium", scenes::stadium, 3000},
    {"flat_floor", scenes::flat_floor, 6000},
    {"flat_wall", scenes::flat_wall, 6000},
    {"flat_cones", scenes::flat_cones, 6000},
    {"concentric_spheres", scenes::concentric_spheres, 3000},
    {"duplicates", scenes::duplicates, kManyRays},
    {"powers_of_two", scenes::powers_of_two, kManyRays},
    {"far_from_origin", scenes::far_from_origin, 6000},
    {"mixed", scenes::mixed, kManyRays},
    {"tiny", scenes::tiny, kManyRays},
    {"speck", scenes::speck, kManyRays},
    {"astronomic", scenes::astronomic, kManyRays},
    {"needles", scenes::needles, 6000},
    {"one_triangle", scenes::one_triangle, kManyRays},
    {"one_sphere", scenes::one_sphere, kManyRays},
    {"empty", scenes::empty, 2000},
    {"planes_only", scenes::planes_only, 4000},
    {"closed_ball", scenes::closed_ball, kManyRays},
    {"same_triangle_70000", scenes::same_triangle_70000, 200},
};

}  // namespace glint
