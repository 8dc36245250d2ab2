#include "tests/numeric/self_hits.h"

#include <memory>

#include "accel/primitive.h"
#include "core/scene_origin.h"
#include "tests/accel/random.h"
#include "tests/materials.h"

namespace glint::numeric {
namespace {

// Shapes of size 1 around zero.
const glm::dvec3 kCorner[3] = {{-1, -0.5, 0.2}, {1, -0.7, -0.3}, {0.1, 1, 0.4}};
const glm::dvec3 kHalf(0.7, 0.5, 0.6), kAxis(0.2, 0.8, 0.1);
constexpr double kBase = 0.9, kApex = 0.3;
const glm::dvec3 kNormal = glm::normalize(glm::dvec3(0.3, 1.0, -0.4));

glm::dvec3 triangle_normal() { return glm::normalize(glm::cross(kCorner[1] - kCorner[0], kCorner[2] - kCorner[0])); }

// Primitive 0, and primitive 1 of the same kind as a wall `gap` before it.
void build(SceneBuilder& b, PrimitiveKind kind, glm::dvec3 at, double size, double gap) {
    const std::uint32_t m = b.add_material(test::matte(1.0f));
    const auto local = [&](glm::dvec3 p) { return b.scene().local(at + size * p); };
    const auto length = [](double x) { return static_cast<float>(x); };
    const double g = gap / size;
    switch (kind) {
        case PrimitiveKind::triangle:
            for (const glm::dvec3 c : kCorner) b.add_vertex(local(c));
            for (const glm::dvec3 c : kCorner) b.add_vertex(local(4.0 * c + g * triangle_normal()));
            if (b.add_triangle(0, 1, 2, m)) b.add_triangle(3, 4, 5, m);
            break;
        case PrimitiveKind::sphere:
            b.add(Sphere{local(glm::dvec3(0.0)), length(size)}, m);
            b.add(Sphere{local(glm::dvec3(0.0)), length(size + gap)}, m);
            break;
        case PrimitiveKind::box:
            if (b.add(Box{local(-kHalf), local(kHalf)}, m)) b.add(Box{local(-kHalf - g), local(kHalf + g)}, m);
            break;
        case PrimitiveKind::cone: {
            // The wall is longer at both ends, so that no ray slips out there.
            const double slope = 0.5 * (kApex - kBase), slant = std::sqrt(1.0 + slope * slope / glm::dot(kAxis, kAxis));
            const auto radius = [&](double s) { return length(size * (0.5 * (kBase + kApex) + slope * s) + gap * slant); };
            if (b.add(Cone{local(-kAxis), length(size * kBase), local(kAxis), length(size * kApex)}, m))
                b.add(Cone{local(-1.3 * kAxis), radius(-1.3), local(1.3 * kAxis), radius(1.3)}, m);
            break;
        }
        case PrimitiveKind::plane:
            for (const double height : {0.0, g}) {
                const glm::dvec3 point = at - b.scene().origin + size * height * kNormal;
                b.add(Plane{kNormal, -glm::dot(kNormal, point)}, m);
            }
            break;
    }
}

// How far the wall stands before a point of the primitive, as floats have left both.
double clearance(const Geometry& g, PrimitiveKind kind, glm::dvec3 p) {
    switch (kind) {
        case PrimitiveKind::triangle: {
            const auto corner = [&](std::size_t k) { return glm::dvec3(g.vertices[g.triangles[1][k]]); };
            const glm::dvec3 n = glm::normalize(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
            return glm::dot(n, corner(0) - p);
        }
        case PrimitiveKind::sphere: return g.spheres[1].radius - glm::length(p - glm::dvec3(g.spheres[1].center));
        case PrimitiveKind::box: {
            const glm::dvec3 low = p - glm::dvec3(g.boxes[1].lo), high = glm::dvec3(g.boxes[1].hi) - p;
            const glm::dvec3 least = glm::min(low, high);
            return std::min(least.x, std::min(least.y, least.z));
        }
        case PrimitiveKind::cone: {
            const Cone& c = g.cones[1];
            const glm::dvec3 base(c.base), axis = glm::dvec3(c.apex) - base;
            const double s = glm::dot(p - base, axis) / glm::dot(axis, axis);
            const double slope = static_cast<double>(c.apex_radius) - static_cast<double>(c.base_radius);
            return c.base_radius + slope * s - glm::length(p - base - s * axis);
        }
        case PrimitiveKind::plane: return -(glm::dot(g.planes[1].normal, p) + g.planes[1].offset);
    }
    return 0.0;
}

struct Place {
    glm::dvec3 at;
    double size, gap;
};

Place place_of(Axis axis, int exponent, bool recentred) {
    const double size = axis == Axis::scale ? std::pow(10.0, exponent) : 1.0;
    const double distance = axis == Axis::distance ? std::pow(10.0, exponent) : size;
    return {distance * glm::dvec3(1.0, 0.7, -0.4), size,
            std::max(1e-3 * size, 24.0 * 0x1p-24 * (size + (recentred ? 0.0 : distance)))};
}

// As readers do it: from zero, or again from a point near the middle where that turns out to be far away.
std::shared_ptr<const Scene> scene_at(const OffsetRule& rule, PrimitiveKind kind, const Place& place) {
    SceneOrigin origin;
    for (;;) {
        SceneBuilder b(origin.world());
        build(b, kind, place.at, place.size, place.gap);
        // A plane has no place of its own; in a file the view has one.
        b.mark(b.scene().local(place.at));
        if (!rule.recentred || origin.suits(b.extent())) return b.finish();
    }
}

Hit meet(const Geometry& g, PrimitiveKind kind, std::uint32_t i, const Ray& ray, float t_min) {
    const PreparedRay prepared(ray, g.bounds().magnitude());
    Hit hit;
    if (prepared.usable) intersect(prepared, g, make_id(kind, i), hit);
    return hit.found() && hit.t >= t_min ? hit : Hit();
}

// A ray from ten sizes away to near the middle; a flat primitive is seen from the side of its wall.
Ray camera_ray(Random& random, const Scene& scene, PrimitiveKind kind, const Place& place) {
    glm::dvec3 from = random.unit();
    const bool flat = kind == PrimitiveKind::triangle || kind == PrimitiveKind::plane;
    const glm::dvec3 n = kind == PrimitiveKind::plane ? kNormal : triangle_normal();
    if (flat && glm::dot(from, n) < 0.0) from = -from;
    const glm::vec3 eye = scene.local(place.at + 10.0 * place.size * from);
    const glm::vec3 target = scene.local(place.at + 0.5 * place.size * random.uniform() * random.unit());
    const glm::dvec3 d = glm::dvec3(target) - glm::dvec3(eye);
    return {eye, glm::vec3(d / std::sqrt(glm::dot(d, d))), kInfinity};
}

Left left_at(const Scene& scene, PrimitiveKind kind, const Ray& ray, const Hit& hit) {
    Left l{ray, hit, surface_point(scene, ray, hit), {}};
    l.from_weights = l.along_ray();
    if (kind == PrimitiveKind::triangle) {
        const auto& v = scene.geometry->vertices;
        l.from_weights = (1.0f - hit.u - hit.v) * v[0] + hit.u * v[1] + hit.v * v[2];
    }
    return l;
}

void measure(OffsetCell& cell, int rays) {
    constexpr int fan = 8;
    const Place place = place_of(cell.axis, cell.exponent, cell.rule->recentred);
    const auto scene = scene_at(*cell.rule, cell.primitive, place);
    const Geometry& g = *scene->geometry;
    if (scene->material_of[static_cast<std::size_t>(cell.primitive)].size() < 2) return;
    Random random(static_cast<std::uint64_t>(cell.primitive) + 1);
    int points = 0;
    for (int tries = 0; cell.rays < rays && tries < rays; ++tries) {
        const Ray ray = camera_ray(random, *scene, cell.primitive, place);
        const Hit hit = meet(g, cell.primitive, 0, ray, 0.0f);
        if (!hit.found()) continue;
        const Left left = left_at(*scene, cell.primitive, ray, hit);
        if (!left.s.outside && cell.primitive != PrimitiveKind::triangle && cell.primitive != PrimitiveKind::plane) continue;
        const Start start = cell.rule->start(left);
        const glm::dvec3 p(left.s.p), n(left.s.ng);
        const bool walled = place.gap <= 0.2 * place.size && clearance(g, cell.primitive, p) > 0.5 * place.gap;
        cell.offset += glm::length(glm::dvec3(start.origin) - p) / place.size;
        ++points;
        for (int k = 0; k < fan; ++k) {
            glm::dvec3 d = random.unit();
            if (glm::dot(d, n) < 0.0) d -= 2.0 * glm::dot(d, n) * n;
            const Ray next{start.origin, glm::vec3(d), kInfinity};
            ++cell.rays;
            cell.self_hits += meet(g, cell.primitive, 0, next, start.t_min).found() ? 1 : 0;
            if (!walled || glm::dot(d, n) < 0.5) continue;
            ++cell.walled;
            cell.leaks += meet(g, cell.primitive, 1, next, start.t_min).found() ? 0 : 1;
        }
    }
    cell.offset /= std::max(1, points);
}

}  // namespace

std::vector<OffsetCell> measure_offsets(int rays) {
    std::vector<OffsetCell> cells;
    for (const Axis axis : {Axis::distance, Axis::scale}) {
        const int first = axis == Axis::distance ? 0 : -8, last = axis == Axis::distance ? 7 : 8;
        for (std::uint32_t kind = 0; kind < kPrimitiveKinds; ++kind) {
            for (const OffsetRule& rule : kOffsetRules) {
                for (int exponent = first; exponent <= last; ++exponent) {
                    cells.push_back({axis, exponent, static_cast<PrimitiveKind>(kind), &rule});
                    measure(cells.back(), rays);
                }
            }
        }
    }
    return cells;
}

}  // namespace glint::numeric
