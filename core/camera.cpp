#include "core/camera.h"

#include <cmath>
#include <numbers>

#include "accel/isa.h"

namespace glint {

Camera::Camera(const CameraPose& pose, int width, int height) {
    // Set up in double: float would bend the picture's axes by a part in 10^7, which shows at silhouettes.
    const glm::dvec3 eye(pose.eye);
    const glm::dvec3 view = eye - glm::dvec3(pose.target);
    const double distance = std::sqrt(glm::dot(view, view));
    const glm::dvec3 back = view / distance;
    glm::dvec3 right = glm::cross(glm::dvec3(pose.up), back);
    if (!(glm::dot(right, right) > 0.0)) {
        // `up` along the view: any axis will do, so take the one least along it.
        const glm::dvec3 a = glm::abs(back);
        const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                                : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                         : glm::dvec3(0, 0, 1);
        right = glm::cross(axis, back);
    }
    right /= std::sqrt(glm::dot(right, right));
    const glm::dvec3 up = glm::cross(back, right);
    const double half_height = std::tan(static_cast<double>(pose.view_angle) * std::numbers::pi / 360.0);
    const double height_at_one = 2.0 * half_height;
    const double width_at_one = height_at_one * width / height;
    eye_ = pose.eye;
    right_ = glm::vec3(right * width_at_one);
    up_ = glm::vec3(up * height_at_one);
    back_ = glm::vec3(back);
    lens_u_ = glm::vec3(right * static_cast<double>(pose.lens_radius));
    lens_v_ = glm::vec3(up * static_cast<double>(pose.lens_radius));
    inverse_width_ = 1.0f / static_cast<float>(width);
    inverse_height_ = 1.0f / static_cast<float>(height);
    lens_radius_ = pose.lens_radius;
    focus_distance_ = pose.focus_distance > 0.0f ? pose.focus_distance : static_cast<float>(distance);
}

// Plain loops over arrays, each step as in ray(): compilers make vector instructions of them, with the same bits.
[[gnu::always_inline]] inline void Camera::directions(const float* x, const float* y,
                                                      float (&direction)[3][kRunOfRays]) const noexcept {
    float d[3][kRunOfRays];
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < kRunOfRays; ++k) {
            d[i][k] = (right_[i] * (x[k] * inverse_width_ - 0.5f) + up_[i] * (0.5f - y[k] * inverse_height_)) - back_[i];
        }
    }
    float length[kRunOfRays];
    for (int k = 0; k < kRunOfRays; ++k) {
        length[k] = std::sqrt(d[0][k] * d[0][k] + d[1][k] * d[1][k] + d[2][k] * d[2][k]);
    }
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < kRunOfRays; ++k) direction[i][k] = d[i][k] / length[k];
    }
}

[[gnu::target("avx2")]] void Camera::directions_avx2(const float* x, const float* y,
                                                     float (&direction)[3][kRunOfRays]) const noexcept {
    directions(x, y, direction);
}

void Camera::pinhole_rays(const float* x, const float* y, float (&direction)[3][kRunOfRays]) const noexcept {
    if (isa_in_use() == Isa::baseline) return directions(x, y, direction);
    directions_avx2(x, y, direction);
}

}  // namespace glint
