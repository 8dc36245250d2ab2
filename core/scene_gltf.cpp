// The glTF/GLB reader: checks the file, lets tinygltf parse it, walks the node tree and fills a scene.
#include <algorithm>
#include <array>
#include <cstdint>
#include <new>
#include <string_view>

#include <fmt/format.h>
#include <tiny_gltf.h>
#include <glm/gtc/matrix_transform.hpp>

#include "core/gltf_camera.h"
#include "core/gltf_check.h"
#include "core/gltf_files.h"
#include "core/gltf_instancing.h"
#include "core/gltf_light.h"
#include "core/gltf_mesh.h"
#include "core/gltf_report.h"
#include "core/scene_io.h"
#include "core/scene_origin.h"
#include "core/seen_vertices.h"

namespace glint {
namespace {

constexpr std::size_t kMaxNodeDepth = 512;

constexpr std::array<std::string_view, 7> kSupportedExtensions{
    "EXT_mesh_gpu_instancing", "KHR_lights_punctual",        "KHR_materials_unlit",  "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_transmission", "KHR_mesh_quantization"};

bool supported(std::string_view extension) {
    return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), extension) != kSupportedExtensions.end();
}

// Pictures are not shown yet, so none is decoded: neither a broken one nor one of 65535 x 65535 pixels can do harm.
bool ignore_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

tinygltf::Model parse(const std::string& bytes, const std::filesystem::path& folder, GltfReport& report) {
    check_gltf(bytes, report);
    GuardedFolder files(folder, kMaxGltfBytes);
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks(files.callbacks());
    parser.SetImageLoader(&ignore_image, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const auto size = static_cast<unsigned int>(bytes.size());
    bool parsed = false;
    try {
        parsed = is_glb(bytes)
                     ? parser.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()),
                                                   size, files.base())
                     : parser.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, files.base());
    } catch (const std::bad_alloc&) {
        report.fail("not enough memory");
    } catch (const std::exception& e) {
        // For example an empty data chunk, or a value of a type that the parser did not expect.
        report.fail(fmt::format("cannot be parsed: {}", e.what()));
    }
    if (!parsed) report.fail(files.refusal().empty() ? error : files.refusal());
    if (!error.empty()) report.warn(error);
    if (!warning.empty()) report.warn(warning);
    return model;
}

void check_extensions(const tinygltf::Model& model, GltfReport& report) {
    for (const std::string& name : model.extensionsRequired) {
        if (!supported(name)) report.fail(fmt::format("needs the extension {}, which is not supported", name));
    }
    const auto warn = [&](const std::string& name) {
        if (!supported(name)) report.warn(fmt::format("the extension {} is not supported and is ignored", name));
    };
    for (const std::string& name : model.extensionsUsed) warn(name);
    for (const tinygltf::Material& material : model.materials) {
        for (const auto& [name, value] : material.extensions) warn(name);
    }
}

void warn_of_motion(const tinygltf::Model& model, GltfReport& report) {
    if (!model.animations.empty()) report.warn("animations are not supported, the scene stands in its rest pose");
    const auto skinned = [](const tinygltf::Node& n) { return n.skin >= 0; };
    if (std::any_of(model.nodes.begin(), model.nodes.end(), skinned))
        report.warn("skins are not supported, meshes stand in their rest pose");
}

// matrix, or translation * rotation * scale (glTF 2.0, section 3.5.3); lengths were checked by check_gltf().
glm::dmat4 local_transform(const tinygltf::Node& node, int index, const GltfReport& report) {
    glm::dmat4 m(1.0);
    if (node.matrix.size() == 16) {
        for (std::size_t i = 0; i < 16; ++i) m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node.matrix[i];
        return m;
    }
    const auto three = [](const std::vector<double>& v, double otherwise) {
        return v.size() == 3 ? glm::dvec3(v[0], v[1], v[2]) : glm::dvec3(otherwise);
    };
    const std::vector<double>& r = node.rotation;
    const glm::dvec4 rotation = r.size() == 4 ? glm::dvec4(r[0], r[1], r[2], r[3]) : glm::dvec4(0.0, 0.0, 0.0, 1.0);
    const auto parent_from_node = transform_of(three(node.translation, 0.0), rotation, three(node.scale, 1.0));
    if (!parent_from_node) report.fail(fmt::format("nodes[{}].rotation is not a rotation", index));
    return *parent_from_node;
}

