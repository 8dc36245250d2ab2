#include "core/gltf_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/seen_vertices.h"

namespace glint {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

double length(glm::dvec3 v) { return std::sqrt(glm::dot(v, v)); }

// How far along the view the scene's centre lies: what focus and orbiting refer to.
double target_distance(glm::dvec3 eye, glm::dvec3 forward, const Aabb& bounds) {
    double distance = 1.0;
    if (!bounds.empty()) {
        const glm::dvec3 center(bounds.center());
        const double radius = 0.5 * length(glm::dvec3(bounds.hi) - glm::dvec3(bounds.lo));
        distance = glm::dot(center - eye, forward);
        // A camera inside the scene or turned away from its middle still needs a target before it.
        if (!(distance > radius / 8.0)) distance = std::max(length(center - eye), radius);
        if (!(distance > 0.0)) distance = 1.0;
    }
    // Far from the origin a near target would round to the eye itself.
    return std::max(distance, length(eye) * 0x1p-16);
}

}  // namespace

std::optional<CameraPose> gltf_camera(const tinygltf::Camera& camera, const glm::dmat4& world_from_camera, const Aabb& bounds,
                                      GltfReport& report) {
    // A camera looks along its own -z with +y up (glTF 2.0, section 3.10); the scale of its node means nothing.
    const glm::dvec3 eye(world_from_camera[3]);
    const glm::dvec3 z(world_from_camera[2]), y(world_from_camera[1]);
    const double z_length = length(z), y_length = length(y);
    const bool usable = z_length > 0.0 && std::isfinite(z_length) && y_length > 0.0 && std::isfinite(y_length);
    if (!usable || !valid_vertex(glm::vec3(eye))) {
        report.warn("a camera whose node has no usable matrix is left out");
        return std::nullopt;
    }
    const glm::dvec3 forward = -z / z_length;
    const double distance = target_distance(eye, forward, bounds);

    CameraPose pose;
    pose.eye = glm::vec3(eye);
    pose.target = glm::vec3(eye + distance * forward);
    pose.up = glm::vec3(y / y_length);
    double angle = camera.perspective.yfov * kDegrees;
    if (camera.type == "orthographic") {
        report.warn("orthographic cameras become perspective ones that see about the same");
        angle = 2.0 * std::atan(std::abs(camera.orthographic.ymag) / distance) * kDegrees;
    }
    if (!(angle > 0.01 && angle < 179.0)) {
        report.warn("a camera without a usable field of view gets 45 degrees");
        angle = 45.0;
    }
    pose.view_angle = static_cast<float>(angle);
    return pose;
}

CameraPose framing_camera(const Geometry& geometry, const Aabb& bounds) {
    CameraPose pose;
    if (bounds.empty()) return pose;
    // Models face +z (glTF 2.0, section 3.4), so the viewer stands there, a little to the right and above.
    constexpr double kAzimuth = 30.0 / kDegrees, kElevation = 18.0 / kDegrees, kMargin = 1.08;
    const glm::dvec3 back(std::sin(kAzimuth) * std::cos(kElevation), std::sin(kElevation),
                          std::cos(kAzimuth) * std::cos(kElevation));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), back));
    const glm::dvec3 up = glm::cross(back, right);
    const double half_height = std::tan(0.5 * static_cast<double>(pose.view_angle) / kDegrees);
    const double half_width = half_height * 4.0 / 3.0;
    const glm::dvec3 center = 0.5 * (glm::dvec3(bounds.lo) + glm::dvec3(bounds.hi));
    double distance = 0.0;
    for_each_seen_vertex(geometry, [&](glm::vec3 v) {
        const glm::dvec3 p = glm::dvec3(v) - center;
        const double across = std::max(std::abs(glm::dot(p, right)) / half_width, std::abs(glm::dot(p, up)) / half_height);
        distance = std::max(distance, kMargin * across + glm::dot(p, back));
    });
    pose.target = glm::vec3(center);
    pose.eye = glm::vec3(center + back * std::max(distance, length(center) * 0x1p-16));
    return pose;
}

}  // namespace glint
