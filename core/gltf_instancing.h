// Where a glTF node shows its mesh: at one place, or at many by EXT_mesh_gpu_instancing.
// Knows no meshes. Invariant: accessors are checked before they are read. How many placements are too many is the caller's to
// say.
#pragma once

#include <functional>
#include <optional>

#include <tiny_gltf.h>
#include <glm/glm.hpp>

#include "core/gltf_report.h"

namespace glint {

// translation * rotation * scale as glTF writes them (2.0, section 3.5.3); the quaternion is made unit. Nothing where it is zero
// or not finite.
[[nodiscard]] std::optional<glm::dmat4> transform_of(glm::dvec3 translation, glm::dvec4 rotation_xyzw, glm::dvec3 scale);

// Calls visit(world_from_mesh) for each placement of the mesh of nodes[index].
void for_each_placement(const tinygltf::Model& model, int index, const glm::dmat4& world_from_node, const GltfReport& report,
                        const std::function<void(const glm::dmat4&)>& visit);

}  // namespace glint
