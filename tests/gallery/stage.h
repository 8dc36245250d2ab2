// What exhibits share: pictures from a function of the pixel, pictures by the product's renderer, and a scene in which
// both sides look for hits.
// Knows no exhibit. Invariant: both sides of a pair use one camera, one scene, one shading.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/accelerator_cache.h"
#include "core/image.h"
#include "core/renderer.h"
#include "core/surface_point.h"
#include "tests/materials.h"

namespace glint::gallery {

constexpr double kPi = 3.14159265358979323846;

inline CameraPose camera_at(glm::vec3 eye, glm::vec3 target, float view_angle, glm::vec3 up = {0, 1, 0}) {
    CameraPose c;
    c.eye = eye;
    c.target = target;
    c.up = up;
    c.view_angle = view_angle;
    return c;
}

// pixel(ray, x, y) gives the radiance along the ray through the middle of pixel (x, y).
template <class Pixel>
Image paint(const CameraPose& pose, int width, int height, Pixel&& pixel) {
    const Camera camera(pose, width, height);
    Image image{width, height, std::vector<glm::vec3>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            image.at(x, y) = pixel(camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, glm::vec2(0.0f)), x, y);
        }
    }
    return image;
}

inline Image8 shown(const Image& image, float exposure_ev = 0.0f) { return to_display(image, {exposure_ev, Transfer::srgb}); }

// Copies `part` into `whole` at column x0.
inline void put(const Image& part, int x0, Image& whole) {
    for (int y = 0; y < part.height; ++y) {
        for (int x = 0; x < part.width; ++x) whole.at(x0 + x, y) = part.at(x, y);
    }
}

// A scene with its accelerator.
struct Stage {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AnyAccelerator> accelerator;

    explicit Stage(std::shared_ptr<const Scene> s, AcceleratorKind kind = AcceleratorKind::bvh)
        : scene(std::move(s)), accelerator(build_accelerator(kind, scene->geometry)) {}
    [[nodiscard]] Hit hit(const Ray& ray) const { return closest_hit(*accelerator, ray); }
};

// The product's picture of a scene: `glint render`.
inline Image rendered(const Stage& stage, const CameraPose& pose, int width, int height, int spp,
                      const RenderSettings& settings) {
    Frame frame;
    frame.scene = stage.scene;
    frame.accelerator = stage.accelerator;
    frame.camera = pose;
    frame.settings = settings;
    frame.width = width;
    frame.height = height;
    frame.spp = spp;
    Renderer renderer(2, false);
    renderer.restart(std::move(frame));
    renderer.wait(1e9, nullptr);
    Image image;
    renderer.resolve(image);
    return image;
}

// One centred ray a pixel.
inline RenderSettings centred() {
    RenderSettings s;
    s.features = FeatureSet::whitted();
    return s;
}

using test::black;
using test::emitter;
using test::glass;
using test::matte;

inline void add_quad(SceneBuilder& b, glm::vec3 corner, glm::vec3 edge_a, glm::vec3 edge_b, std::uint32_t material) {
    const std::uint32_t i = b.add_vertex(corner);
    b.add_vertex(corner + edge_a);
    b.add_vertex(corner + edge_a + edge_b);
    b.add_vertex(corner + edge_b);
    b.add_triangle(i, i + 1, i + 2, material);
    b.add_triangle(i, i + 2, i + 3, material);
}

inline std::shared_ptr<const Scene> finish(SceneBuilder& b, const CameraPose& pose) {
    b.scene().cameras = {pose};
    return b.finish();
}

// Diffuse light from one direction, and a little from everywhere.
inline glm::vec3 lit(glm::vec3 albedo, float n_l, bool seen) {
    return albedo * (0.12f + (seen ? 0.88f * std::max(0.0f, n_l) : 0.0f));
}

// Numbers as a caption prints them: 1,234,567.
inline std::string grouped(double count) {
    const std::string digits = fmt::format("{:.0f}", count);
    std::string s;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) s += ',';
        s += digits[i];
    }
    return s;
}

}  // namespace glint::gallery
