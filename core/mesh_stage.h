// A stage for a mesh that comes without one: floor, camera and light.
// Knows no file. Everything is measured by the mesh's bounds, so a scaled mesh gives the same picture. +y is up.
#pragma once

#include <glm/glm.hpp>

#include "core/scene.h"

namespace glint {

// Light clay with a soft highlight and a trace of light of its own, which stands for a room's indirect light.
[[nodiscard]] Material clay(glm::vec3 albedo = glm::vec3(0.70f, 0.67f, 0.62f));

// A floor that touches the mesh from below (none below a flat or floating one), a camera that sees all vertices within the
// bounds from three quarters above, and a point light without falloff over the camera's shoulder.
// The builder must hold at least one bounded primitive.
struct Stage {
    bool floor = true;
    float turn = 28.0f;  // of the camera around +y, degrees; 0 looks along -z
};
void set_stage(SceneBuilder& builder, const Stage& stage = {});

}  // namespace glint
