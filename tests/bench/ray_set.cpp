#include "ray_set.h"

#include <cmath>
#include <numbers>

#include "core/sampler.h"

namespace glint::bench {
namespace {

constexpr int kTile = 16;          // pixels a side
constexpr int kOneSample = 1024;   // the picture's size at one sample a pixel
constexpr int kManySamples = 512;  // and at sixteen, of which every fourth tile is enough
constexpr int kSamples = 16;
constexpr std::uint64_t kSeed = 1;
constexpr float kLensRadius = 0.01f;  // of the distance to the target: f/50 at 1, a visible blur
constexpr float kLightSide = 0.1f;    // of the diagonal
constexpr float kOcclusionReach = 0.06f;
constexpr float kOffset = 1e-4f;  // of the diagonal: off the surface, so that no competitor meets it again
constexpr float kShortOfHit = 1e-5f;

// What a visible point is to the rays that follow.
struct Visible {
    glm::dvec3 point;   // a little off the surface
    glm::dvec3 normal;  // geometric, towards the viewer
    glm::dvec3 incoming;
    std::uint32_t id;  // of pixel and sample, for random numbers
};

// Of each `thin` tiles in a row one counts, at random, so that no pattern of the scene is favoured.
bool tile_counts(std::uint32_t tile, std::uint32_t thin) { return tile % thin == hash(tile / thin) % thin; }

// Morton order inside a tile: 16 neighbours are 4x4 pixels, 64 are 8x8.
glm::ivec2 morton(unsigned i) {
    const auto even_bits = [](unsigned x) { return (x & 1) | (x >> 1 & 2) | (x >> 2 & 4) | (x >> 3 & 8); };
    return {static_cast<int>(even_bits(i)), static_cast<int>(even_bits(i >> 1))};
}

glm::vec2 random(std::uint32_t id, std::uint32_t dimension) {
    return Sampler(SamplerKind::random, id, dimension, 0, kSeed).square(0);
}

struct Picture {
    int size, samples, thin;
    bool lens = false;
};

struct CameraRays {
    std::vector<Ray> rays;
    std::vector<std::uint32_t> ids;
};

CameraRays camera_rays(const BenchScene& scene, const Picture& picture) {
    CameraPose pose = scene.pose;
    pose.lens_radius = picture.lens ? kLensRadius * pose.target_distance() : 0.0f;
    pose.focus_distance = 0.0f;
    const Camera camera(pose, picture.size, picture.size);
    CameraRays result;
    const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(picture.samples)));
    const auto add = [&](glm::ivec2 pixel, std::uint32_t sample) {
        const auto id = static_cast<std::uint32_t>((pixel.y * picture.size + pixel.x) * picture.samples) + sample;
        glm::vec2 at(0.5f);
        if (picture.samples > 1) at = (glm::vec2(sample % grid, sample / grid) + random(id, 1)) / static_cast<float>(grid);
        const glm::vec2 lens = picture.lens ? disk_from_square(random(id, 2)) : glm::vec2(0.0f);
        result.rays.push_back(camera.ray(static_cast<float>(pixel.x) + at.x, static_cast<float>(pixel.y) + at.y, lens));
        result.ids.push_back(id);
    };
    const int tiles = picture.size / kTile;
    for (int ty = 0; ty < tiles; ++ty) {
        for (int tx = 0; tx < tiles; ++tx) {
            if (!tile_counts(static_cast<std::uint32_t>(ty * tiles + tx), static_cast<std::uint32_t>(picture.thin))) continue;
            for (unsigned i = 0; i < kTile * kTile; ++i) {
                for (int s = 0; s < picture.samples; ++s) {
                    add(glm::ivec2(tx, ty) * kTile + morton(i), static_cast<std::uint32_t>(s));
                }
            }
        }
    }
    return result;
}

glm::dvec3 geometric_normal(const Geometry& g, const Hit& hit, glm::dvec3 point) {
    const std::uint32_t i = index_of(hit.primitive);
    if (kind_of(hit.primitive) == PrimitiveKind::sphere) return glm::normalize(point - glm::dvec3(g.spheres[i].center));
    const auto& t = g.triangles[i];
    const glm::dvec3 a(g.vertices[t[0]]), b(g.vertices[t[1]]), c(g.vertices[t[2]]);
    return glm::normalize(glm::cross(b - a, c - a));
}

