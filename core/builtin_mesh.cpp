// Scenes whose point is their geometry: one dense mesh, one tiny dense mesh in a huge field, and triangles without order.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/builtin.h"
#include "core/mesh_stage.h"
#include "core/torus_knot.h"

namespace glint::builtin {
namespace {

void add_knot(SceneBuilder& builder, int n, glm::dvec3 position, double scale, std::uint32_t material) {
    const KnotMesh mesh = torus_knot(n);
    const auto first = static_cast<std::uint32_t>(builder.geometry().vertices.size());
    builder.reserve(mesh.vertices.size(), mesh.triangles.size());
    for (const glm::vec3& v : mesh.vertices) builder.add_vertex(glm::vec3(position + scale * glm::dvec3(v)));
    for (const auto& t : mesh.triangles) builder.add_triangle(first + t[0], first + t[1], first + t[2], material);
}

Material matte(glm::vec3 albedo) {
    Material m = clay(albedo);
    m.specular = glm::vec3(0.0f);
    return m;
}

// Numbers in [0, 1), the same on every machine (SplitMix64; Steele, Lea & Flood 2014).
class Random {
public:
    double uniform() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    // A point of the cube [-1, 1)^3; one after the other, since the order of arguments is the compiler's choice.
    glm::dvec3 in_cube() {
        glm::dvec3 p;
        for (int i = 0; i < 3; ++i) p[i] = 2.0 * uniform() - 1.0;
        return p;
    }
    // Every direction alike, as a unit vector, by rejection: no sine or logarithm of a library's taste.
    glm::dvec3 direction() {
        for (;;) {
            const glm::dvec3 p = in_cube();
            const double length2 = glm::dot(p, p);
            if (length2 > 0.0 && length2 <= 1.0) return p / std::sqrt(length2);
        }
    }

private:
    std::uint64_t state_ = 2026;
};

// Newton's iteration; a library's cube root differs in its last bits from machine to machine.
double cube_root(double x) {
    double root = std::max(x, 1.0);
    for (int i = 0; i < 100; ++i) root = (2.0 * root + x / (root * root)) / 3.0;
    return root;
}

// The field's stands: three steps on each of its four sides, seen from within.
void add_stands(SceneBuilder& builder, float field) {
    const std::uint32_t concrete = builder.add_material(matte(glm::vec3(0.50f, 0.47f, 0.44f)));
    constexpr float kDepth = 25.0f, kHeight = 14.0f;
    for (int step = 0; step < 3; ++step) {
        const float near = kDepth * static_cast<float>(step), far = near + kDepth;
        const float top = kHeight * static_cast<float>(step + 1);
        builder.add(Box{{-far, 0.0f, -far}, {-near, top, field + far}}, concrete);
        builder.add(Box{{field + near, 0.0f, -far}, {field + far, top, field + far}}, concrete);
        builder.add(Box{{-near, 0.0f, -far}, {field + near, top, -near}}, concrete);
        builder.add(Box{{-near, 0.0f, field + near}, {field + near, top, field + far}}, concrete);
    }
}

}  // namespace

SceneBuilder knot(int n) {
    SceneBuilder builder;
    add_knot(builder, n, glm::dvec3(0.0), 1.0, builder.add_material(clay(glm::vec3(0.76f, 0.50f, 0.34f))));
    set_stage(builder);
    return builder;
}

SceneBuilder stadium(int n) {
    constexpr float kField = 1000.0f;
    SceneBuilder builder;
    // A hundredth of the knot's own size: a diagonal of 1 in the corner at the origin, where floats are dense.
    const glm::dvec3 corner(16.0, 0.34, 16.0);
    add_knot(builder, n, corner, 0.01, builder.add_material(clay(glm::vec3(0.76f, 0.50f, 0.34f))));
    const std::uint32_t grass = builder.add_material(matte(glm::vec3(0.26f, 0.42f, 0.20f)));
    const std::uint32_t a = builder.add_vertex(glm::vec3(0.0f)), b = builder.add_vertex({0.0f, 0.0f, kField});
    const std::uint32_t c = builder.add_vertex({kField, 0.0f, kField}), d = builder.add_vertex({kField, 0.0f, 0.0f});
    builder.add_triangle(a, b, c, grass);
    builder.add_triangle(a, c, d, grass);
    add_stands(builder, kField);
    const std::uint32_t ball = builder.add_material(clay(glm::vec3(0.85f, 0.82f, 0.75f)));
    for (int i = 0; i < 5; ++i) {
        const float along = kField * static_cast<float>(2 * i + 1) / 10.0f;
        builder.add(Sphere{{kField, 90.0f, along}, 30.0f}, ball);
        builder.add(Sphere{{along, 90.0f, kField}, 30.0f}, ball);
    }
    Scene& scene = builder.scene();
    CameraPose pose;
    pose.target = glm::vec3(corner);
    pose.eye = glm::vec3(corner + glm::dvec3(-1.05, 0.22, -1.35));
    pose.view_angle = 38.0f;
    scene.cameras.push_back(pose);
    scene.up = glm::vec3(0.0f, 1.0f, 0.0f);
    scene.environment.color = glm::vec3(0.45f, 0.62f, 0.85f);
    Light light;
    light.position = {-120.0f, 420.0f, -260.0f};
    scene.lights.push_back(light);
    return builder;
}

SceneBuilder soup(int n) {
    SceneBuilder builder;
    const std::array<glm::vec3, 4> colours{
        {{0.75f, 0.48f, 0.30f}, {0.30f, 0.52f, 0.58f}, {0.78f, 0.72f, 0.58f}, {0.55f, 0.28f, 0.26f}}};
    for (const glm::vec3& colour : colours) builder.add_material(clay(colour));
    Random random;
    // Sizes over a factor of 32, measured by the mean distance of neighbours, so that any n looks alike.
    constexpr double kHalfCube = 28.0;
    const double spacing = 2.0 * kHalfCube / cube_root(n);
    for (int i = 0; i < n; ++i) {
        const glm::dvec3 center = kHalfCube * random.in_cube();
        double size = 0.125 * spacing * (1.0 + random.uniform());
        for (int doublings = static_cast<int>(5.0 * random.uniform()); doublings > 0; --doublings) size *= 2.0;
        std::array<std::uint32_t, 3> corners;
        for (std::uint32_t& corner : corners) corner = builder.add_vertex(glm::vec3(center + size * random.direction()));
        builder.add_triangle(corners[0], corners[1], corners[2], static_cast<std::uint32_t>(i) % colours.size());
    }
    set_stage(builder, {.floor = false});
    return builder;
}

}  // namespace glint::builtin
