// At which end of their way shadow rays start, light by light: at the light where that is safe, else at the surface.
// Knows no samples. Invariant: the answer depends on geometry and lights alone, so it is the same for every accelerator.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "accel/accelerator.h"
#include "core/light.h"

namespace glint {

class ShadowOrigins {
public:
    // Decides for all lights of a frame. Three rays a light; the geometry is measured once.
    template <Accelerator A>
    void decide(const std::shared_ptr<const Geometry>& geometry, const std::vector<Light>& lights, const A& accelerator) {
        if (measured_.lock() != geometry) {
            measured_ = geometry;
            magnitude_ = geometry->bounds().magnitude();
        }
        at_light_.clear();
        for (const Light& light : lights) {
            at_light_.push_back(light.is_true_point() && near(light) && !touched(light, accelerator) ? 1 : 0);
        }
    }
    [[nodiscard]] bool at_light(std::size_t light) const { return at_light_[light] != 0; }

private:
    // The end of a ray is known to some 2^-24 of its length. From far away that would let light through sheets that lie on
    // each other: at this ratio through gaps of 2^-24 * 14 * 128, about a ten-thousandth of the scene.
    static constexpr float kNear = 128.0f;
    [[nodiscard]] bool near(const Light& light) const { return largest(light.position) <= kNear * magnitude_; }

    // Whether a surface passes through the light, or so close that rounding decides on which side of it a ray starts. What
    // touches a light shadows it, which only rays that end past the light can tell. No plane is parallel to all three axes.
    template <Accelerator A>
    [[nodiscard]] bool touched(const Light& light, const A& accelerator) const {
        const float reach = 0x1p-18f * (magnitude_ + largest(light.position));
        for (int i = 0; i < 3; ++i) {
            Ray ray{light.position, glm::vec3(0.0f), 1.0f};
            ray.origin[i] -= reach;
            ray.direction[i] = 2.0f * reach;
            if (accelerator.occluded(ray)) return true;
        }
        return false;
    }

    static float largest(glm::vec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

    std::vector<char> at_light_;
    std::weak_ptr<const Geometry> measured_;
    float magnitude_ = 0.0f;  // of the measured geometry without planes; 0 = there is none, and no light is near
};

}  // namespace glint