std::vector<Visible> visible_points(const BenchScene& scene, const Bvh& bvh, const CameraRays& camera) {
    std::vector<Visible> points;
    for (std::size_t i = 0; i < camera.rays.size(); ++i) {
        const Ray& ray = camera.rays[i];
        const Hit hit = bvh.closest_hit(ray);
        if (!hit.found()) continue;
        const glm::dvec3 direction(ray.direction);
        const glm::dvec3 point = glm::dvec3(ray.origin) + static_cast<double>(hit.t) * direction;
        glm::dvec3 normal = geometric_normal(*scene.geometry, hit, point);
        if (glm::dot(normal, direction) > 0.0) normal = -normal;
        const double offset = static_cast<double>(kOffset) * static_cast<double>(scene.diagonal);
        points.push_back({point + offset * normal, normal, direction, camera.ids[i]});
    }
    return points;
}

struct Axes {
    glm::dvec3 x, y;
};
Axes perpendicular(glm::dvec3 n) {
    const glm::dvec3 helper = std::abs(n.x) > 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(helper, n));
    return {x, glm::cross(n, x)};
}

// From `from` to just short of `to`.
Ray segment(glm::dvec3 from, glm::dvec3 to) {
    const double length = glm::length(to - from);
    return {glm::vec3(from), glm::vec3((to - from) / length), static_cast<float>(length) * (1.0f - kShortOfHit)};
}

Ray to_area_light(const BenchScene& scene, const Visible& v) {
    const glm::dvec3 light(scene.light);
    const Axes axes = perpendicular(glm::normalize(light - glm::dvec3(scene.pose.target)));
    const glm::dvec2 u = glm::dvec2(random(v.id, 3)) - 0.5;
    const double side = static_cast<double>(kLightSide) * static_cast<double>(scene.diagonal);
    return segment(v.point, light + side * (u.x * axes.x + u.y * axes.y));
}

Ray cosine_weighted(const Visible& v, std::uint32_t dimension, float reach) {
    const glm::dvec2 u(random(v.id, dimension));
    const Axes axes = perpendicular(v.normal);
    const double radius = std::sqrt(u.x), angle = 2.0 * std::numbers::pi * u.y;
    const glm::dvec3 d = radius * (std::cos(angle) * axes.x + std::sin(angle) * axes.y) + std::sqrt(1.0 - u.x) * v.normal;
    return {glm::vec3(v.point), glm::vec3(glm::normalize(d)), reach};
}

Ray mirrored(const Visible& v) {
    return {glm::vec3(v.point), glm::vec3(v.incoming - 2.0 * glm::dot(v.incoming, v.normal) * v.normal), kInfinity};
}

template <class F>
std::vector<Ray> from_each(const std::vector<Visible>& points, F make) {
    std::vector<Ray> rays;
    rays.reserve(points.size());
    for (const Visible& v : points) rays.push_back(make(v));
    return rays;
}

}  // namespace

std::vector<RaySet> make_ray_sets(const BenchScene& scene, const Bvh& bvh, int thin) {
    CameraRays one = camera_rays(scene, {kOneSample, 1, thin});
    CameraRays many = camera_rays(scene, {kManySamples, kSamples, 4 * thin});
    const std::vector<Visible> seen_once = visible_points(scene, bvh, one), seen = visible_points(scene, bvh, many);
    const glm::dvec3 light(scene.light);
    const auto from_light = [&](const Visible& v) { return segment(light, v.point); };
    const float reach = kOcclusionReach * scene.diagonal;
    using enum RayOrder;
    std::vector<RaySet> sets{
        {"primary", false, common_origin, std::move(one.rays), {}},
        {"primary16", false, common_origin, std::move(many.rays), {}},
        {"lens16", false, coherent, camera_rays(scene, {kManySamples, kSamples, 4 * thin, true}).rays, {}},
        {"shadow", true, common_origin, from_each(seen_once, from_light), {}},
        {"shadow16", true, common_origin, from_each(seen, from_light), {}},
        {"area16", true, coherent, from_each(seen, [&](const Visible& v) { return to_area_light(scene, v); }), {}},
        {"reflect", false, coherent, from_each(seen_once, mirrored), {}},
        {"diffuse",
         false,
         divergent,
         from_each(seen_once, [](const Visible& v) { return cosine_weighted(v, 4, kInfinity); }),
         {}},
        {"ao", true, divergent, from_each(seen_once, [&](const Visible& v) { return cosine_weighted(v, 5, reach); }), {}},
    };
    for (RaySet& set : sets) set.make_batches();
    return sets;
}

}  // namespace glint::bench
