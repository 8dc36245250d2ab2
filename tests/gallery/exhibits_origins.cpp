// Where the next ray starts: a fixed distance off the surface, or as far as rounding can have misjudged it.

#include <map>

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/gallery/textbook.h"

namespace glint::gallery {
namespace {

// A gem on a floor. All coordinates are multiples of 1/64, so that moving it by whole numbers up to 10^5 is exact: the scene
// is the same everywhere.
std::shared_ptr<const Scene> gem(glm::vec3 shift, const CameraPose& pose) {
    SceneBuilder b;
    const std::uint32_t floor = b.add_material(matte({0.62f, 0.62f, 0.6f})), stone = b.add_material(matte({0.85f, 0.45f, 0.2f}));
    add_quad(b, shift + glm::vec3(-12, -2, -12), {0, 0, 24}, {24, 0, 0}, floor);
    // An icosahedron, each face split in four.
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;
    std::vector<glm::dvec3> corner{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    const int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                              {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                              {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    const auto vertex = [&](glm::dvec3 p) {
        return b.add_vertex(shift + glm::vec3(glm::round(glm::normalize(p) * 128.0) / 64.0));
    };
    for (const auto& f : faces) {
        const glm::dvec3 p = corner[static_cast<std::size_t>(f[0])], q = corner[static_cast<std::size_t>(f[1])],
                         r = corner[static_cast<std::size_t>(f[2])];
        const std::uint32_t i[6] = {vertex(p), vertex(q), vertex(r), vertex(p + q), vertex(q + r), vertex(r + p)};
        const int parts[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};
        for (const auto& t : parts) b.add_triangle(i[t[0]], i[t[1]], i[t[2]], stone);
    }
    return finish(b, pose);
}

struct Acne {
    Side side;
    double offset = 0.0;  // mean
};

// A shadow that a surface throws on itself is acne: the floor is flat, and the gem convex.
template <class Origin>
Acne draw(const Stage& stage, const CameraPose& pose, int width, Origin&& origin) {
    const glm::vec3 sun = glm::normalize(glm::vec3(4, 7, 3));
    Acne result;
    double hits = 0.0;
    result.side.picture = shown(paint(pose, width, width * 3 / 4, [&](const Ray& ray, int, int) {
        const Hit hit = stage.hit(ray);
        if (!hit.found()) return glm::vec3(0.75f, 0.83f, 0.92f);
        const SurfacePoint s = surface_point(*stage.scene, ray, hit);
        const glm::vec3 albedo = stage.scene->materials[s.material].diffuse;
        const float n_l = glm::dot(s.ng, sun);
        if (!(n_l > 0.0f)) return lit(albedo, 0.0f, false);
        const glm::vec3 start = origin(ray, hit, s);
        result.offset += glm::dot(glm::dvec3(start) - glm::dvec3(s.p), glm::dvec3(s.ng)), ++hits;
        const Hit shadow = stage.hit({start, sun, kInfinity});
        if (shadow.found() && stage.scene->material(shadow.primitive) == stage.scene->materials[s.material])
            ++result.side.defects;
        return lit(albedo, n_l, !shadow.found());
    }));
    result.offset /= hits;
    return result;
}

glm::vec3 fixed_origin(const Ray& ray, const Hit& hit, const SurfacePoint& s) {
    return ray.origin + hit.t * ray.direction + textbook::kEpsilon * s.ng;
}
glm::vec3 bounded_origin(const Ray&, const Hit&, const SurfacePoint& s) { return spawn_origin(s, s.ng); }

}  // namespace

Exhibit shadow_acne(int width) {
    Exhibit e{
        "S-OFF-01",
        "Shadow acne",
        "The same gem, carried away from the origin: the fixed offset of 0.0001 drowns in the rounding of the coordinates "
        "(0.00006 at 1000, 0.0078 at 100,000), so rays start below the surface they leave and meet it again.",
        "glint computes the point anew from the triangle itself, in double, and starts as far along the normal as a later "
        "intersection can misjudge it: 4 roundings of the coordinates and 8 of the triangle&rsquo;s reach.",
        "pixels that a surface shadows by itself",
        "p = o + t * d;\norigin = p + 0.0001 * n;",
        "p = (1-u-v)*A + u*B + v*C;            // in double\nerror = 2^-24 * (4 * max|p| + 8 * reach);\norigin = p + error * n;",
        {},
        {}};
    for (const float t : {0.0f, 1e3f, 1e5f}) {
        const glm::vec3 shift(t, -0.5f * t, 0.75f * t);
        const CameraPose pose = camera_at(shift + glm::vec3(4, 4, 8), shift + glm::vec3(0, -0.5f, 0), 38.0f);
        const Stage stage(gem(shift, pose));
        Acne left = draw(stage, pose, width, fixed_origin), right = draw(stage, pose, width, bounded_origin);
        const std::string where = fmt::format("Moved by {:.0f}", t);
        left.side.caption = where + "; offset 0.0001";
        right.side.caption = where + fmt::format("; mean offset {:.2g}", right.offset);
        e.pairs.push_back({fmt::format("acne-{:.0f}", t), std::move(left.side), std::move(right.side)});
    }
    return e;
}

}  // namespace glint::gallery
