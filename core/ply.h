// A polygon mesh in the PLY format (Turk 1994), as text or binary of either byte order: positions, normals, faces.
// Knows no scene and no material; other elements and properties are skipped.
// Invariant: positions are finite, every corner is below positions.size(), every face has 3 to kMaxPolygonCorners corners;
// memory is bounded by the size of the file, whatever its header claims.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

struct PlyMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;      // empty, or as long as positions; any length, finite or not
    std::vector<std::uint32_t> corners;  // per face: how many, then 0-based vertex numbers
};

// Positions are relative to `origin`, which is taken from them before they are rounded to float.
// Throws SceneError `name:line: reason`, for binary data `name:byte offset: reason`.
[[nodiscard]] PlyMesh read_ply(std::string_view file, const std::string& name, glm::dvec3 origin = glm::dvec3(0.0));

}  // namespace glint
