// The flying camera: a loaded CameraPose turned into position, yaw, pitch and roll about the scene's up axis, and back.
// Knows no window, keys or clock: times come in seconds, angles in radians, distances in scene units.
// Invariant: until it is moved, pose() is the loaded pose to the bit; roll never changes, so a tilted camera stays tilted.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

#include "core/camera.h"

namespace glint {

// The coordinate axis nearest to `up`: scenes are built along an axis, while a camera's own up may lean.
[[nodiscard]] inline glm::vec3 nearest_axis(glm::vec3 up) {
    const glm::vec3 size = glm::abs(up);
    if (size.y >= size.x && size.y >= size.z) return {0.0f, up.y < 0.0f ? -1.0f : 1.0f, 0.0f};
    if (size.z >= size.x) return {0.0f, 0.0f, up.z < 0.0f ? -1.0f : 1.0f};
    return {up.x < 0.0f ? -1.0f : 1.0f, 0.0f, 0.0f};
}

class FlyCamera {
public:
    // world_up: unit length.
    FlyCamera(const CameraPose& loaded, glm::vec3 world_up)
        : loaded_(loaded), pose_(loaded), world_up_(world_up), distance_(loaded.target_distance()) {
        // Any two axes that complete world_up to a right-handed frame.
        const glm::dvec3 aside = std::abs(world_up_.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        axis1_ = glm::normalize(aside - glm::dot(aside, world_up_) * world_up_);
        axis2_ = glm::cross(world_up_, axis1_);
        go_home();
    }

    [[nodiscard]] const CameraPose& pose() const { return pose_; }

    void go_home() {
        pose_ = loaded_;
        eye_ = loaded_.eye;
        const glm::dvec3 view = (glm::dvec3(loaded_.target) - eye_) / distance_;
        const double height = std::clamp(glm::dot(view, world_up_), -1.0, 1.0);
        pitch_ = std::asin(height);
        // Looking straight up or down there is no heading in the view; the picture's top (or bottom) tells it.
        const glm::dvec3 level = std::abs(height) < 0.9999999 ? view : glm::dvec3(loaded_.up) * (height < 0.0 ? 1.0 : -1.0);
        yaw_ = std::atan2(glm::dot(level, axis2_), glm::dot(level, axis1_));
        roll_ = 0.0;
        const glm::dvec3 up = loaded_.up;
        const double across = glm::dot(up, right()), along = glm::dot(up, unrolled_up());
        if (across != 0.0 || along != 0.0) roll_ = std::atan2(across, along);
    }

    // Turns to the right and upwards. Never over the poles, where left and right would change places.
    void look(double right, double up) {
        if (right == 0.0 && up == 0.0) return;
        constexpr double kSteepest = 0.495 * std::numbers::pi;
        yaw_ = std::remainder(yaw_ - right, 2.0 * std::numbers::pi);
        pitch_ = std::clamp(pitch_ + up, -kSteepest, kSteepest);
        update();
    }

    // Flies for `seconds` along the signs given: right of the view, up of the scene, forward along the view.
    void move(double right_sign, double up_sign, double forward_sign, double seconds, double factor) {
        if (right_sign == 0.0 && up_sign == 0.0 && forward_sign == 0.0) return;
        const glm::dvec3 direction = right_sign * right() + up_sign * world_up_ + forward_sign * forward();
        eye_ += direction * (speed() * factor * seconds);
        update();
    }

    // Scene units a second. At the start half the way to the target.
    [[nodiscard]] double speed() const { return 0.5 * distance_ * speed_factor_; }
    void change_speed(double factor) { speed_factor_ = std::clamp(speed_factor_ * factor, 1.0 / 4096.0, 4096.0); }

    [[nodiscard]] glm::dvec3 forward() const {
        return std::cos(pitch_) * (std::cos(yaw_) * axis1_ + std::sin(yaw_) * axis2_) + std::sin(pitch_) * world_up_;
    }
    [[nodiscard]] glm::dvec3 right() const { return std::sin(yaw_) * axis1_ - std::cos(yaw_) * axis2_; }

private:
    // The picture's up of a camera without roll.
    [[nodiscard]] glm::dvec3 unrolled_up() const { return glm::cross(right(), forward()); }

    void update() {
        // As for scenes: beyond this the square of a length overflows a float.
        constexpr double kFarthest = 1e18;
        eye_ = glm::clamp(eye_, -kFarthest, kFarthest);
        pose_.eye = eye_;
        pose_.target = eye_ + forward() * distance_;
        pose_.up = std::cos(roll_) * unrolled_up() + std::sin(roll_) * right();
        // Far from the origin a float cannot tell target from eye: the last step that it could show stays.
        if (pose_.target == pose_.eye) pose_.target = pose_.eye + glm::vec3(forward() * static_cast<double>(spacing()));
    }
    // A distance that survives rounding at the eye's place.
    [[nodiscard]] float spacing() const {
        return 1024.0f * std::max({std::abs(pose_.eye.x), std::abs(pose_.eye.y), std::abs(pose_.eye.z)}) * 0x1p-23f;
    }

    CameraPose loaded_, pose_;
    glm::dvec3 world_up_, axis1_{0.0}, axis2_{0.0};
    glm::dvec3 eye_{0.0};
    double distance_;  // eye to target
    double yaw_ = 0.0, pitch_ = 0.0, roll_ = 0.0;
    double speed_factor_ = 1.0;
};

}  // namespace glint
