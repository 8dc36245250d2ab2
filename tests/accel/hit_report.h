// Hits compared by their bits, rays and hits in words that replay a failure exactly (hexadecimal floats).
#pragma once

#include <bit>
#include <cstdio>
#include <string>

#include "accel/ray.h"

namespace glint {

inline std::string text(glm::vec3 v) {
    char buffer[128];
    std::snprintf(buffer, sizeof buffer, "(%a, %a, %a)", static_cast<double>(v.x), static_cast<double>(v.y),
                  static_cast<double>(v.z));
    return buffer;
}
inline std::string text(const Hit& h) {
    char buffer[128];
    std::snprintf(buffer, sizeof buffer, "id %08x t %a u %a v %a", h.primitive, static_cast<double>(h.t),
                  static_cast<double>(h.u), static_cast<double>(h.v));
    return h.found() ? buffer : "miss";
}
inline std::string text(const Ray& r) {
    return text(r.origin) + " -> " + text(r.direction) + " t_max " + text(glm::vec3(r.t_max));
}

inline bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }
inline bool same(const Hit& a, const Hit& b) {
    return a.primitive == b.primitive && (!a.found() || (same_bits(a.t, b.t) && same_bits(a.u, b.u) && same_bits(a.v, b.v)));
}

}  // namespace glint
