// The pinhole or thin-lens camera. Right-handed; pixel (0, 0) is the top left one.
// Knows no sampler: lens and pixel positions are handed in. Invariant: rays are independent of the scene's scale.
#pragma once

#include <cmath>

#include <glm/glm.hpp>

#include "accel/ray_batch.h"

namespace glint {

// Where the camera stands and how it sees; what files, options and the viewer exchange.
struct CameraPose {
    glm::vec3 eye{0.0f, 0.0f, 5.0f};
    glm::vec3 target{0.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    float view_angle = 45.0f;     // vertical field of view over the full height, degrees, in (0, 180)
    float lens_radius = 0.0f;     // scene units; 0 = pinhole
    float focus_distance = 0.0f;  // along the axis, scene units; 0 = at the target

    bool operator==(const CameraPose&) const = default;
    [[nodiscard]] float target_distance() const { return glm::length(target - eye); }
};

class Camera {
public:
    Camera() = default;
    // eye != target is the caller's duty; an `up` along the view is replaced by another axis.
    Camera(const CameraPose& pose, int width, int height);

    // The ray through image position (x, y) in pixels from the top left, y down; (0.5, 0.5) is the first pixel's centre.
    // lens: a point of the unit disk, (0, 0) for the lens centre. The direction has unit length.
    [[nodiscard]] Ray ray(float x, float y, glm::vec2 lens) const noexcept {
        // From the middle, so that the left half is the exact mirror image of the right one, whatever the size.
        const glm::vec3 d = (right_ * ((x - middle_x_) * inverse_width_) + up_ * ((middle_y_ - y) * inverse_height_)) - back_;
        Ray ray;
        ray.origin = eye_;
        ray.direction = d;
        if (has_lens()) {
            // d has length 1 along the axis, so d * focus_distance ends in the plane of focus (not on a sphere around the eye).
            const glm::vec3 offset = lens_u_ * lens.x + lens_v_ * lens.y;
            ray.origin = eye_ + offset;
            ray.direction = d * focus_distance_ - offset;
        }
        ray.direction /= std::sqrt(glm::dot(ray.direction, ray.direction));
        return ray;
    }
    // The same for n image positions through the lens centre. All arrays are read and written up to the next multiple of kRun.
    static constexpr std::size_t kRun = 8;
    void pinhole_rays(const float* x, const float* y, std::size_t n, RayBatch& rays) const noexcept;
    [[nodiscard]] glm::vec3 eye() const { return eye_; }
    [[nodiscard]] bool has_lens() const { return lens_radius_ > 0.0f; }

private:
    void directions(const float* x, const float* y, std::size_t n, RayBatch& rays) const noexcept;
    void directions_avx2(const float* x, const float* y, std::size_t n, RayBatch& rays) const noexcept;

    glm::vec3 eye_{0.0f}, right_{0.0f}, up_{0.0f}, back_{0.0f};  // right_, up_ scaled to the window at distance 1
    glm::vec3 lens_u_{0.0f}, lens_v_{0.0f};                      // lens axes, scaled by the lens radius
    float inverse_width_ = 1.0f, inverse_height_ = 1.0f, middle_x_ = 0.5f, middle_y_ = 0.5f;
    float lens_radius_ = 0.0f, focus_distance_ = 1.0f;
};

}  // namespace glint
