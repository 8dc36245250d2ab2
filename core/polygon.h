// Cuts a planar polygon, convex or not, into triangles that cover it exactly.
// Knows no file format and no mesh; positions in, corner numbers out. Lengths are in the caller's units, no tolerance decides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

// Concave polygons cost corners times reflex corners; beyond this many corners they would take minutes.
constexpr std::size_t kMaxPolygonCorners = 10000;

struct Triangulation {
    std::vector<std::array<std::uint32_t, 3>> triangles;  // corner numbers; the front is the polygon's front
    bool simple = true;                                   // false: the outline crosses itself, the cover is a guess
};

// Ear clipping (Meisters 1975, "Polygons have ears") with the bookkeeping of Eberly 1998, "Triangulation by ear clipping".
// The front is where the first three corners run counter-clockwise (Haines' NFF), also when the corner between is a reflex one.
// Empty when the polygon has no area. At most kMaxPolygonCorners corners: the caller's duty.
[[nodiscard]] Triangulation triangulate(std::span<const glm::dvec3> corners);

}  // namespace glint
