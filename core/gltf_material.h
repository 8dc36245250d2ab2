// From glTF's metallic-roughness material to ours: closed formulas, no textures.
// Knows no geometry. Radiometry: glTF lights give irradiance E, a glTF surface reflects base/pi * E; our diffuse has no
// 1/pi of its own, so it is stored here and the lights keep the numbers of the file.
#pragma once

#include <tiny_gltf.h>

#include "core/gltf_report.h"
#include "core/material.h"

namespace glint {

// Warns of everything that the result does not show: textures, alpha, unknown extensions.
[[nodiscard]] Material gltf_material(const tinygltf::Material& source, GltfReport& report);

}  // namespace glint
