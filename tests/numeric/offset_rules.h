// Where a ray that leaves a surface may start: the rules of textbooks and renderers, and glint's.
// Knows no scene. Invariant: each gets the same hit, and says where the ray starts and which hits are passed over.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/surface_point.h"

namespace glint::numeric {

// A hit as a rule may use it.
struct Left {
    Ray ray;
    Hit hit;
    SurfacePoint s;          // glint's
    glm::vec3 from_weights;  // a triangle's point by its weights, in float; else o + td
    glm::vec3 along_ray() const { return ray.origin + hit.t * ray.direction; }
};

struct Start {
    glm::vec3 origin;
    float t_min = 0.0f;  // hits nearer than this are passed over
};

struct OffsetRule {
    const char *name, *label;  // of the files; of the page
    Start (*start)(const Left&);
    bool recentred = false;  // the primitive is read from a file and stored relative to a point near it
};

namespace rules {

inline float largest(glm::vec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

inline Start none(const Left& l) { return {l.along_ray()}; }
inline Start fixed(const Left& l) { return {l.along_ray() + 1e-4f * l.s.ng}; }
// The ray stays where it is and near hits do not count: the shadow rays of Embree's tutorials.
inline Start near_skipped(const Left& l) { return {l.along_ray(), 1e-3f}; }
inline Start by_distance(const Left& l) { return {l.along_ray() + 1e-4f * l.hit.t * l.s.ng}; }
// (1 + max|p|) * 1500 units of 2^-24: Mitsuba until 2026.
inline Start by_coordinate(const Left& l) {
    const glm::vec3 p = l.along_ray();
    return {p + (1.0f + largest(p)) * 1500.0f * 0x1p-24f * l.s.ng};
}
// Wächter & Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch. 6.
inline Start by_ulps(const Left& l) {
    Start s{l.from_weights};
    for (int i = 0; i < 3; ++i) {
        const float p = s.origin[i], n = l.s.ng[i];
        const auto steps = static_cast<std::int32_t>(256.0f * n);
        const float moved = std::bit_cast<float>(std::bit_cast<std::int32_t>(p) + (p < 0.0f ? -steps : steps));
        s.origin[i] = std::abs(p) < 1.0f / 32.0f ? p + n / 65536.0f : moved;
    }
    return s;
}
inline Start bounded(const Left& l) { return {spawn_origin(l.s, l.s.ng)}; }

}  // namespace rules

inline constexpr OffsetRule kOffsetRules[] = {
    {"none", "o + td, every hit counts", rules::none},
    {"fixed", "10<sup>&minus;4</sup> along n", rules::fixed},
    {"tnear", "hits below t = 10<sup>&minus;3</sup> passed over", rules::near_skipped},
    {"by_distance", "10<sup>&minus;4</sup> t along n", rules::by_distance},
    {"by_coordinate", "9&middot;10<sup>&minus;5</sup> (1 + max|p|) along n", rules::by_coordinate},
    {"by_ulps", "256 ulp along n (W&auml;chter &amp; Binder)", rules::by_ulps},
    {"glint", "glint: error bound", rules::bounded},
    {"glint_recentred", "glint, read from a file (recentred)", rules::bounded, true},
};

}  // namespace glint::numeric
