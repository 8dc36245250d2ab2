// Where light ends on a mesh with interpolated normals.

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

// A ball of `columns` x `rows` with the ball's own normals at its corners.
std::shared_ptr<const Scene> smooth_ball(const CameraPose& pose, int columns, int rows, const Light& light) {
    SceneBuilder b;
    const std::uint32_t skin = b.add_material(matte(glm::vec3(0.8f, 0.72f, 0.6f)));
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const double phi = 2.0 * kPi * i / columns, theta = kPi * j / rows;
            const glm::vec3 p(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            b.add_vertex(p, p);
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * columns + i % columns); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            if (j > 0) b.add_triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1), skin);
            if (j + 1 < rows) b.add_triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1), skin);
        }
    }
    b.scene().lights = {light};
    return finish(b, pose);
}

}  // namespace

Exhibit terminator(int width) {
    Exhibit e{"S-TRM-01",
              "The staircase at the terminator",
              "A ball of 16 by 8 facets with interpolated normals: the light should fade where the <i>round</i> ball turns away, "
              "but a facet lies "
              "below the ball, so its own plane cuts the light off, facet by facet.",
              "glint draws the same staircase: here it has no answer yet. A cure is known (Hanika 2021, &ldquo;Hacking the "
              "Shadow Terminator&rdquo;): start the "
              "shadow ray where the corners&rsquo; tangent planes put the point, and let the interpolated normal alone say where "
              "light ends.",
              "pixels whose normal faces the lamp by more than a hundredth, without any light",
              "if (dot(ng, l) <= 0 || dot(ns, l) <= 0) dark;\norigin = p + epsilon * ng;",
              "if (dot(ng, l) <= 0 || dot(ns, l) <= 0) dark;\norigin = p + error * ng;                 // the same",
              {},
              {}};
    e.open = true;
    const CameraPose pose = camera_at({0, 0.6f, 5.0f}, {0, 0, 0}, 28.0f);
    Light lamp;
    lamp.position = {-6, 3.0f, -0.6f};
    const Stage stage(smooth_ball(pose, 16, 8, lamp));
    const int height = width * 3 / 4;
    const Image ours = rendered(stage, pose, width, height, 1, centred());
    const auto draw = [&](bool is_ours, const char* caption) {
        Side side;
        const Image image = paint(pose, width, height, [&](const Ray& ray, int x, int y) {
            const Hit hit = stage.hit(ray);
            if (!hit.found()) return glm::vec3(0.05f, 0.06f, 0.08f);
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const glm::vec3 origin = spawn_origin(s, s.ng), wi = glm::normalize(lamp.position - s.p);
            const float n_l = glm::dot(s.ns, wi);
            const bool seen = glm::dot(s.ng, wi) > 0.0f && !occluded(*stage.accelerator, {origin, lamp.position - origin, 1.0f});
            const glm::vec3 albedo = stage.scene->materials[s.material].diffuse;
            const glm::vec3 light = is_ours ? ours.at(x, y) : seen ? albedo * std::max(0.0f, n_l) : glm::vec3(0.0f);
            side.defects += n_l > 0.01f && !(light.x > 0.0f) ? 1.0 : 0.0;
            return light + albedo * 0.03f;
        });
        side.picture = shown(image, 1.0f);
        side.caption = caption;
        return side;
    };
    e.pairs.push_back({"terminator", draw(false, "The facet&rsquo;s plane decides"), draw(true, "As rendered today")});
    return e;
}

}  // namespace glint::gallery
