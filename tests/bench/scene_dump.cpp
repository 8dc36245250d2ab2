// scene_dump SCENE FILE: the scene for tests/bench/pictures, which hands it to other renderers. Spheres, materials, lights and
// camera as JSON on stdout; in FILE, as the machine's own floats and integers, the vertices (three numbers each), the triangles
// (three indices each) and one material index a triangle: as text a large mesh would take longer to read than to render.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <span>

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
    json out{{"vertices", g.vertices.size()}, {"triangles", g.triangles.size()},
             {"spheres", json::array()},      {"materials", json::array()},
             {"lights", json::array()},       {"left_out", g.boxes.size() + g.cones.size() + g.planes.size()}};
    for (const Sphere& s : g.spheres) out["spheres"].push_back({s.center.x, s.center.y, s.center.z, s.radius});
    for (const Material& m : scene.materials) out["materials"].push_back(material_json(m));
    for (const Light& light : scene.lights) out["lights"].push_back(triple(light.position));
    out["sphere_material"] = scene.material_of[static_cast<std::size_t>(PrimitiveKind::sphere)];
    out["background"] = triple(scene.environment.color);
    const CameraPose& pose = scene.cameras.front();
    out["camera"] = {
        {"eye", triple(pose.eye)}, {"target", triple(pose.target)}, {"up", triple(pose.up)}, {"angle", pose.view_angle}};
    return out;
}

template <class T>
void write(std::ofstream& out, const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

bool write_arrays(const Scene& scene, const char* path) {
    std::ofstream out(path, std::ios::binary);
    write(out, scene.geometry->vertices);
    write(out, scene.geometry->triangles);
    write(out, scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)]);
    out.close();
    return static_cast<bool>(out);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: scene_dump SCENE FILE\n");
        return 2;
    }
    try {
        LoadOptions options;
        options.load_environment = false;
        const std::shared_ptr<const Scene> scene = load_scene(argv[1], options);
        if (!write_arrays(*scene, argv[2])) {
            fmt::print(stderr, "{}: cannot write\n", argv[2]);
            return 5;
        }
        fmt::print("{}\n", to_json(*scene).dump());
        return 0;
    } catch (const SceneError& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
