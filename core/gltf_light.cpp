#include "core/gltf_light.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr const char* kExtension = "KHR_lights_punctual";
constexpr double kHalfPi = std::numbers::pi / 2.0;

// The index of the node's light, or -1. tinygltf 2.7 keeps the extension but does not read it.
int light_of(const tinygltf::Node& node) {
    const auto found = node.extensions.find(kExtension);
    if (found == node.extensions.end() || !found->second.IsObject()) return -1;
    const tinygltf::Value& light = found->second.Get("light");
    return light.IsInt() ? light.GetNumberAsInt() : -1;
}

// A number >= 0 that float can hold; 0 with a warning otherwise.
float magnitude(double x, const std::string& what, GltfReport& report) {
    if (x >= 0.0 && x <= static_cast<double>(std::numeric_limits<float>::max())) return static_cast<float>(x);
    report.warn(what + " is no usable number and counts as 0");
    return 0.0f;
}

void set_cone(const tinygltf::SpotLight& spot, Light& light, const std::string& place, GltfReport& report) {
    double outer = spot.outerConeAngle, inner = spot.innerConeAngle;
    if (!(outer > 0.0 && outer <= kHalfPi)) {
        report.warn(place + ".spot.outerConeAngle is outside 0..pi/2, pi/4 is used");
        outer = std::numbers::pi / 4.0;
    }
    if (!(inner >= 0.0 && inner < outer)) {
        report.warn(place + ".spot.innerConeAngle is outside 0..outerConeAngle, 0 is used");
        inner = 0.0;
    }
    light.cos_inner = static_cast<float>(std::cos(inner));
    light.cos_outer = static_cast<float>(std::cos(outer));
}

Light directional(glm::dvec3 towards, glm::vec3 irradiance) {
    Light light;
    light.shape = Light::Shape::directional;
    light.falloff = Light::Falloff::physical;
    light.direction = glm::vec3(-glm::normalize(towards));
    light.emission = irradiance;
    return light;
}

// A sun over the viewer's left shoulder and a third as much from beside the eye, whose shadows hide behind what throws them:
// whatever the first picture shows is lit. A white surface that faces the sun gets radiance 0.9 or so.
void add_default_sun(Scene& scene) {
    const CameraPose& camera = scene.cameras.front();
    const glm::dvec3 back = glm::normalize(glm::dvec3(camera.eye) - glm::dvec3(camera.target));
    glm::dvec3 right = glm::cross(glm::dvec3(camera.up), back);
    // An up vector along the view has no right side; any axis will do.
    if (!(glm::dot(right, right) > 0.0)) right = std::abs(back.x) < 0.5 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    right = glm::normalize(right);
    const glm::dvec3 up = glm::cross(back, right);
    const float pi = std::numbers::pi_v<float>;
    scene.lights.push_back(directional(back + 1.1 * up - 0.7 * right, 0.65f * pi * glm::vec3(1.0f, 0.97f, 0.92f)));
    scene.lights.push_back(directional(back + 0.15 * up + 0.2 * right, 0.25f * pi * glm::vec3(0.92f, 0.96f, 1.0f)));
}

}  // namespace

void read_gltf_light(const tinygltf::Model& model, int node_index, const glm::dmat4& world_from_node, Scene& scene,
                     GltfReport& report) {
    const tinygltf::Node& node = model.nodes.at(static_cast<std::size_t>(node_index));
    if (!node.extensions.contains(kExtension)) return;
    const int index = light_of(node);
    if (index < 0 || static_cast<std::size_t>(index) >= model.lights.size()) {
        report.fail(fmt::format("nodes[{}].extensions.{} names no light of the file", node_index, kExtension));
    }
    const tinygltf::Light& source = model.lights[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("lights[{}]", index);

    Light light;
    light.falloff = Light::Falloff::physical;
    if (source.type == "directional") {
        light.shape = Light::Shape::directional;
    } else if (source.type != "point" && source.type != "spot") {
        return report.warn(place + " is neither point, spot nor directional and is left out");
    }
    const glm::dvec3 position(world_from_node[3]);
    const glm::dvec3 direction = -glm::dvec3(world_from_node[2]);  // lights shine along their own -z
    const double length = std::sqrt(glm::dot(direction, direction));
    if (!(length > 0.0) || !std::isfinite(length) || !valid_vertex(glm::vec3(position))) {
        return report.warn(fmt::format("nodes[{}] gives its light no place or direction, it is left out", node_index));
    }
    light.position = glm::vec3(position);
    light.direction = glm::vec3(direction / length);
    if (source.type == "spot") set_cone(source.spot, light, place, report);
    light.range = magnitude(source.range, place + ".range", report);
    const float intensity = magnitude(source.intensity, place + ".intensity", report);
    light.emission = glm::vec3(intensity);
    if (source.color.size() == 3) {
        for (int i = 0; i < 3; ++i)
            light.emission[i] *= magnitude(source.color[static_cast<std::size_t>(i)], place + ".color", report);
    }
    scene.lights.push_back(light);
}

void finish_gltf_light(Scene& scene, GltfReport& report) {
    // Bright and nearly grey: metals need something to reflect, and a picture of a model is about the model.
    Environment& sky = scene.environment;
    sky.kind = Environment::Kind::sky;
    sky.zenith = glm::vec3(0.30f, 0.40f, 0.56f);
    sky.horizon = glm::vec3(0.70f, 0.75f, 0.80f);
    sky.ground = glm::vec3(0.15f, 0.145f, 0.14f);
    if (!scene.lights.empty()) return;
    add_default_sun(scene);
    report.warn("no light: a sun over the camera's shoulder and a sky are added");
}

}  // namespace glint