// Where the walk begins: the scene that the file chooses, else its first, else every node that is no one's child.
std::vector<int> root_nodes(const tinygltf::Model& model, GltfReport& report) {
    if (!model.scenes.empty()) {
        const std::size_t count = model.scenes.size();
        const auto chosen = static_cast<std::size_t>(std::max(0, model.defaultScene));
        if (count > 1) report.warn(fmt::format("scenes[{}] of {} scenes is shown", chosen, count));
        return model.scenes.at(chosen).nodes;
    }
    if (!model.nodes.empty()) report.warn("no scene: all nodes are shown");
    std::vector<char> is_child(model.nodes.size(), 0);
    for (const tinygltf::Node& node : model.nodes) {
        for (const int child : node.children) is_child.at(static_cast<std::size_t>(child)) = 1;
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
        if (is_child[i] == 0) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

// Calls visit(node, world_from_node) for each node in depth-first order, the world counted from `origin`. Each level keeps a
// cursor instead of a queue of children, so memory is bounded by the depth; a node that is met twice means a cycle or two
// parents, and both are refused.
template <typename Visit>
void walk(const tinygltf::Model& model, const std::vector<int>& roots, glm::dvec3 origin, const GltfReport& report, Visit visit) {
    struct Level {
        const std::vector<int>* nodes;
        std::size_t next;
        glm::dmat4 world_from_parent;
    };
    std::vector<char> seen(model.nodes.size(), 0);
    std::vector<Level> stack{{&roots, 0, glm::translate(glm::dmat4(1.0), -origin)}};
    while (!stack.empty()) {
        Level& level = stack.back();
        if (level.next == level.nodes->size()) {
            stack.pop_back();
            continue;
        }
        const int index = (*level.nodes)[level.next++];
        char& met = seen.at(static_cast<std::size_t>(index));
        if (met != 0) report.fail(fmt::format("nodes[{}] is reached twice: the nodes do not form a tree", index));
        met = 1;
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
        const glm::dmat4 world_from_node = level.world_from_parent * local_transform(node, index, report);
        visit(index, world_from_node);
        if (node.children.empty()) continue;
        if (stack.size() >= kMaxNodeDepth) report.fail(fmt::format("nodes nested deeper than {} levels", kMaxNodeDepth));
        stack.push_back({&node.children, 0, world_from_node});
    }
}

struct PlacedCamera {
    int node, camera;
    glm::dmat4 world_from_camera;
};

void add_cameras(const tinygltf::Model& model, std::vector<PlacedCamera> placed, SceneBuilder& builder, GltfReport& report) {
    std::sort(placed.begin(), placed.end(), [](const PlacedCamera& a, const PlacedCamera& b) { return a.node < b.node; });
    Aabb bounds;
    for_each_seen_vertex(builder.geometry(), [&](glm::vec3 v) { bounds.grow(v); });  // only vertices of triangles were stored
    auto& cameras = builder.scene().cameras;
    for (const PlacedCamera& p : placed) {
        const auto pose = gltf_camera(model.cameras.at(static_cast<std::size_t>(p.camera)), p.world_from_camera, bounds, report);
        if (pose) cameras.push_back(*pose);
    }
    if (!cameras.empty()) return;
    cameras.push_back(framing_camera(builder.geometry(), bounds));
    report.warn("no camera: the whole scene is framed");
}

// Meshes and lights of all nodes; returns the cameras, which are added when the bounds are known.
std::vector<PlacedCamera> read_nodes(const tinygltf::Model& model, SceneBuilder& builder, GltfReport& report) {
    Scene& scene = builder.scene();
    GltfMeshReader meshes(model, builder, report);
    std::vector<PlacedCamera> cameras;
    const std::vector<int> roots = root_nodes(model, report);
    walk(model, roots, scene.origin, report, [&](int index, const glm::dmat4& world_from_node) {
        const int mesh = model.nodes[static_cast<std::size_t>(index)].mesh;
        if (mesh < 0) return;
        for_each_placement(model, index, world_from_node, report, [&](const glm::dmat4& m) { meshes.announce(mesh, m); });
    });
    meshes.plan();
    walk(model, roots, scene.origin, report, [&](int index, const glm::dmat4& world_from_node) {
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
        if (node.mesh >= 0)
            for_each_placement(model, index, world_from_node, report, [&](const glm::dmat4& m) { meshes.add(node.mesh, m); });
        if (node.camera >= 0) cameras.push_back({index, node.camera, world_from_node});
        read_gltf_light(model, index, world_from_node, scene, report);
    });
    meshes.report_dropped();
    return cameras;
}

}  // namespace

std::shared_ptr<const Scene> reader::read_gltf(const std::filesystem::path& path, const LoadOptions&) {
    GltfReport file_report(path.string());
    const tinygltf::Model model = parse(read_file(path, kMaxGltfBytes), path.parent_path(), file_report);
    check_extensions(model, file_report);
    warn_of_motion(model, file_report);

    for (SceneOrigin origin;;) {
        GltfReport report = file_report;
        SceneBuilder builder(origin.world());
        Scene& scene = builder.scene();
        scene.name = path.filename().string();
        scene.transfer = Transfer::srgb;
        scene.up = glm::vec3(0.0f, 1.0f, 0.0f);
        std::vector<PlacedCamera> cameras = read_nodes(model, builder, report);
        if (!origin.suits(builder.extent())) continue;
        if (builder.geometry().seen_count() == 0) report.warn("nothing to show: no triangle");
        add_cameras(model, std::move(cameras), builder, report);
        finish_gltf_light(scene, report);
        scene.warnings = report.take_warnings();
        return builder.finish();
    }
}

}  // namespace glint
