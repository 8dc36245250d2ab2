// Rays that leave a primitive: how many meet it again, and how many pass through what stands close before it.
// Knows no picture. Invariant: counted against geometry, never against another rule; the same numbers in every run.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/numeric/offset_rules.h"

namespace glint::numeric {

enum class Axis { distance, scale };

// One rule for one primitive in one place. All primitives are convex, so a ray outwards can never meet its own again; the wall
// is the same primitive, larger by a thousandth, or by 24 roundings of its coordinates where that is more; where these come to a
// fifth of the size there is none.
struct OffsetCell {
    Axis axis;
    int exponent;  // 10^exponent sizes away from zero; or a size of 10^exponent, its own size away from zero
    PrimitiveKind primitive;
    const OffsetRule* rule;
    int rays = 0, self_hits = 0;  // none where floats cannot hold the primitive
    int walled = 0, leaks = 0;    // of the rays at most 60 degrees off the normal, where rounding has left the wall in place
    double offset = 0.0;          // mean distance of the start from the surface, in sizes
};

inline constexpr const char* kPrimitiveNames[] = {"triangle", "sphere", "box", "cone", "plane"};

// All rules and primitives at 10^0 to 10^7 sizes from zero and at sizes 10^-8 to 10^8, `rays` rays each.
[[nodiscard]] std::vector<OffsetCell> measure_offsets(int rays);

}  // namespace glint::numeric
