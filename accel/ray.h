// Rays, boxes and answers of geometry queries, in scene units.
// Knows nothing of materials, lights or cameras.
// Invariant: a query reports hits with 0 < t <= t_max whose t is a normal float (neither infinite nor so small that float
// loses digits); `t` counts in lengths of `direction`, which need not be 1
// (below 1e-26, or 1e-26 of the coordinates, it counts as zero).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

namespace glint {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

enum class PrimitiveKind : std::uint32_t { triangle, sphere, box, cone, plane };
constexpr std::uint32_t kPrimitiveKinds = 5;

// Names one primitive: its kind in the top three bits, its index among that kind below.
// The order of ids settles ties: of two hits at equal t the lower id wins, in every accelerator.
using PrimitiveId = std::uint32_t;
constexpr PrimitiveId kNoPrimitive = 0xffffffffu;
constexpr std::uint32_t kMaxPrimitivesPerKind = 1u << 29;

constexpr PrimitiveId make_id(PrimitiveKind kind, std::uint32_t index) {
    return (static_cast<std::uint32_t>(kind) << 29) | index;
}
constexpr PrimitiveKind kind_of(PrimitiveId id) { return static_cast<PrimitiveKind>(id >> 29); }
constexpr std::uint32_t index_of(PrimitiveId id) { return id & (kMaxPrimitivesPerKind - 1); }

struct Ray {
    glm::vec3 origin{0.0f};
    glm::vec3 direction{0.0f, 0.0f, 1.0f};
    float t_max = kInfinity;
};

// The raw answer of `closest_hit`. u, v: barycentric weights of a triangle's second and third vertex;
// for a box u is the face (0..5 = -x +x -y +y -z +z); unused by the others.
struct Hit {
    float t = kInfinity;
    float u = 0.0f;
    float v = 0.0f;
    PrimitiveId primitive = kNoPrimitive;

    [[nodiscard]] bool found() const { return primitive != kNoPrimitive; }
};

// Axis-aligned box; empty until the first grow().
struct Aabb {
    glm::vec3 lo{kInfinity};
    glm::vec3 hi{-kInfinity};

    void grow(glm::vec3 p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    void grow(const Aabb& b) {
        lo = glm::min(lo, b.lo);
        hi = glm::max(hi, b.hi);
    }
    [[nodiscard]] bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
    [[nodiscard]] glm::vec3 size() const { return hi - lo; }
    [[nodiscard]] glm::vec3 center() const { return 0.5f * lo + 0.5f * hi; }
    // Half the surface area: the measure of the surface area heuristic (Goldsmith & Salmon 1987).
    [[nodiscard]] float half_area() const {
        const glm::vec3 d = size();
        return empty() ? 0.0f : d.x * d.y + d.y * d.z + d.z * d.x;
    }
    // Largest absolute coordinate; the unit of every rounding error inside the box.
    [[nodiscard]] float magnitude() const {
        if (empty()) return 0.0f;
        const glm::vec3 m = glm::max(glm::abs(lo), glm::abs(hi));
        return std::max(m.x, std::max(m.y, m.z));
    }
};

}  // namespace glint
