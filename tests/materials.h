// Materials that start from nothing at all, so that each shows only what its name says.
#pragma once

#include "core/material.h"

namespace glint::test {

inline Material black() {
    Material m;
    m.diffuse = m.specular = glm::vec3(0.0f);
    return m;
}
inline Material matte(glm::vec3 albedo) {
    Material m = black();
    m.diffuse = albedo;
    return m;
}
inline Material matte(float albedo) { return matte(glm::vec3(albedo)); }
inline Material glass(float ior, float transmittance = 1.0f) {
    Material m = black();
    m.glass = true;
    m.ior = ior;
    m.transmittance = glm::vec3(transmittance);
    return m;
}
inline Material emitter(glm::vec3 radiance) {
    Material m = black();
    m.emission = radiance;
    return m;
}

}  // namespace glint::test
