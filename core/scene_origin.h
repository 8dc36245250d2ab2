// Which point of the world a scene's coordinates are counted from. Floats lie a 2^-23rd of their size apart, so a million
// sizes away from zero a scene would keep three bits of its shape; it is read relative to a point near its centre instead.
// Knows no file: a reader reads, asks suits(), and where the answer is no reads again, taking world() from every number.
// Invariant: world() stays zero for scenes near zero; else it is a multiple of a power of two above the scene's size, so that
// a scene around zero that is moved by such a multiple keeps its bits.
#pragma once

#include "core/scene.h"

namespace glint {

class SceneOrigin {
public:
    [[nodiscard]] const glm::dvec3& world() const { return world_; }
    // Whether what lies in `extent`, read relative to world(), may stay so. If not, world() has moved.
    [[nodiscard]] bool suits(const Aabb& extent);

private:
    glm::dvec3 world_{0.0};
    int moves_ = 0;
};

// True once no point that is added can make the extent a far one: bounds need not be collected any further.
[[nodiscard]] bool lies_near(const Aabb& extent);

// Bounds of all that was added but planes, and of the points that were marked; cut short where they lie near.
[[nodiscard]] Aabb extent_of(const Geometry& geometry, const Aabb& marked);

// From where to where the origin has to move; zero where the extent lies near.
[[nodiscard]] glm::dvec3 origin_shift(const Aabb& extent);

}  // namespace glint
