// A (2,3) torus knot as a closed tube whose surface is displaced by six octaves of waves: a dense mesh for tests and figures.
// Knows no scene or material. Closed, wound outwards, vertices shared; about 100 units across its bounds, centred at the
// origin, the knot's axis along z. The same floats on every machine: nothing but + - * / and floor in double is used.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

// The tube lies around kKnotScale * (((2 + cos 3u) cos 2u, (2 + cos 3u) sin 2u, sin 3u) - kKnotCenter), u in [0, 2 pi).
constexpr double kKnotScale = 9.93;
constexpr glm::dvec3 kKnotCenter(0.316, -0.041, -0.045);
constexpr int kMinKnotTriangles = 10000, kMaxKnotTriangles = 10000000;

struct KnotMesh {
    std::vector<glm::vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

// n triangles, or n - 1 where n is odd: a closed surface has three edges for every two triangles.
[[nodiscard]] KnotMesh torus_knot(int n);

}  // namespace glint
