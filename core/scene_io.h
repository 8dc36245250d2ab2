// The one door for scenes: a path or `builtin:NAME[,key=value...]` in, a finished Scene out.
// Knows which reader serves which ending; the readers know nothing of each other.
// Errors: SceneError with `path:line: reason`, also when memory does not suffice; what was merely skipped stands in
// Scene::warnings.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"

namespace glint {

struct LoadOptions {
    bool load_environment = true;       // false: pictures of a sky box are not even opened
    std::filesystem::path environment;  // a folder that replaces the scene's own environment; empty = none
};

[[nodiscard]] std::shared_ptr<const Scene> load_scene(const std::string& scene, const LoadOptions& options = {});

struct BuiltinScene {
    std::string_view name, parameters, description;
};
[[nodiscard]] const std::vector<BuiltinScene>& builtin_scenes();

// The readers, for tests; everyone else calls load_scene().
namespace reader {
// P3F and NFF, every dialect. `name` stands in messages; `folder` is where `env` and `ply` are looked up.
[[nodiscard]] std::shared_ptr<const Scene> read_p3f(std::string_view text, const std::string& name,
                                                    const std::filesystem::path& folder, const LoadOptions& options);
[[nodiscard]] std::shared_ptr<const Scene> read_gltf(const std::filesystem::path& path, const LoadOptions& options);
// A .ply, packed by gzip or not, on a stage of our own: a mesh has no camera and no light.
[[nodiscard]] std::shared_ptr<const Scene> read_mesh(const std::filesystem::path& path);
// spec: what follows `builtin:`, for example "balls,level=4".
[[nodiscard]] std::shared_ptr<const Scene> make_builtin(const std::string& spec);
// The whole file, at most `limit` bytes; SceneError when missing, a folder, unreadable or larger.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, std::size_t limit = std::size_t{1} << 31);
}  // namespace reader

}  // namespace glint
