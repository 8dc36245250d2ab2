#include "core/camera.h"

#include <algorithm>
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
    middle_x_ = 0.5f * static_cast<float>(width);
    middle_y_ = 0.5f * static_cast<float>(height);
    lens_radius_ = pose.lens_radius;
    focus_distance_ = pose.focus_distance > 0.0f ? pose.focus_distance : static_cast<float>(distance);
}

// A plain loop over arrays, each step as in ray(): compilers make vector instructions of it, with the same bits.
[[gnu::always_inline]] inline void Camera::directions(const float* x, const float* y, std::size_t n,
                                                      RayBatch& rays) const noexcept {
    for (std::size_t first = 0; first < n; first += kRun) {
#pragma GCC ivdep
        for (std::size_t k = first; k < first + kRun; ++k) {
            const glm::vec3 d =
                (right_ * ((x[k] - middle_x_) * inverse_width_) + up_ * ((middle_y_ - y[k]) * inverse_height_)) - back_;
            const float length = std::sqrt(glm::dot(d, d));
            rays.direction[0][k] = d.x / length;
            rays.direction[1][k] = d.y / length;
            rays.direction[2][k] = d.z / length;
        }
    }
}

[[gnu::target("avx2")]] void Camera::directions_avx2(const float* x, const float* y, std::size_t n,
                                                     RayBatch& rays) const noexcept {
    directions(x, y, n, rays);
}

void Camera::pinhole_rays(const float* x, const float* y, std::size_t n, RayBatch& rays) const noexcept {
    isa_in_use() == Isa::baseline ? directions(x, y, n, rays) : directions_avx2(x, y, n, rays);
    for (int axis = 0; axis < 3; ++axis) std::fill_n(rays.origin[axis], n, eye_[axis]);
    std::fill_n(rays.t_max, n, kInfinity);
    rays.count = static_cast<int>(n);
}

}  // namespace glint
