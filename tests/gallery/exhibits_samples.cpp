// Samples: strata that are paired in order, and sums that no longer grow.

#include <array>

#include "core/branching.h"
#include "core/framebuffer.h"
#include "core/sampler.h"
#include "tests/gallery/exhibit.h"
#include "tests/gallery/stage.h"

namespace glint::gallery {
namespace {

// What one sample of a pixel needs: where in the pixel, on the lens, on the light.
using Needs = std::array<glm::vec2, 3>;

// n x n jittered strata, the k-th of each need in the k-th sample.
Needs in_order(int x, int y, int k, int n) {
    const Sampler random(SamplerKind::random, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                         static_cast<std::uint64_t>(k), 1);
    Needs needs;
    for (std::uint32_t i = 0; i < 3; ++i) {
        needs[i] = (glm::vec2(k % n, k / n) + random.square(i)) / static_cast<float>(n);
    }
    return needs;
}
// The product's: strata in an order of their own for each need.
Needs shuffled(int x, int y, int k, int) {
    const Sampler s(SamplerKind::jittered, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                    static_cast<std::uint64_t>(k), 0);
    return {s.square(dimension::pixel), s.square(dimension::lens), s.square(hash(kCameraPath, 0))};
}

struct Correlation {
    double pairs = 0.0;    // of needs and axes whose mean product is not 1/4 within five standard errors
    double product = 0.0;  // mean of lens x light, both along x
};

template <class Draw>
Correlation correlation(Draw&& draw, int n) {
    Correlation result;
    const int pixels = 2048, count = n * n;
    const std::array<std::array<std::size_t, 2>, 3> of{{{0, 1}, {0, 2}, {1, 2}}};
    for (const auto& [first, second] : of) {
        for (int axis = 0; axis < 2; ++axis) {
            double sum = 0.0, squares = 0.0;
            for (int p = 0; p < pixels; ++p) {
                double mean = 0.0;
                for (int k = 0; k < count; ++k) {
                    const Needs needs = draw(p % 64, p / 64, k, n);
                    mean += static_cast<double>(needs[first][axis]) * static_cast<double>(needs[second][axis]) / count;
                }
                sum += mean, squares += mean * mean;
            }
            const double mean = sum / pixels, error = std::sqrt(std::max(0.0, squares / pixels - mean * mean) / pixels);
            result.pairs += std::abs(mean - 0.25) > 5.0 * error ? 1.0 : 0.0;
            if (first == 1 && axis == 0) result.product = mean;
        }
    }
    return result;
}

// Adds each value N times, the way a picture accumulates passes.
template <class Real>
std::vector<Real> sums(const std::vector<float>& values, long passes) {
    constexpr std::size_t kBlock = 16;  // independent sums at once
    std::vector<Real> result(values.size());
    for (std::size_t first = 0; first < values.size(); first += kBlock) {
        Real sum[kBlock] = {}, value[kBlock];
        for (std::size_t k = 0; k < kBlock; ++k) value[k] = static_cast<Real>(values[first + k]);
        for (long i = 0; i < passes; ++i) {
            for (std::size_t k = 0; k < kBlock; ++k) sum[k] += value[k];
        }
        std::copy_n(sum, kBlock, result.begin() + static_cast<std::ptrdiff_t>(first));
    }
    return result;
}

}  // namespace

Exhibit correlated_strata(int width) {
    Exhibit e{"S-SMP-04",
              "Strata paired in order",
              "A lens out of focus over soft shadows, 8 &times; 8 strata each: if sample <i>k</i> takes the <i>k</i>-th stratum "
              "of the lens <i>and</i> of the lamp, the "
              "two always move together, and here the blur of the floor cancels that of the shadow; more samples do not mend it.",
              "glint shuffles the strata of each pixel and each dimension anew (the mean of lens &times; lamp is then 1/4; in "
              "order it is 1/3&nbsp;&minus;&nbsp;1/768&nbsp;=&nbsp;0.3320).",
              "of 6 pairs of dimensions are correlated",
              "for (k = 0; k < n*n; ++k) {\n  pixel = jitter(k % n, k / n);\n  lens  = jitter(k % n, k / n);\n  lamp  = jitter(k "
              "% n, k / n);\n}",
              "key = hash(pixel, dimension);\nk = permute(sample, n*n, key);           // each need its own\npoint = jitter(k % "
              "n, k / n);",
              {},
              {}};
    CameraPose pose = camera_at({0, 5.2f, 5.2f}, {0, 0.1f, 0}, 34.0f);
    pose.lens_radius = 0.3f;
    pose.focus_distance = 3.7f;
    SceneBuilder b;
    const std::uint32_t floor = b.add_material(matte({0.75f, 0.73f, 0.68f}));
    add_quad(b, {-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, floor);
    for (int i = 0; i < 3; ++i) {
        b.add(Sphere{{-1.4f + 1.4f * static_cast<float>(i), 1.1f, 0.9f - 0.5f * static_cast<float>(i)}, 0.34f},
              b.add_material(matte({0.7f - 0.2f * static_cast<float>(i), 0.35f, 0.25f + 0.2f * static_cast<float>(i)})));
    }
    Light lamp;
    lamp.position = {0.4f, 4.4f, -1.2f};
    lamp.edge1 = {1.8f, 0, 0};
    lamp.edge2 = {0, 0, -1.8f};
    b.scene().lights = {lamp};
    const Stage stage(finish(b, pose));
    const int height = width * 3 / 4, n = 8;
    const Camera camera(pose, width, height);
    const Image left = paint(pose, width, height, [&](const Ray&, int x, int y) {
        glm::dvec3 sum(0.0);
        for (int k = 0; k < n * n; ++k) {
            const Needs needs = in_order(x, y, k, n);
            const Ray ray =
                camera.ray(static_cast<float>(x) + needs[0].x, static_cast<float>(y) + needs[0].y, disk_from_square(needs[1]));
            const Hit hit = stage.hit(ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(*stage.scene, ray, hit);
            const LightSample l = sample_light(lamp, s.p, needs[2]);
            const float n_l = glm::dot(s.ns, l.wi);
            const glm::vec3 origin = spawn_origin(s, s.ng);
            if (n_l > 0.0f && !occluded(*stage.accelerator, {origin, l.point - origin, 0.9999f})) {
                sum += glm::dvec3(stage.scene->materials[s.material].diffuse * n_l);
            }
        }
        return glm::vec3(sum / static_cast<double>(n * n));
    });
    RenderSettings settings = centred();
    settings.features = FeatureSet::all();
    settings.sampler = SamplerKind::jittered;
    const Correlation ordered = correlation(in_order, n), mixed = correlation(shuffled, n);
    const auto caption = [](double product) {
        return fmt::format("Mean of lens &times; lamp {:.4f}; 64 samples a pixel", product);
    };
    e.pairs.push_back({"strata",
                       {shown(left), caption(ordered.product), ordered.pairs},
                       {shown(rendered(stage, pose, width, height, n * n, settings)), caption(mixed.product), mixed.pairs}});
    return e;
}

Exhibit stalled_sums(int width) {
    Exhibit e{"S-ACC-01",
              "Sums that no longer grow",
              "A ramp of greys, added up pass by pass and divided by their number, over a strip of the true values: once the sum "
              "is about 2<sup>24</sup> times the sample, "
              "float rounds the addition away, and the longer one waits the darker the picture becomes.",
              "glint adds in double, 24 bytes a pixel: 10<sup>8</sup> passes cost it no digit that a picture shows.",
              "columns off by more than a millionth",
              "float sum[3];\nsum += sample;                           // each pass\npixel = sum / passes;",
              "double sum[3];\nsum += sample;\npixel = float(sum / passes);",
              {},
              {}};
    std::vector<float> values;
    for (int x = 0; x < width; ++x) values.push_back(0.02f + 0.7f * static_cast<float>(x) / static_cast<float>(width));
    const int height = width / 4;
    const auto draw = [&](const std::vector<float>& means) {
        Side side;
        double tenth = 0.0, nearest = 1.0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double error = static_cast<double>(means[i]) / static_cast<double>(values[i]) - 1.0,
                         away = std::abs(static_cast<double>(values[i]) - 0.1);
            side.defects += std::abs(error) > 1e-6 ? 1.0 : 0.0;
            if (away < nearest) nearest = away, tenth = error;
        }
        side.picture = shown(paint(camera_at({0, 0, 1}, {0, 0, 0}, 40.0f), width, height, [&](const Ray&, int x, int y) {
            return glm::vec3((y * 4 < height * 3 ? means : values)[static_cast<std::size_t>(x)]);
        }));
        side.caption =
            fmt::format("Error at 0.1: {}&thinsp;%", std::abs(tenth) < 1e-6 ? "0.0000" : fmt::format("{:+.3g}", 100.0 * tenth));
        return side;
    };
    for (const long passes : {1'000'000L, 10'000'000L, 100'000'000L}) {
        if (width < 256 && passes > 10'000'000L) continue;  // the small gallery has no time for it
        std::vector<float> left = sums<float>(values, passes);
        for (float& x : left) x /= static_cast<float>(passes);
        Framebuffer framebuffer({0, 0, width, 1});
        const std::vector<double> exact = sums<double>(values, passes);
        for (std::size_t tile = 0; tile < framebuffer.tile_count(); ++tile) {
            const TileRect r = framebuffer.tile_rect(tile);
            std::vector<PixelSum> pixels(r.pixels());
            for (std::size_t i = 0; i < pixels.size(); ++i)
                pixels[i].radiance = glm::dvec3(exact[static_cast<std::size_t>(r.x0) + i]);
            framebuffer.write_back(tile, 1, pixels, static_cast<int>(passes));
        }
        Image image{width, 1, std::vector<glm::vec3>(static_cast<std::size_t>(width))};
        for (std::size_t tile = 0; tile < framebuffer.tile_count(); ++tile) framebuffer.resolve(tile, 1, image);
        std::vector<float> right;
        for (const glm::vec3& p : image.pixels) right.push_back(p.x);
        Side float_side = draw(left), double_side = draw(right);
        for (Side* s : {&float_side, &double_side}) s->caption = grouped(static_cast<double>(passes)) + " passes. " + s->caption;
        e.pairs.push_back({fmt::format("sums-{}", passes), std::move(float_side), std::move(double_side)});
    }
    return e;
}

}  // namespace glint::gallery
