// Triangles: rays through shared edges, triangles too small for a threshold, and triangles without area.

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"
#include "tests/gallery/textbook.h"

namespace glint::gallery {
namespace {

const glm::vec3 kBright(1.0f, 0.98f, 0.9f);

struct Corners {
    glm::vec3 a, b, c;
};
Corners corners(const Geometry& g, std::uint32_t i) {
    return {g.vertices[g.triangles[i][0]], g.vertices[g.triangles[i][1]], g.vertices[g.triangles[i][2]]};
}

// The nearest triangle by `distance(o, d, a, b, c)`, which is 0 for a miss.
template <class Distance>
PrimitiveId nearest(const Geometry& g, const Ray& ray, Distance&& distance) {
    float best = kInfinity;
    PrimitiveId id = kNoPrimitive;
    for (std::uint32_t i = 0; i < g.triangles.size(); ++i) {
        const Corners k = corners(g, i);
        const float t = distance(ray.origin, ray.direction, k.a, k.b, k.c);
        if (t > 0.0f && t < best) best = t, id = i;
    }
    return id;
}

// A hilly sheet that covers the whole view. Its corners lie behind the middles of pixels, every `step` of them, so that rows,
// columns and diagonals of pixels look straight at its edges.
std::shared_ptr<const Scene> sheet(const CameraPose& pose, int width, int height, int step) {
    SceneBuilder b;
    const std::uint32_t cloth = b.add_material(matte({0.16f, 0.3f, 0.42f}));
    const int columns = width / step + 3, rows = height / step + 3;
    const Camera camera(pose, width, height);
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const float x = static_cast<float>((i - 1) * step) + 0.5f, y = static_cast<float>((j - 1) * step) + 0.5f;
            const double depth = 6.0 + 0.9 * std::sin(0.28 * i + 0.12 * j) + 0.8 * std::cos(0.3 * j - 0.1 * i);
            b.add_vertex(pose.eye + glm::vec3(depth * glm::dvec3(camera.ray(x, y, glm::vec2(0.0f)).direction)));
        }
    }
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < columns; ++i) {
            const auto k = static_cast<std::uint32_t>(j * columns + i), below = k + static_cast<std::uint32_t>(columns);
            b.add_triangle(k, below, below + 1, cloth);
            b.add_triangle(k, below + 1, k + 1, cloth);
        }
    }
    return finish(b, pose);
}

// A ball of `columns` x `rows` quadrilaterals on a floor, as modellers export it: at the poles one side of each has no length,
// and one of its two triangles no area.
std::vector<Corners> ball_with_poles(int columns, int rows) {
    std::vector<Corners> result;
    const auto at = [&](int i, int j) {
        const double phi = 2.0 * kPi * (i % columns) / columns, theta = kPi * j / rows,
                     ring = j == 0 || j == rows ? 0.0 : std::sin(theta);
        return glm::vec3(ring * std::cos(phi), std::cos(theta), ring * std::sin(phi));
    };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            result.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            result.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return result;
}

}  // namespace

Exhibit leaking_edges(int width) {
    Exhibit e{
        "S-TRI-06",
        "Leaking edges",
        "A cloth without a hole before a bright window, its edges behind the middles of pixels: each triangle rounds its side of "
        "a "
        "shared edge on its own, so a ray may miss both (here with products fused as <code>-march=native</code> compiles them).",
        "glint asks on which side of an <i>edge</i> the ray passes, by a number that both triangles compute alike up to its sign "
        "(Woop, Benthin &amp; Wald 2013), with differences of products that round once and a double where float cannot tell.",
        "pixels that see through the cloth",
        "p = cross(d, e2);  det = dot(e1, p);   // fused\nu = dot(s, p) / det;\nv = dot(d, cross(s, e1)) / det;\nif (u < 0 || v "
        "< 0 || u + v > 1) miss;",
        "a, b, c: corners, sheared so that the ray is +z\nu = fma(c.x, b.y, -(c.y*b.x)) + residue; // Kahan\nv, w likewise;\n"
        "if (signs differ) miss;                  // 0 is inside\nif (too small to be sure) again in double;",
        {},
        {}};
    const int height = width * 3 / 4, step = std::max(4, width / 32);
    const CameraPose pose = camera_at({0.31f, -0.22f, 0.17f}, {0.9f, 0.4f, -3.0f}, 50.0f);
    const Stage stage(sheet(pose, width, height, step));
    const Geometry& g = *stage.scene->geometry;
    const auto draw = [&](auto&& hit_of) {
        Side side;
        side.picture = shown(paint(pose, width, height, [&](const Ray& ray, int, int) {
            const PrimitiveId id = hit_of(ray);
            if (id == kNoPrimitive) {
                ++side.defects;
                return kBright;
            }
            const Corners k = corners(g, id);
            const glm::vec3 n = glm::normalize(glm::cross(k.b - k.a, k.c - k.a));
            return lit({0.14f, 0.26f, 0.38f}, std::abs(glm::dot(n, glm::normalize(glm::vec3(0.6f, 0.9f, 0.5f)))), true);
        }));
        return side;
    };
    e.pairs.push_back({"leaks", draw([&](const Ray& ray) { return nearest(g, ray, textbook::moeller_trumbore_fused); }),
                       draw([&](const Ray& ray) { return stage.hit(ray).primitive; })});
    e.pairs[0].textbook.caption = "M&ouml;ller&ndash;Trumbore with fused products";
    e.pairs[0].ours.caption = "Watertight";
    return e;
}

