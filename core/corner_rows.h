// What belongs to the corners of eight triangles, read from lists of vectors into rows of eight numbers.
// Knows no hits. Needs AVX2. Invariant: nothing outside the lists is read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace glint {

constexpr std::size_t kCornerRun = 8;
using CornerRows = float[3][3][kCornerRun];  // by corner and axis, each row aligned to 32 bytes

// Row [c][axis] gets from[triangles[index[k]][c]][axis] at place k.
void read_corners_avx2(const std::vector<glm::vec3>& from, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                       const std::uint32_t (&index)[kCornerRun], CornerRows& rows) noexcept;

}  // namespace glint
