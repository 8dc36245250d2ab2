#include "accel/grid_level.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace glint {
namespace {

constexpr double kMaxCells = 1.0e8;
constexpr double kMaxCellsPerAxis = 1 << 14;

}  // namespace

GridLevel make_level(const DoubleBox& box, double cells) {
    GridLevel level{};
    const glm::dvec3 size = box.size();
    // No side below a thousandth of the widest, so that flat contents have a volume.
    const glm::dvec3 sides = glm::max(size, glm::dvec3(std::max(size.x, std::max(size.y, size.z)) * 0x1p-10));
    const double per_length = std::cbrt(std::min(cells, kMaxCells) / (sides.x * sides.y * sides.z));
    for (int i = 0; i < 3; ++i) {
        level.lo[i] = std::nextafter(static_cast<float>(box.lo[i]), -kInfinity);
        level.n[i] = static_cast<std::uint16_t>(std::clamp(std::round(size[i] * per_length), 1.0, kMaxCellsPerAxis));
        const double side = (box.hi[i] - static_cast<double>(level.lo[i])) / level.n[i];
        // A point at the origin has no size at all, and its reciprocal must be a number.
        level.size[i] = std::max(std::nextafter(static_cast<float>(side), kInfinity), std::numeric_limits<float>::min());
        level.inverse[i] = 1.0f / level.size[i];
    }
    return level;
}

std::size_t cell_count(const GridLevel& l) { return std::size_t{l.n[0]} * l.n[1] * l.n[2]; }

DoubleBox box_of(const GridLevel& level, glm::ivec3 cell) {
    DoubleBox box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = static_cast<double>(level.lo[i]) + cell[i] * static_cast<double>(level.size[i]);
        box.hi[i] = static_cast<double>(level.lo[i]) + (cell[i] + 1) * static_cast<double>(level.size[i]);
    }
    return box;
}

}  // namespace glint
