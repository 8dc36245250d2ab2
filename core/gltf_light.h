// Light of a glTF scene: KHR_lights_punctual, and what stands in where a file has no light or no surroundings.
// Knows no materials. The numbers of the file are kept: candela for points and spots, lux for directional lights, taken as
// radiant intensity and irradiance.
#pragma once

#include <tiny_gltf.h>
#include <glm/glm.hpp>

#include "core/gltf_report.h"
#include "core/scene.h"

namespace glint {

// Adds the light of `node` to the scene, if it has one.
void read_gltf_light(const tinygltf::Model& model, int node, const glm::dmat4& world_from_node, Scene& scene, GltfReport& report);

// The sky that every glTF scene stands in, and, announced, a sun where the scene has no light; cameras[0] must be set.
void finish_gltf_light(Scene& scene, GltfReport& report);

}  // namespace glint
