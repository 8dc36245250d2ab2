// Refuses the glTF files that tinygltf would misread, before it reads them: a GLB whose chunks lie about their size,
// JSON nested deep enough to exhaust the stack, buffers without end, indices out of range or no indices at all.
// Knows the layout of the format, not its meaning. Invariant: after check_gltf() every index between nodes, meshes,
// accessors, buffer views, buffers, materials, cameras and scenes names an existing entry.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/gltf_report.h"

namespace glint {

// All buffers of a file together; also the largest file that is read at all. Bytes.
constexpr std::uint64_t kMaxGltfBytes = std::uint64_t{1} << 31;

// GLB or JSON, told apart by the first four bytes.
[[nodiscard]] bool is_glb(std::string_view bytes);
// SceneError with the JSON path of the first thing that is wrong.
void check_gltf(std::string_view bytes, const GltfReport& report);

}  // namespace glint
