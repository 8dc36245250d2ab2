// What a surface does to light: plain linear numbers, as the integrator in radiance.h uses them.
// Knows no file format; readers convert. Invariant: every number finite and >= 0.
#pragma once

#include <glm/glm.hpp>

namespace glint {

struct Material {
    glm::vec3 diffuse{0.2f * 0.2f};  // albedo; reflected light is light * diffuse * n.l (no 1/pi)
    glm::vec3 specular{0.8f};        // strength of the Blinn-Phong highlight
    float shininess = 20.0f;         // Blinn-Phong exponent
    // Multiplies the highlight; 1 for P3F's raw highlight, (s+8)/8-like factors where a reader wants energy kept.
    float highlight_scale = 1.0f;
    glm::vec3 mirror{0.0f};         // weight of the mirror branch at normal incidence; black = no mirror
    bool mirror_fresnel = false;    // weight rises as mirror + (1 - mirror)(1 - cos)^5 (Schlick 1994), glTF metals and plastics
    float roughness = 0.0f;         // fuzz radius added to the unit reflected direction
    bool glass = false;             // both Fresnel branches are followed; `mirror` is then ignored
    float ior = 1.0f;               // index of refraction, used only by glass; 0 in a file is never divided by
    glm::vec3 transmittance{1.0f};  // tint of each refracted branch
    glm::vec3 emission{0.0f};       // radiance of the surface itself

    bool operator==(const Material&) const = default;
    [[nodiscard]] bool has_mirror() const { return !glass && (mirror.x > 0.0f || mirror.y > 0.0f || mirror.z > 0.0f); }
    [[nodiscard]] bool has_highlight() const { return specular.x > 0.0f || specular.y > 0.0f || specular.z > 0.0f; }
    [[nodiscard]] bool has_diffuse() const { return diffuse.x > 0.0f || diffuse.y > 0.0f || diffuse.z > 0.0f; }
};

}  // namespace glint
