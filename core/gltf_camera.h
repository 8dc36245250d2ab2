// Cameras of a glTF scene, and the one that is made up where a file has none.
// Knows no lights. Invariant: eye and target of every pose differ in float, so that the view has a direction.
#pragma once

#include <optional>

#include <tiny_gltf.h>
#include <glm/glm.hpp>

#include "core/gltf_report.h"
#include "core/scene.h"

namespace glint {

// A camera as a node places it. `bounds` of the scene give the distance of the target and the size of what an
// orthographic camera sees. Nothing, with a warning, where the node's matrix leaves no view.
[[nodiscard]] std::optional<CameraPose> gltf_camera(const tinygltf::Camera& camera, const glm::dmat4& world_from_camera,
                                                    const Aabb& bounds, GltfReport& report);

// All vertices from three quarters, a little from above; they just fit into pictures from 4:3 on.
[[nodiscard]] CameraPose framing_camera(const Geometry& geometry, const Aabb& bounds);

}  // namespace glint
