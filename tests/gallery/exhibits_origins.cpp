// Where the next ray starts: a fixed distance off the surface, or as far as rounding can have misjudged it.

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

// Starts at o + td, wherever that was rounded to, and passes over what is nearer than the epsilon.
Hit fixed_shadow(const Stage& stage, const Ray& ray, const Hit& hit, const SurfacePoint&, glm::vec3 towards) {
    const Geometry& g = *stage.scene->geometry;
    const PreparedRay prepared({ray.origin + hit.t * ray.direction, towards, kInfinity}, g.bounds().magnitude());
    Hit best;
    const auto meet = [&](PrimitiveId id) {
        Hit h;
        intersect(prepared, g, id, h);
        if (h.found() && h.t >= textbook::kEpsilon && h.t < best.t) best = h;
    };
    for (const PrimitiveId id : g.bounded_ids()) meet(id);
    for (std::uint32_t i = 0; i < g.planes.size(); ++i) meet(make_id(PrimitiveKind::plane, i));
    return best;
}

// Starts at the error bound.
Hit bounded_shadow(const Stage& stage, const Ray&, const Hit&, const SurfacePoint& s, glm::vec3 towards) {
    return stage.hit({spawn_origin(s, s.ng), towards, kInfinity});
}

using Shadow = Hit (*)(const Stage&, const Ray&, const Hit&, const SurfacePoint&, glm::vec3);

struct Acne {
    Side side;
    double error = 0.0;  // mean of the bounds
};

// A shadow that a surface throws on itself is acne: the floor is flat, and the gem convex.
Acne draw(const Stage& stage, const CameraPose& pose, int width, Shadow shadow_of) {
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
        result.error += static_cast<double>(s.error), ++hits;
        const Hit shadow = shadow_of(stage, ray, hit, s, sun);
        if (shadow.found() && stage.scene->material(shadow.primitive) == stage.scene->materials[s.material])
            ++result.side.defects;
        return lit(albedo, n_l, !shadow.found());
    }));
    result.error /= hits;
    return result;
}

}  // namespace

Exhibit shadow_acne(int width) {
    Exhibit e{
        "S-OFF-01",
        "Shadow acne",
        "The same gem, carried away from the origin: the fixed threshold of 0.0001 drowns in the rounding of the coordinates "
        "(0.00006 at 1000, 0.0078 at 100,000), so rays start below the surface they leave and meet it again.",
        "glint computes the point anew from the triangle itself, in double, and starts as far along the normal as a later "
        "intersection can misjudge it: 4 roundings of the coordinates and 8 of the triangle&rsquo;s reach.",
        "pixels that a surface shadows by itself",
        "origin = o + t * d;\nif (t_shadow < 0.0001) not a hit;",
        "p = (1-u-v)*A + u*B + v*C;            // in double\nerror = 2^-24 * (4 * max|p| + 8 * reach);\norigin = p + error * n;",
        {},
        {}};
    for (const float t : {0.0f, 1e3f, 1e5f}) {
        const glm::vec3 shift(t, -0.5f * t, 0.75f * t);
        const CameraPose pose = camera_at(shift + glm::vec3(4, 4, 8), shift + glm::vec3(0, -0.5f, 0), 38.0f);
        const Stage stage(gem(shift, pose));
        Acne left = draw(stage, pose, width, fixed_shadow), right = draw(stage, pose, width, bounded_shadow);
        const std::string where = fmt::format("Moved by {:.0f}", t);
        left.side.caption = where + "; hits nearer than 0.0001 ignored";
        right.side.caption = where + fmt::format("; mean offset {:.2g}", right.error);
        e.pairs.push_back({fmt::format("acne-{:.0f}", t), std::move(left.side), std::move(right.side)});
    }
    return e;
}

Exhibit horizon_acne(int width) {
    Exhibit e{"S-PLN-02",
              "Acne towards the horizon",
              "One infinite plane, 1000 units below the eye, no other object, a ring for each doubling of the distance: at "
              "<i>o</i>&nbsp;+&nbsp;<i>td</i> the "
              "error of the point grows with <i>t</i>, and from some thousands of units on it exceeds the fixed threshold.",
              "glint moves the point back onto the plane in double, "
              "<i>p</i>&nbsp;&minus;&nbsp;<i>n</i>(<i>n&middot;p</i>&nbsp;+&nbsp;<i>c</i>), "
              "and lets the offset grow with the coordinates.",
              "plane pixels in a shadow, though nothing throws one",
              "origin = o + t * d;\nif (t_shadow < 0.0001) not a hit;",
              "p = p - n * (dot(n, p) + c);          // in double\norigin = p + 2^-24 * 4 * max|p| * n;",
              {},
              {}};
    SceneBuilder b;
    const glm::dvec3 n = glm::normalize(glm::dvec3(0.21, 1.0, 0.13));
    b.add(Plane{n, 0.0}, b.add_material(matte(glm::vec3(0.7f))));
    const glm::dvec3 ahead = glm::normalize(glm::cross(glm::dvec3(1, 0.1, 0), n)), eye = 1000.0 * n;
    const CameraPose pose = camera_at(glm::vec3(eye), glm::vec3(eye - 0.13 * n + ahead), 22.0f, glm::vec3(n));
    const Stage stage(finish(b, pose));
    const glm::vec3 sun = glm::normalize(glm::vec3(n + 0.6 * ahead));
    const auto picture = [&](Shadow shadow_of) {
        Side side;
        side.picture = shown(paint(pose, width, width * 3 / 4, [&](const Ray& ray, int, int) {
            const Hit hit = stage.hit(ray);
            if (!hit.found()) return glm::vec3(0.75f, 0.83f, 0.92f);
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const bool seen = !shadow_of(stage, ray, hit, s, sun).found();
            side.defects += seen ? 0.0 : 1.0;
            const bool odd = static_cast<int>(std::floor(std::log2(hit.t))) % 2 != 0;
            return lit(odd ? glm::vec3(0.35f, 0.5f, 0.42f) : glm::vec3(0.66f, 0.66f, 0.6f), glm::dot(s.ng, sun), seen);
        }));
        return side;
    };
    e.pairs.push_back({"horizon", picture(fixed_shadow), picture(bounded_shadow)});
    e.pairs[0].textbook.caption = "Hits nearer than 0.0001 ignored";
    e.pairs[0].ours.caption = "Starts at the error bound";
    return e;
}

}  // namespace glint::gallery