Exhibit lost_triangles(int width) {
    Exhibit e{"S-TRI-05",
              "Small triangles, lost",
              "The same triangle at sizes 1, 0.1, &hellip; 0.0000001, the eye moved closer each time so that it fills its panel: "
              "the determinant shrinks "
              "with the <i>square</i> of the size, and below a thousandth it falls under the threshold 10<sup>&minus;6</sup>.",
              "glint compares the determinant with nothing but 0: only a ray in the triangle&rsquo;s plane misses for it, at any "
              "scale.",
              "panels without their triangle",
              "det = dot(e1, cross(d, e2));\nif (fabs(det) < 1e-6) miss;",
              "det = u + v + w;\nif (det == 0) miss;                      // ray in the plane",
              {},
              {}};
    const int size = width / 8;
    const auto draw = [&](bool ours) {
        Side side;
        Image image{width, size, std::vector<glm::vec3>(static_cast<std::size_t>(width * size))};
        for (int i = 0; i < 8; ++i) {
            const float s = static_cast<float>(std::pow(10.0, -i));
            const CameraPose pose = camera_at({s * 0.45f, s * 0.45f, s * 2.0f}, {s * 0.45f, s * 0.45f, 0}, 38.0f);
            SceneBuilder b;
            b.add_vertex({0, 0, 0}), b.add_vertex({s, 0, 0}), b.add_vertex({0.35f * s, s, 0});
            b.add_triangle(0, 1, 2, b.add_material(matte(glm::vec3(0.8f))));
            const Stage stage(finish(b, pose));
            int seen = 0;
            put(paint(pose, size, size,
                      [&](const Ray& ray, int x, int) {
                          const bool hit = ours
                                               ? stage.hit(ray).found()
                                               : nearest(*stage.scene->geometry, ray, [](auto o, auto d, auto p, auto q, auto r) {
                                                     return textbook::moeller_trumbore(o, d, p, q, r, 1e-6f);
                                                 }) != kNoPrimitive;
                          seen += hit ? 1 : 0;
                          if (x == 0 && i > 0) return glm::vec3(0.25f);
                          return hit ? glm::vec3(0.9f, 0.55f, 0.2f) : glm::vec3(0.03f, 0.035f, 0.05f);
                      }),
                i * size, image);
            side.defects += seen == 0 ? 1.0 : 0.0;
        }
        side.picture = shown(image);
        side.caption = ours ? "Compared with 0" : "Threshold 10<sup>&minus;6</sup>";
        return side;
    };
    e.pairs.push_back({"lost-triangles", draw(false), draw(true)});
    return e;
}

Exhibit false_shadows(int width) {
    Exhibit e{
        "S-TRI-01",
        "Shadows of nothing",
        "A ball whose pole rows hold triangles without area, as modellers export them: dividing by 0 makes weights of NaN, every "
        "rejecting "
        "comparison with NaN is false, so the test that only rejects ends with <code>return true</code> and one such triangle "
        "shadows half the world, and all of them everything.",
        "glint drops triangles without area when a scene is loaded, and its test accepts where the old one rejects, so that NaN "
        "is a miss.",
        "pixels in the shadow of a triangle without area",
        "beta = ... / denom;  gamma = ... / denom;  t = ... / denom;\nif (beta < 0) return false;\nif (gamma < 0) return false;\n"
        "if (beta + gamma > 1) return false;\nif (t < EPSILON) return false;\nreturn true;",
        "if (!valid_triangle(a, b, c)) drop;      // when loading\nif (!(abs(det) > 0)) return false;       // NaN, too",
        {},
        {}};
    const CameraPose pose = camera_at({2.2f, 2.4f, 5.0f}, {0, -0.25f, 0}, 40.0f);
    const std::vector<Corners> ball = ball_with_poles(24, 12);
    SceneBuilder b;
    const std::uint32_t floor = b.add_material(matte({0.62f, 0.62f, 0.6f})), skin = b.add_material(matte({0.3f, 0.55f, 0.75f}));
    add_quad(b, {-9, -1, -9}, {0, 0, 18}, {18, 0, 0}, floor);
    int dropped = 0;
    for (const Corners& k : ball) {
        const std::uint32_t i = b.add_vertex(k.a);
        b.add_vertex(k.b), b.add_vertex(k.c);
        dropped += b.add_triangle(i, i + 1, i + 2, skin) ? 0 : 1;
    }
    const Stage stage(finish(b, pose));
    const glm::vec3 light(3, 5, 2);
    // The first `believed` triangles without area are put to the textbook's test.
    const auto draw = [&](int believed) {
        Side side;
        side.picture = shown(paint(pose, width, width * 3 / 4, [&](const Ray& ray, int, int) {
            const Hit hit = stage.hit(ray);
            if (!hit.found()) return glm::vec3(0.75f, 0.83f, 0.92f);
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const glm::vec3 origin = spawn_origin(s, s.ng), direction = light - origin;
            bool blocked = occluded(*stage.accelerator, {origin, direction, 1.0f});
            int met = 0;
            for (std::size_t i = 0; !blocked && met < believed && i < ball.size(); ++i) {
                const Corners& k = ball[i];
                if (valid_triangle(k.a, k.b, k.c)) continue;
                ++met;
                blocked = textbook::hit_by_rejection(origin, direction, k.a, k.b, k.c);
                side.defects += blocked ? 1.0 : 0.0;
            }
            return lit(stage.scene->materials[s.material].diffuse, glm::dot(s.ng, glm::normalize(direction)), !blocked);
        }));
        side.caption = believed > 0
                           ? fmt::format("{} of {} triangles without area believed", std::min(believed, dropped), dropped)
                           : fmt::format("{} triangles without area dropped", dropped);
        return side;
    };
    e.pairs.push_back({"nan-shadows-one", draw(1), draw(0)});
    e.pairs.push_back({"nan-shadows", draw(dropped), draw(0)});
    return e;
}

}  // namespace glint::gallery
