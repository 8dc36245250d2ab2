// scene_dump SCENE: the scene as JSON on stdout, for tests/bench/pictures, which hands it to other renderers.
// Flat arrays: vertices and centres three numbers each, triangles three indices; one material index a primitive.
#include <cstdio>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/scene_io.h"

namespace {

using namespace glint;
using nlohmann::json;

json triple(const glm::vec3& v) { return {v.x, v.y, v.z}; }

json material_json(const Material& m) {
    return {{"diffuse", triple(m.diffuse)},
            {"specular", triple(m.specular)},
            {"shininess", m.shininess},
            {"mirror", triple(m.mirror)},
            {"glass", m.glass},
            {"ior", m.ior}};
}

json to_json(const Scene& scene) {
    const Geometry& g = *scene.geometry;
    json out{{"vertices", json::array()}, {"triangles", json::array()},
             {"spheres", json::array()},  {"materials", json::array()},
             {"lights", json::array()},   {"left_out", g.boxes.size() + g.cones.size() + g.planes.size()}};
    for (const glm::vec3& v : g.vertices) out["vertices"].insert(out["vertices"].end(), {v.x, v.y, v.z});
    for (const auto& t : g.triangles) out["triangles"].insert(out["triangles"].end(), {t[0], t[1], t[2]});
    for (const Sphere& s : g.spheres) out["spheres"].push_back({s.center.x, s.center.y, s.center.z, s.radius});
    for (const Material& m : scene.materials) out["materials"].push_back(material_json(m));
    for (const Light& light : scene.lights) out["lights"].push_back(triple(light.position));
    out["triangle_material"] = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)];
    out["sphere_material"] = scene.material_of[static_cast<std::size_t>(PrimitiveKind::sphere)];
    out["background"] = triple(scene.environment.color);
    const CameraPose& pose = scene.cameras.front();
    out["camera"] = {
        {"eye", triple(pose.eye)}, {"target", triple(pose.target)}, {"up", triple(pose.up)}, {"angle", pose.view_angle}};
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        fmt::print(stderr, "usage: scene_dump SCENE\n");
        return 2;
    }
    try {
        LoadOptions options;
        options.load_environment = false;
        fmt::print("{}\n", to_json(*load_scene(argv[1], options)).dump());
        return 0;
    } catch (const SceneError& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
