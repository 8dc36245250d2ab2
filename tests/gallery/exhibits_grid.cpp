// A uniform grid that stops at the first hit it finds.

#include <array>

#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

// The grid as it is often told: each primitive in the cells that its box meets, walked by a 3-D DDA (Amanatides & Woo 1987) that
// ends in the first cell where anything is hit, wherever that hit lies.
class EarlyGrid {
public:
    explicit EarlyGrid(const Geometry& g) : g_(g), box_(g.bounds()), magnitude_(box_.magnitude()) {
        for (const PrimitiveId id : g.bounded_ids()) {
            const Aabb b = g.bounds(id);
            const glm::ivec3 lo = cell(b.lo), hi = cell(b.hi);
            for (int z = lo.z; z <= hi.z; ++z) {
                for (int y = lo.y; y <= hi.y; ++y) {
                    for (int x = lo.x; x <= hi.x; ++x) cells_[index({x, y, z})].push_back(id);
                }
            }
        }
    }

    [[nodiscard]] Hit hit(const Ray& ray) const {
        const PreparedRay prepared(ray, magnitude_);
        const Interval inside = slab_interval(prepared, box_);
        if (inside.empty() || inside.far < 0.0f) return {};
        const glm::vec3 size = box_.size() / static_cast<float>(kCells),
                        start = ray.origin + std::max(0.0f, inside.near) * ray.direction;
        glm::ivec3 at = cell(start), step;
        glm::vec3 next, delta;
        for (int i = 0; i < 3; ++i) {
            step[i] = ray.direction[i] > 0.0f ? 1 : -1;
            delta[i] = std::abs(size[i] / ray.direction[i]);
            next[i] =
                (box_.lo[i] + static_cast<float>(at[i] + (step[i] > 0 ? 1 : 0)) * size[i] - ray.origin[i]) / ray.direction[i];
        }
        while (true) {
            Hit best;
            best.t = ray.t_max;
            for (const PrimitiveId id : cells_[index(at)]) intersect(prepared, g_, id, best);
            if (best.found()) return best;
            const int i = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
            at[i] += step[i];
            if (at[i] < 0 || at[i] >= kCells) return {};
            next[i] += delta[i];
        }
    }

private:
    static constexpr int kCells = 6;
    [[nodiscard]] glm::ivec3 cell(glm::vec3 p) const {
        return glm::clamp(glm::ivec3((p - box_.lo) / box_.size() * static_cast<float>(kCells)), glm::ivec3(0),
                          glm::ivec3(kCells - 1));
    }
    static std::size_t index(glm::ivec3 c) { return static_cast<std::size_t>((c.z * kCells + c.y) * kCells + c.x); }

    const Geometry& g_;
    Aabb box_;
    float magnitude_;
    std::array<std::vector<PrimitiveId>, kCells * kCells * kCells> cells_;
};

}  // namespace

Exhibit early_exit(int width) {
    Exhibit e{
        "S-GRD-01",
        "A grid that stops too early",
        "Balls before a slanting wall: the wall is listed in many cells, the ray meets it in a cell of its list but far behind "
        "that cell, "
        "and a walk that ends at the first hit never reaches the ball in between.",
        "glint accepts a hit only where it lies before the ray leaves the cell, and keeps the nearest so far; the picture is "
        "that of the plain "
        "loop over everything, to the bit.",
        "pixels that show another object than the nearest",
        "for (cell along the ray)\n  for (object in cell) keep the nearest hit;\n  if (any hit) return it;",
        "for (cell along the ray)\n  for (object in cell) keep the nearest hit;\n  if (t_hit <= t_exit of the cell) return it;",
        {},
        {}};
    const CameraPose pose = camera_at({-3.5f, 1.2f, 9.0f}, {0, 0, -0.5f}, 34.0f);
    SceneBuilder b;
    const std::uint32_t wall = b.add_material(matte({0.72f, 0.7f, 0.64f}));
    add_quad(b, {-3.2f, -2, 2.5f}, {7.0f, 0, -6.5f}, {0, 4, 0}, wall);
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 3; ++j) {
            const auto x = static_cast<float>(i), y = static_cast<float>(j);
            const std::uint32_t m = b.add_material(matte({0.25f + 0.15f * x, 0.35f + 0.1f * y, 0.7f - 0.12f * x}));
            b.add(Sphere{{-2.0f + 1.25f * x, -1.25f + 1.25f * y, 2.4f - 1.15f * x}, 0.45f}, m);
        }
    }
    const Stage stage(finish(b, pose), AcceleratorKind::grid), loop(stage.scene, AcceleratorKind::none);
    const EarlyGrid early(*stage.scene->geometry);
    const glm::vec3 sun = glm::normalize(glm::vec3(-1, 2, 3));
    const auto draw = [&](auto&& hit_of, const char* caption) {
        Side side;
        side.caption = caption;
        side.picture = shown(paint(pose, width, width * 3 / 4, [&](const Ray& ray, int, int) {
            const Hit hit = hit_of(ray);
            side.defects += hit.primitive != loop.hit(ray).primitive ? 1.0 : 0.0;
            if (!hit.found()) return glm::vec3(0.1f, 0.11f, 0.13f);
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            return lit(stage.scene->materials[s.material].diffuse, glm::dot(s.ng, sun), true);
        }));
        return side;
    };
    e.pairs.push_back({"grid", draw([&](const Ray& ray) { return early.hit(ray); }, "6 &times; 6 &times; 6 cells, first hit"),
                       draw([&](const Ray& ray) { return stage.hit(ray); }, "The product&rsquo;s grid")});
    return e;
}

}  // namespace glint::gallery
