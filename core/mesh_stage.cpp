#include "core/mesh_stage.h"

#include <algorithm>
#include <cmath>

#include "core/seen_vertices.h"

namespace glint {
namespace {

// Steeper than half the view angle, so that the floor fills the picture and no horizon cuts it.
constexpr double kPitch = 21.0, kViewAngle = 30.0;
constexpr double kFilled = 0.88;  // of the picture's width or height
constexpr double kRadians = 3.14159265358979323846 / 180.0;

struct View {
    glm::dvec3 target, right, up, back;
    double distance = 0.0;
};

bool inside(const Aabb& box, glm::vec3 p) {
    return glm::all(glm::greaterThanEqual(p, box.lo)) && glm::all(glm::lessThanEqual(p, box.hi));
}

// The nearest camera on its line of sight that has every vertex within the picture.
View frame_vertices(const SceneBuilder& builder, const Aabb& box, double aspect, double turn) {
    View view;
    view.target = 0.5 * (glm::dvec3(box.lo) + glm::dvec3(box.hi));
    const double a = turn * kRadians, p = kPitch * kRadians;
    view.back = {std::sin(a) * std::cos(p), std::sin(p), std::cos(a) * std::cos(p)};
    view.right = {std::cos(a), 0.0, -std::sin(a)};
    view.up = glm::cross(view.back, view.right);
    const double high = kFilled * std::tan(0.5 * kViewAngle * kRadians), wide = high * aspect;
    for_each_seen_vertex(builder.geometry(), [&](glm::vec3 vertex) {
        if (!inside(box, vertex)) return;  // belongs to no triangle
        const glm::dvec3 d = glm::dvec3(vertex) - view.target;
        const double aside = std::max(std::abs(glm::dot(d, view.right)) / wide, std::abs(glm::dot(d, view.up)) / high);
        view.distance = std::max(view.distance, glm::dot(d, view.back) + aside);
    });
    // A mesh of spheres alone, say, has no vertices.
    if (!(view.distance > 0.0)) view.distance = glm::length(glm::dvec3(box.size())) / (2.0 * high);
    return view;
}

void add_floor(SceneBuilder& builder, const View& view, double height) {
    Material m;
    m.diffuse = glm::vec3(0.50f, 0.52f, 0.55f);
    m.specular = glm::vec3(0.0f);
    m.emission = 0.05f * m.diffuse;
    const std::uint32_t material = builder.add_material(m);
    // The uppermost rays of the picture meet the floor four to five distances behind the mesh.
    const double reach = 10.0 * view.distance;
    const auto corner = [&](double x, double z) {
        return builder.add_vertex(glm::vec3(glm::dvec3(view.target.x + x * reach, height, view.target.z + z * reach)));
    };
    const std::uint32_t a = corner(-1.0, -1.0), b = corner(-1.0, 1.0), c = corner(1.0, 1.0), d = corner(1.0, -1.0);
    builder.add_triangle(a, b, c, material);
    builder.add_triangle(a, c, d, material);
}

}  // namespace

Material clay(glm::vec3 albedo) {
    Material m;
    m.diffuse = albedo;
    m.specular = glm::vec3(0.14f);
    m.shininess = 28.0f;
    m.emission = 0.05f * albedo;
    return m;
}

void set_stage(SceneBuilder& builder, const Stage& stage) {
    Scene& scene = builder.scene();
    const Aabb box = builder.geometry().bounds();
    const View view =
        frame_vertices(builder, box, static_cast<double>(scene.width) / scene.height, static_cast<double>(stage.turn));
    const auto size = glm::dvec3(box.size());
    if (stage.floor && size.y > 0.01 * std::max(size.x, size.z)) add_floor(builder, view, static_cast<double>(box.lo.y));

    CameraPose pose;
    pose.target = glm::vec3(view.target);
    pose.eye = glm::vec3(view.target + view.distance * view.back);
    pose.view_angle = static_cast<float>(kViewAngle);
    scene.cameras.push_back(pose);
    scene.up = glm::vec3(0.0f, 1.0f, 0.0f);
    scene.environment.color = glm::vec3(0.42f, 0.45f, 0.50f);

    Light light;
    light.position = glm::vec3(view.target + view.distance * (1.3 * view.back - 0.75 * view.right + glm::dvec3(0.0, 0.9, 0.0)));
    scene.lights.push_back(light);
}

}  // namespace glint
