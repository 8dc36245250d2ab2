// The scenes that the course hands out as files, made from their recipes (Haines's SPD) and their few parameters.
#include <cmath>
#include <cstddef>

#include "core/builtin.h"
#include "core/mountain.h"
#include "core/sphereflake.h"

namespace glint::builtin {
namespace {

// The numbers of an `f` line, in its order and, as a reader has them, in double.
struct Finish {
    glm::dvec3 diffuse;
    double kd;
    glm::dvec3 specular;
    double ks, shine;
    double transmits = 0.0, ior = 1.0;
};

// P3F's rules: the strength of the highlight is the strength of the mirror too, and any transmittance makes glass.
Material to_material(const Finish& f) {
    Material m;
    m.diffuse = glm::vec3(f.diffuse * f.kd);
    m.specular = glm::vec3(f.specular * f.ks);
    m.shininess = static_cast<float>(f.shine);
    m.glass = f.transmits > 0.0;
    if (!m.glass) m.mirror = m.specular;
    m.ior = static_cast<float>(f.ior);
    return m;
}

const Finish kBallsFloor{{1.0, 0.75, 0.33}, 1.0, glm::dvec3(1.0), 0.0, 10.0};
const Finish kPolishedBall{{1.0, 0.9, 0.7}, 0.5, glm::dvec3(1.0), 0.5, 30.0827};

// All of these scenes are square pictures under 45 degrees unless they say otherwise.
SceneBuilder course_scene(glm::vec3 background, glm::vec3 eye, glm::vec3 up) {
    SceneBuilder builder;
    Scene& scene = builder.scene();
    scene.width = scene.height = 512;
    scene.transfer = Transfer::linear;
    scene.environment.color = background;
    CameraPose pose;
    pose.eye = eye;
    pose.up = up;
    scene.cameras.push_back(pose);
    return builder;
}

void add_point_light(SceneBuilder& builder, glm::vec3 position) {
    Light light;
    light.position = position;
    builder.scene().lights.push_back(light);
}

void add_three_lights(SceneBuilder& builder) {
    add_point_light(builder, {4.0f, 3.0f, 2.0f});
    add_point_light(builder, {1.0f, -4.0f, 4.0f});
    add_point_light(builder, {-3.0f, 1.0f, 5.0f});
}

void add_face(SceneBuilder& builder, glm::vec3 a, glm::vec3 b, glm::vec3 c, std::uint32_t material) {
    const std::uint32_t ia = builder.add_vertex(a), ib = builder.add_vertex(b), ic = builder.add_vertex(c);
    builder.add_triangle(ia, ib, ic, material);
}

}  // namespace

SceneBuilder balls(int level) {
    SceneBuilder builder = course_scene({0.078f, 0.361f, 0.753f}, {2.1f, 1.3f, 1.7f}, {0.0f, 0.0f, 1.0f});
    add_three_lights(builder);
    const std::uint32_t floor = builder.add_material(to_material(kBallsFloor));
    add_face(builder, {12.0f, 12.0f, -0.5f}, {-12.0f, 12.0f, -0.5f}, {-12.0f, -12.0f, -0.5f}, floor);
    add_face(builder, {-12.0f, -12.0f, -0.5f}, {12.0f, -12.0f, -0.5f}, {12.0f, 12.0f, -0.5f}, floor);
    const std::uint32_t ball = builder.add_material(to_material(kPolishedBall));
    for (const Sphere& s : sphereflake(level)) builder.add(s, ball);
    return builder;
}

SceneBuilder mount(int level) {
    SceneBuilder builder = course_scene({0.078f, 0.361f, 0.753f}, {-1.6f, 1.6f, 1.7f}, {0.0f, 0.0f, 1.0f});
    add_point_light(builder, {-100.0f, -100.0f, 100.0f});
    const std::uint32_t glass =
        builder.add_material(to_material({glm::dvec3(1.0), 0.1, glm::dvec3(1.0), 0.1, 101.148, 1.0, 1.6}));
    for (const Sphere& s : mountain_balls()) builder.add(s, glass);
    const std::uint32_t rock = builder.add_material(to_material({{0.5, 0.45, 0.35}, 1.0, glm::dvec3(1.0), 0.0, 100.0}));
    const Mountain mountain = fractal_mountain(level);
    for (const glm::vec3& v : mountain.vertices) builder.add_vertex(v);
    for (const auto& t : mountain.triangles) builder.add_triangle(t[0], t[1], t[2], rock);
    return builder;
}

SceneBuilder balls_box() {
    SceneBuilder builder = course_scene({0.678f, 0.761f, 0.953f}, {-4.0f, 0.7f, 4.0f}, {0.0f, 1.0f, 0.0f});
    CameraPose& pose = builder.scene().cameras.front();
    pose.target = {4.0f, 0.0f, -4.0f};
    pose.view_angle = 30.0f;
    add_point_light(builder, {0.5f, 3.0f, 4.0f});
    add_point_light(builder, {6.0f, 4.0f, 4.0f});
    add_point_light(builder, {-3.0f, 5.0f, 2.0f});
    const std::uint32_t floor = builder.add_material(to_material({{1.0, 0.75, 0.33}, 0.8, glm::dvec3(1.0), 0.2, 10.0}));
    add_face(builder, {2.5f, -1.0f, 2.5f}, {-2.5f, -1.0f, -2.5f}, {-2.5f, -1.0f, 2.5f}, floor);
    add_face(builder, {-2.5f, -1.0f, -2.5f}, {2.5f, -1.0f, 2.5f}, {2.5f, -1.0f, -2.5f}, floor);
    const std::uint32_t copper = builder.add_material(to_material({glm::dvec3(1.0), 0.0, {0.957, 0.639, 0.536}, 1.0, 190.0827}));
    builder.add(Box{glm::vec3(-0.35f), glm::vec3(0.35f)}, copper);
    const std::uint32_t aluminium =
        builder.add_material(to_material({glm::dvec3(1.0), 0.0, {0.916, 0.924, 0.924}, 1.0, 190.0827}));
    // The copper box stands where the flake's first ball would be.
    const std::vector<Sphere> flake = sphereflake(2);
    for (std::size_t i = 1; i < flake.size(); ++i) builder.add(flake[i], aluminium);
    return builder;
}

SceneBuilder dof() {
    SceneBuilder builder = course_scene({0.678f, 0.761f, 0.953f}, {7.5f, 4.5f, 2.0f}, {0.0f, 1.0f, 0.0f});
    // A P3F lens: the radius counts in pixels of the window at the target, the focus in distances to the target.
    constexpr double kAperture = 5.0, kFocal = 1.5, kDegrees = 3.14159265358979323846 / 180.0;
    CameraPose& pose = builder.scene().cameras.front();
    const double distance = glm::length(glm::dvec3(pose.eye) - glm::dvec3(pose.target));
    const double window = 2.0 * distance * std::tan(0.5 * static_cast<double>(pose.view_angle) * kDegrees);
    pose.lens_radius = static_cast<float>(kAperture * window / builder.scene().width);
    pose.focus_distance = static_cast<float>(kFocal * distance);
    add_three_lights(builder);
    const std::uint32_t floor = builder.add_material(to_material({{1.0, 0.75, 0.33}, 0.8, glm::dvec3(1.0), 0.0, 100.0}));
    add_face(builder, {10.0f, 0.0f, -10.0f}, {-10.0f, 0.0f, -10.0f}, {-10.0f, 0.0f, 10.0f}, floor);
    add_face(builder, {10.0f, 0.0f, 10.0f}, {10.0f, 0.0f, -10.0f}, {-10.0f, 0.0f, 10.0f}, floor);
    const std::uint32_t ball = builder.add_material(to_material(kPolishedBall));
    for (const float x : {0.0f, 1.5f, 3.0f, 4.5f, -1.5f, -3.0f, -4.5f}) builder.add(Sphere{{x, 0.5f, 0.0f}, 0.5f}, ball);
    return builder;
}

}  // namespace glint::builtin
