#include "core/gltf_instancing.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "core/gltf_accessor.h"

namespace glint {
namespace {

constexpr const char* kExtension = "EXT_mesh_gpu_instancing";

// An attribute of the extension; nothing where the node does without it.
std::optional<AccessorView> attribute(const tinygltf::Model& model, const tinygltf::Value& attributes, const std::string& name,
                                      int components, int node, const GltfReport& report) {
    if (!attributes.Has(name)) return std::nullopt;
    const tinygltf::Value& value = attributes.Get(name);
    const std::string place = fmt::format("nodes[{}].{}.{}", node, kExtension, name);
    const int accessor = value.IsInt() ? value.GetNumberAsInt() : -1;
    if (accessor < 0 || static_cast<std::size_t>(accessor) >= model.accessors.size())
        report.fail(place + " is not the number of an accessor");
    AccessorView view(model, accessor, report);
    if (view.components() != components) report.fail(fmt::format("{} is not an array of VEC{}", place, components));
    return view;
}

}  // namespace

std::optional<glm::dmat4> transform_of(glm::dvec3 translation, glm::dvec4 rotation_xyzw, glm::dvec3 scale) {
    const glm::dquat q(rotation_xyzw.w, rotation_xyzw.x, rotation_xyzw.y, rotation_xyzw.z);
    const double norm = glm::length(q);
    // Written with few digits it is not quite of unit length; as nothing at all it is no rotation.
    if (!(norm > 0.0) || !std::isfinite(norm)) return std::nullopt;
    glm::dmat4 m = glm::mat4_cast(q / norm);
    for (int i = 0; i < 3; ++i) m[i] *= scale[i];
    m[3] = glm::dvec4(translation, 1.0);
    return m;
}

void for_each_placement(const tinygltf::Model& model, int index, const glm::dmat4& world_from_node, const GltfReport& report,
                        const std::function<void(const glm::dmat4&)>& visit) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const auto extension = node.extensions.find(kExtension);
    if (extension == node.extensions.end()) return visit(world_from_node);
    const tinygltf::Value none{tinygltf::Value::Object()};
    const bool has = extension->second.IsObject() && extension->second.Has("attributes");
    const tinygltf::Value& attributes = has ? extension->second.Get("attributes") : none;
    if (!attributes.IsObject()) report.fail(fmt::format("nodes[{}].{}.attributes is not an object", index, kExtension));
    const auto translations = attribute(model, attributes, "TRANSLATION", 3, index, report);
    const auto rotations = attribute(model, attributes, "ROTATION", 4, index, report);
    const auto scales = attribute(model, attributes, "SCALE", 3, index, report);
    std::size_t count = 0;
    for (const auto* view : {&translations, &rotations, &scales}) {
        if (*view) count = std::max(count, (*view)->size());
    }
    for (const auto* view : {&translations, &rotations, &scales}) {
        if (*view && (*view)->size() != count)
            report.fail(fmt::format("nodes[{}].{} has attributes of different lengths", index, kExtension));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec4 rotation =
            rotations ? glm::dvec4(rotations->vec3(i), rotations->component(i, 3)) : glm::dvec4(0.0, 0.0, 0.0, 1.0);
        const auto node_from_mesh = transform_of(translations ? translations->vec3(i) : glm::dvec3(0.0), rotation,
                                                 scales ? scales->vec3(i) : glm::dvec3(1.0));
        if (!node_from_mesh) report.fail(fmt::format("nodes[{}].{}.ROTATION[{}] is not a rotation", index, kExtension, i));
        visit(world_from_node * *node_from_mesh);
    }
}

}  // namespace glint
