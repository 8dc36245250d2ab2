#include "bench_scene.h"

#include <cmath>
#include <filesystem>

#include <fmt/core.h>

#include "core/scene_io.h"

namespace glint::bench {
namespace {

constexpr double kMeshDiagonal = 100.0;
constexpr float kFramingMargin = 1.02f;
constexpr float kFarthestLight = 10.0f;  // diagonals

// Two triangles a side, corners shared.
void add_box(const Box& box, Geometry& geometry) {
    const auto first = static_cast<std::uint32_t>(geometry.vertices.size());
    for (unsigned corner = 0; corner < 8; ++corner) {
        geometry.vertices.emplace_back(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                       corner & 4 ? box.hi.z : box.lo.z);
    }
    constexpr std::uint32_t kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& s : kSides) {
        geometry.triangles.push_back({first + s[0], first + s[1], first + s[2]});
        geometry.triangles.push_back({first + s[0], first + s[2], first + s[3]});
    }
}

// A mesh comes on a stage of its own, a floor of another material; what is measured is the mesh.
Geometry first_material_only(const Scene& scene) {
    const auto& materials = scene.material_of[static_cast<std::size_t>(PrimitiveKind::triangle)];
    Geometry geometry;
    geometry.vertices = scene.geometry->vertices;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (materials[i] == materials.front()) geometry.triangles.push_back(scene.geometry->triangles[i]);
    }
    return geometry;
}

Geometry triangles_and_spheres(const Geometry& from) {
    Geometry geometry;
    geometry.vertices = from.vertices;
    geometry.triangles = from.triangles;
    geometry.spheres = from.spheres;
    for (const Box& box : from.boxes) add_box(box, geometry);
    return geometry;
}

// Centred on the origin. A triangle that scaling makes degenerate goes, as in a reader.
void scale_to_diagonal(Geometry& geometry) {
    const Aabb bounds = geometry.bounds();
    const glm::dvec3 center = 0.5 * (glm::dvec3(bounds.lo) + glm::dvec3(bounds.hi));
    const double scale = kMeshDiagonal / glm::length(glm::dvec3(bounds.hi) - glm::dvec3(bounds.lo));
    for (glm::vec3& v : geometry.vertices) v = glm::vec3((glm::dvec3(v) - center) * scale);
    for (Sphere& s : geometry.spheres) {
        s.center = glm::vec3((glm::dvec3(s.center) - center) * scale);
        s.radius = static_cast<float>(s.radius * scale);
    }
    std::erase_if(geometry.triangles, [&](const auto& t) {
        return !valid_triangle(geometry.vertices[t[0]], geometry.vertices[t[1]], geometry.vertices[t[2]]);
    });
}

// Looks at the middle from two diagonals away, so that the mesh just fits into a square picture.
CameraPose tight_pose(const Geometry& geometry) {
    const Aabb bounds = geometry.bounds();
    const float diagonal = glm::length(bounds.size());
    CameraPose pose;
    pose.target = bounds.center();
    pose.eye = pose.target + 2.0f * diagonal * glm::normalize(glm::vec3(0.35f, 0.3f, 1.0f));
    const glm::vec3 forward = glm::normalize(pose.target - pose.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, pose.up)), up = glm::cross(right, forward);
    float slope = 0.0f;
    const auto see = [&](glm::vec3 point, float radius) {
        const glm::vec3 p = point - pose.eye;
        const float sideways = std::max(std::abs(glm::dot(p, right)), std::abs(glm::dot(p, up))) + radius;
        slope = std::max(slope, sideways / glm::dot(p, forward));
    };
    for (const auto& t : geometry.triangles) {
        for (const std::uint32_t i : t) see(geometry.vertices[i], 0.0f);
    }
    for (const Sphere& s : geometry.spheres) see(s.center, s.radius);
    pose.view_angle = glm::degrees(2.0f * std::atan(slope * kFramingMargin));
    return pose;
}

// Where the scene's first point light stands, if it has one, else above the camera's left shoulder. A light beyond ten
// diagonals is brought there: its rays are as good as parallel, and a grid's way with rays from far away (brute force)
// would take hours.
glm::vec3 light_position(const Scene& scene, const Aabb& bounds, bool use_scene) {
    const float diagonal = glm::length(bounds.size());
    glm::vec3 offset = diagonal * glm::vec3(-0.6f, 1.5f, 0.9f);
    if (use_scene) {
        for (const Light& light : scene.lights) {
            if (light.shape != Light::Shape::point) continue;
            offset = light.position - bounds.center();
            break;
        }
    }
    const float farthest = kFarthestLight * diagonal, distance = glm::length(offset);
    return bounds.center() + (distance > farthest ? farthest / distance : 1.0f) * offset;
}

std::shared_ptr<const Scene> load(const SceneSource& source, const std::string& shared_folder) {
    LoadOptions options;
    options.load_environment = false;
    if (source.source.starts_with("builtin:")) return load_scene(std::string(source.source), options);
    const std::filesystem::path path = std::filesystem::path(shared_folder) / "scenes" / source.source;
    if (!std::filesystem::exists(path)) throw SceneError(fmt::format("{}: not there", path.string()));
    return load_scene(path.string(), options);
}

}  // namespace

const std::vector<SceneSource>& scene_sources() {
    static const std::vector<SceneSource> sources{
        {"knot-1e4", "builtin:knot,n=10000", true},
        {"knot-1e5", "builtin:knot,n=100000", true},
        {"knot", "builtin:knot,n=868870", true},
        {"knot-1e7", "builtin:knot,n=10000000", true, false},
        {"dragon", "mesh/dragon_vrip.ply.gz", true},
        {"dragon-res2", "mesh/dragon_vrip_res2.ply.gz", true},
        {"dragon-res4", "mesh/dragon_vrip_res4.ply.gz", true},
        {"dragon-paper", "p3f/dragon.p3f"},
        {"balls-4", "builtin:balls,level=4"},
        {"balls-5", "builtin:balls,level=5"},
        {"mount-7", "builtin:mount,level=7"},
        {"stadium", "builtin:stadium"},
        {"soup", "builtin:soup"},
    };
    return sources;
}

std::optional<BenchScene> load_bench_scene(const SceneSource& source, const std::string& shared_folder) {
    try {
        const std::shared_ptr<const Scene> loaded = load(source, shared_folder);
        Geometry geometry = source.mesh ? first_material_only(*loaded) : triangles_and_spheres(*loaded->geometry);
        BenchScene scene;
        scene.name = source.name;
        scene.left_out = loaded->geometry->cones.size() + loaded->geometry->planes.size();
        if (source.mesh) scale_to_diagonal(geometry);
        scene.pose = source.mesh ? tight_pose(geometry) : loaded->cameras.front();
        const Aabb bounds = geometry.bounds();
        scene.light = light_position(*loaded, bounds, !source.mesh);
        scene.diagonal = glm::length(bounds.size());
        scene.geometry = std::make_shared<const Geometry>(std::move(geometry));
        return scene;
    } catch (const SceneError& error) {
        fmt::print(stderr, "{} skipped: {}\n", source.name, error.what());
        return std::nullopt;
    }
}

}  // namespace glint::bench
