// Where light ends on a mesh with interpolated normals.

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/smooth_mesh.h"

namespace glint::gallery {
namespace {

constexpr glm::vec3 kSkin(0.8f, 0.72f, 0.6f);
// The cosine from which on light must show. Below it facets of a saddle that stand out of the round body may shadow a point.
constexpr float kClear = 0.05f;

std::shared_ptr<const Scene> round_mesh(const RoundBody& body, int columns, int rows, const CameraPose& pose,
                                        const Light& light) {
    SceneBuilder b;
    add_round_mesh(b, body, columns, rows, b.add_material(matte(kSkin)));
    b.scene().lights = {light};
    return finish(b, pose);
}

// The facet's plane decides where light ends, and the shadow ray starts on the facet.
glm::vec3 lit_by_facets(const Stage& stage, const SurfacePoint& s, glm::vec3 lamp) {
    const glm::vec3 origin = spawn_origin(s, s.ng), wi = glm::normalize(lamp - s.p);
    const float n_l = glm::dot(s.ns, wi);
    if (!(glm::dot(s.ng, wi) > 0.0f) || !(n_l > 0.0f)) return glm::vec3(0.0f);
    return occluded(*stage.accelerator, {origin, lamp - origin, 1.0f}) ? glm::vec3(0.0f) : kSkin * n_l;
}

Pair pair_of(const char* name, const RoundBody& body, int columns, int rows, const CameraPose& pose, int width) {
    Light lamp;
    lamp.position = {-6, 3.0f, -0.6f};
    const Stage stage(round_mesh(body, columns, rows, pose, lamp));
    const int height = width * 3 / 4;
    const Image rendered_by_glint = rendered(stage, pose, width, height, 1, centred());
    const auto draw = [&](bool ours) {
        Side side;
        side.picture = shown(
            paint(pose, width, height,
                  [&](const Ray& ray, int x, int y) {
                      const Hit hit = stage.hit(ray);
                      if (!hit.found()) return glm::vec3(0.05f, 0.06f, 0.08f);
                      const SurfacePoint s = surface_point(*stage.scene, ray, hit);
                      const glm::vec3 light = ours ? rendered_by_glint.at(x, y) : lit_by_facets(stage, s, lamp.position);
                      // Where even the interpolated normal has turned away, nothing could be lit.
                      const bool turned = !(glm::dot(s.ns, glm::normalize(lamp.position - s.p)) > kClear);
                      const bool lit = !turned && body.sees(body.nearest(glm::dvec3(s.p)), glm::dvec3(lamp.position), kClear);
                      side.defects += lit && !(light.x > 0.0f) ? 1.0 : 0.0;
                      return light + kSkin * 0.03f;
                  }),
            1.0f);
        side.caption = ours ? "The rounded surface decides" : "The facet&rsquo;s plane decides";
        return side;
    };
    return {name, draw(false), draw(true)};
}

}  // namespace

Exhibit terminator(int width) {
    Exhibit e{
        "S-TRM-01",
        "The staircase at the terminator",
        "A ball of 16 by 8 facets and a ring of 24 by 12, with interpolated normals: light should fade where the <i>round</i> "
        "body turns away, but a facet lies below it, so its own plane cuts the light off, facet by facet.",
        "Where light comes lower over a facet than its corners&rsquo; normals lean, glint starts the shadow ray where the "
        "corners&rsquo; tangent planes put the point (Hanika 2021, &ldquo;Hacking the Shadow Terminator&rdquo;), and lets "
        "the interpolated normal say where light ends; a short ray up to that point keeps light out of closed bodies.",
        "black pixels where the round body sees the lamp, 3&deg; or more above its horizon",
        "if (dot(ng, l) <= 0 || dot(ns, l) <= 0) dark;\norigin = p + epsilon * ng;",
        "if (dot(ns, l) <= 0) dark;\nif (dot(ng, l) <= sin(bend)) p += lift;        // and p must see p + lift\norigin = p + "
        "error * ng;\n\n// tangent planes of corners v[i] with normals n[i]:\nlift = -sum(w[i] * min(0, dot(p - v[i], n[i])) "
        "* n[i]);",
        {},
        {}};
    e.pairs.push_back(pair_of("terminator", {0.0, 1.0}, 16, 8, camera_at({0, 0.6f, 5.0f}, {0, 0, 0}, 28.0f), width));
    e.pairs.push_back(pair_of("terminator-ring", {1.0, 0.45}, 24, 12, camera_at({0, 2.6f, 4.0f}, {0, 0, 0}, 34.0f), width));
    return e;
}

}  // namespace glint::gallery
