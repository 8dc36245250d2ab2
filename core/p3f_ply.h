// ASCII PLY (Turk 1994) as a P3F scene includes it: positions, normals where there are any, polygons.
// Knows no scene and no material; other elements and properties are skipped. Binary files are refused.
// Invariant: every corner is below positions.size(), every face has 3 to kMaxPolygonCorners corners.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace glint::p3f {

struct PlyMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;      // empty, or as long as positions
    std::vector<std::uint32_t> corners;  // per face: how many, then 0-based vertex numbers
};

// Throws SceneError `name:line: reason`.
[[nodiscard]] PlyMesh read_ply(std::string_view text, const std::string& name);

}  // namespace glint::p3f
