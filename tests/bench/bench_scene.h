// The scenes of the kernel benchmark as geometry, camera and light.
// Knows where scenes come from; not what is measured on them. Invariant: triangles and spheres only (a box becomes twelve
// triangles), because those are what the peers have too; cones and planes are left out and counted.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/geometry.h"
#include "core/camera.h"

namespace glint::bench {

struct SceneSource {
    std::string_view name;
    std::string_view source;  // a built-in scene, or a path below the shared folder
    bool mesh = false;        // scaled to a diagonal of 100 and framed tightly; else seen by the scene's own camera
    bool by_default = true;
};
[[nodiscard]] const std::vector<SceneSource>& scene_sources();

struct BenchScene {
    std::string name;
    std::shared_ptr<const Geometry> geometry;
    CameraPose pose;
    glm::vec3 light{0.0f};
    float diagonal = 0.0f;
    std::size_t left_out = 0;  // cones and planes
};

// Empty, with one line on stderr, where the scene is not to be had.
[[nodiscard]] std::optional<BenchScene> load_bench_scene(const SceneSource& source, const std::string& shared_folder);

}  // namespace glint::bench
