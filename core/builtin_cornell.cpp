// A room in the manner of the Cornell box (Goral et al. 1984), in numbers of our own: 2 units a side, y up, open to +z.
// There is no indirect light here, so a second, dim light outside the open side stands for the day that comes in.
#include <cmath>

#include <glm/gtc/constants.hpp>

#include "core/builtin.h"

namespace glint::builtin {
namespace {

// Diffuse reflection has no 1/pi of its own, and these lights are given in radiance.
Material matte(glm::vec3 albedo) {
    Material m;
    m.diffuse = albedo / glm::pi<float>();
    m.specular = glm::vec3(0.0f);
    return m;
}

// The parallelogram corner, corner + e1, corner + e1 + e2, corner + e2; its front is where that runs counter-clockwise.
void add_quad(SceneBuilder& builder, glm::vec3 corner, glm::vec3 e1, glm::vec3 e2, std::uint32_t material) {
    const std::uint32_t a = builder.add_vertex(corner), b = builder.add_vertex(corner + e1);
    const std::uint32_t c = builder.add_vertex(corner + e1 + e2), d = builder.add_vertex(corner + e2);
    builder.add_triangle(a, b, c, material);
    builder.add_triangle(c, d, a, material);
}

void add_quad_light(SceneBuilder& builder, glm::vec3 corner, glm::vec3 e1, glm::vec3 e2, glm::vec3 radiance) {
    Light light;
    light.shape = Light::Shape::quad;
    light.falloff = Light::Falloff::physical;
    light.position = corner;
    light.edge1 = e1;
    light.edge2 = e2;
    light.emission = radiance;
    builder.scene().lights.push_back(light);
}

void add_room(SceneBuilder& builder) {
    const std::uint32_t white = builder.add_material(matte({0.76f, 0.74f, 0.70f}));
    const glm::vec3 right(2.0f, 0.0f, 0.0f), up(0.0f, 2.0f, 0.0f), front(0.0f, 0.0f, 2.0f), corner(-1.0f, 0.0f, -1.0f);
    add_quad(builder, corner, front, right, white);
    add_quad(builder, corner + up, right, front, white);
    add_quad(builder, corner, right, up, white);
    const std::uint32_t terracotta = builder.add_material(matte({0.66f, 0.20f, 0.11f}));
    add_quad(builder, corner, up, front, terracotta);
    const std::uint32_t teal = builder.add_material(matte({0.10f, 0.38f, 0.42f}));
    add_quad(builder, corner + right, front, up, teal);
}

// A block standing on the floor, turned about the vertical through its centre.
void add_block(SceneBuilder& builder, glm::vec2 center, glm::vec3 size, float degrees, std::uint32_t material) {
    const float turn = glm::radians(degrees);
    const glm::vec3 x = size.x * glm::vec3(std::cos(turn), 0.0f, -std::sin(turn));
    const glm::vec3 z = size.z * glm::vec3(std::sin(turn), 0.0f, std::cos(turn));
    const glm::vec3 y(0.0f, size.y, 0.0f);
    const glm::vec3 corner = glm::vec3(center.x, 0.0f, center.y) - 0.5f * x - 0.5f * z;
    add_quad(builder, corner + y, z, x, material);
    add_quad(builder, corner + z, x, y, material);
    add_quad(builder, corner, y, x, material);
    add_quad(builder, corner, z, y, material);
    add_quad(builder, corner + x, y, z, material);
}

void add_lights(SceneBuilder& builder) {
    const glm::vec3 lamp_radiance = 20.0f * glm::vec3(1.0f, 0.86f, 0.68f);
    const glm::vec3 corner(-0.32f, 1.98f, -0.32f), x(0.64f, 0.0f, 0.0f), z(0.0f, 0.0f, 0.64f);
    add_quad_light(builder, corner, x, z, lamp_radiance);
    // The panel that is seen stands behind the one that is sampled, or it would shadow it.
    Material panel;
    panel.diffuse = panel.specular = glm::vec3(0.0f);
    panel.emission = lamp_radiance;
    add_quad(builder, corner + glm::vec3(0.0f, 0.01f, 0.0f), x, z, builder.add_material(panel));
    const glm::vec3 daylight(1.05f, 1.20f, 1.45f);
    add_quad_light(builder, {-1.5f, -1.4f, 3.0f}, {0.0f, 3.0f, 0.0f}, {3.0f, 0.0f, 0.0f}, daylight);
    builder.scene().environment.color = 0.35f * daylight;
}

}  // namespace

SceneBuilder cornell() {
    SceneBuilder builder;
    builder.scene().width = builder.scene().height = 800;
    CameraPose pose;
    pose.eye = {0.0f, 1.0f, 4.0f};
    pose.target = {0.0f, 1.0f, 0.0f};
    pose.view_angle = 36.6f;  // the open side, 3 away and 2 high, fills the picture
    builder.scene().cameras.push_back(pose);
    add_room(builder);
    add_lights(builder);
    const std::uint32_t plaster = builder.add_material(matte(glm::vec3(0.74f)));
    add_block(builder, {-0.38f, -0.42f}, {0.56f, 0.62f, 0.56f}, 20.0f, plaster);

    Material mirror;
    mirror.diffuse = glm::vec3(0.0f);
    mirror.specular = glm::vec3(0.0f);
    mirror.mirror = glm::vec3(0.92f);
    builder.add(Sphere{{-0.38f, 0.98f, -0.42f}, 0.36f}, builder.add_material(mirror));

    Material glass;
    glass.diffuse = glass.specular = glm::vec3(0.0f);
    glass.glass = true;
    glass.ior = 1.5f;
    builder.add(Sphere{{0.42f, 0.36f, 0.25f}, 0.36f}, builder.add_material(glass));
    return builder;
}

}  // namespace glint::builtin
