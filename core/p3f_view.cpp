#include "core/p3f_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace glint::p3f {
namespace {

constexpr std::int64_t kLargestSide = 65535;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
constexpr double kDefaultAngle = 45.0;
constexpr glm::ivec2 kDefaultResolution(512, 512);  // of all but a few of the course's scenes

constexpr std::array<std::string_view, 12> kWords{"from",   "eye",        "at",       "up",    "upp",   "angle",
                                                  "hither", "resolution", "aperture", "focal", "time0", "time1"};

glm::dvec3 read_point(Lexer& in, std::string_view what) {
    const auto [x, y, z] = in.numbers<3>(what);
    return {x, y, z};
}

glm::ivec2 read_resolution(Lexer& in, const Messages& messages) {
    const std::int64_t width = in.integer("'resolution'");
    const std::int64_t height = in.integer("'resolution'");
    const bool usable = width > 0 && height > 0 && width <= kLargestSide && height <= kLargestSide;
    if (!usable || width * height > kMostPixels) {
        messages.fail(in.line(), fmt::format("resolution {} x {} is out of range: 1 to {} a side, at most 2^28 pixels", width,
                                             height, kLargestSide));
    }
    return {static_cast<int>(width), static_cast<int>(height)};
}

// Degrees to radians of half the angle.
double half_angle(double degrees) { return degrees * (3.14159265358979323846 / 360.0); }

// Looks at everything from the front, above and to the right.
CameraPose frame(const Geometry& geometry) {
    CameraPose pose;
    pose.view_angle = static_cast<float>(kDefaultAngle);
    const Aabb box = geometry.bounds();
    if (box.empty()) return pose;
    const double radius = 0.5 * glm::length(glm::dvec3(box.size()));
    if (!(radius > 0.0)) return pose;
    const double distance = radius / std::sin(half_angle(kDefaultAngle));
    const glm::dvec3 target(box.center());
    const glm::vec3 eye(target + glm::normalize(glm::dvec3(1.0, 1.0, 2.0)) * distance);
    if (!valid_vertex(eye)) return pose;
    pose.target = glm::vec3(target);
    pose.eye = eye;
    return pose;
}

void check_axes(const View& view, CameraPose& pose, Messages& messages) {
    // Tested as float: this is what the camera gets, and two near points may become one.
    if (!valid_vertex(pose.eye) || !valid_vertex(pose.target)) messages.fail(view.line, "the view lies too far out");
    if (pose.eye == pose.target) messages.fail(view.line, "the view has its eye at the point it looks at");
    const glm::dvec3 forward = glm::normalize(glm::dvec3(pose.target) - glm::dvec3(pose.eye));
    const glm::dvec3 up(pose.up);
    // Below this sine the direction to the right would be mostly rounding of the float coordinates.
    constexpr double kSmallestSine = 1.0e-6;
    if (glm::length(glm::cross(forward, up)) > kSmallestSine * glm::length(up)) return;
    messages.warn(view.line, "'up' runs along the view, another axis is used");
    const glm::dvec3 a = glm::abs(forward);
    pose.up = a.x <= a.y && a.x <= a.z ? glm::vec3(1, 0, 0) : a.y <= a.z ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
}

}  // namespace

bool is_view_word(std::string_view word) { return std::find(kWords.begin(), kWords.end(), word) != kWords.end(); }

void read_view_word(View& view, Lexer& in, const Messages& messages, const Token& keyword) {
    if (view.line == 0) view.line = keyword.line;
    const std::string_view word = keyword.text;
    const std::string what = in_quotes(word);
    if (word == "from" || word == "eye") {
        view.eye = read_point(in, what);
        view.renamed = view.renamed || word == "eye";
    } else if (word == "at") {
        view.target = read_point(in, what);
    } else if (word == "up" || word == "upp") {
        view.up = read_point(in, what);
    } else if (word == "angle") {
        view.angle = in.numbers<1>(what)[0];
        if (!(*view.angle > 0.0 && *view.angle < 180.0)) {
            messages.fail(in.line(), fmt::format("angle {} is out of range: above 0, below 180 degrees", *view.angle));
        }
    } else if (word == "resolution") {
        view.resolution = read_resolution(in, messages);
    } else if (word == "aperture") {
        view.aperture = in.numbers<1>(what)[0];
        if (view.aperture < 0.0) messages.fail(in.line(), fmt::format("aperture {} is negative", view.aperture));
    } else if (word == "focal") {
        view.focal = in.numbers<1>(what)[0];
    } else {
        // hither, time0, time1: no ray tracer of the course clips with the first, and nothing moves here.
        (void)in.numbers<1>(what);
    }
}

void finish_view(const View& view, bool aperture_is_diameter, SceneBuilder& builder, Messages& messages) {
    Scene& scene = builder.scene();
    const glm::ivec2 resolution = view.resolution.value_or(kDefaultResolution);
    if (view.line == 0) {
        // The scene's own default size stays: the file says nothing.
        messages.warn("no view: everything is framed");
        scene.cameras.push_back(frame(builder.geometry()));
        return;
    }
    if (!view.eye) messages.fail(view.line, "the view has no 'from'");
    if (!view.target) messages.fail(view.line, "the view has no 'at'");
    if (!view.up) messages.warn(view.line, "the view has no 'up', 0 1 0 is used");
    if (!view.angle) messages.warn(view.line, fmt::format("the view has no 'angle', {} is used", kDefaultAngle));
    if (!view.resolution) messages.warn(view.line, fmt::format("the view has no 'resolution', {0} {0} is used", resolution.x));

    CameraPose pose;
    pose.eye = scene.local(*view.eye);
    pose.target = scene.local(*view.target);
    pose.up = glm::vec3(view.up.value_or(glm::dvec3(0.0, 1.0, 0.0)));
    pose.view_angle = static_cast<float>(view.angle.value_or(kDefaultAngle));
    check_axes(view, pose, messages);
    if (!(pose.view_angle > 0.0f && pose.view_angle < 180.0f)) messages.fail(view.line, "the angle is out of range");
    if (view.aperture > 0.0) {
        if (!(view.focal > 0.0)) messages.fail(view.line, fmt::format("focal {} is not above 0", view.focal));
        // The lens is counted in pixels of the window that stands at the target.
        const double distance = glm::length(*view.target - *view.eye);
        const double window = 2.0 * distance * std::tan(half_angle(view.angle.value_or(kDefaultAngle)));
        const double size = view.aperture * window / resolution.y;
        pose.lens_radius = static_cast<float>(aperture_is_diameter ? 0.5 * size : size);
        pose.focus_distance = static_cast<float>(view.focal * distance);
        if (!valid_vertex({pose.lens_radius, pose.focus_distance, 0.0f})) messages.fail(view.line, "the lens is too large");
    }
    scene.cameras.push_back(pose);
    scene.width = resolution.x;
    scene.height = resolution.y;
}

}  // namespace glint::p3f
