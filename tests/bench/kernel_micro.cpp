// The smallest pieces of work on their own: one ray against one primitive or eight boxes, a random number, the tone map.
// Run with --benchmark_filter=... to choose. Arrays are small enough for the first cache, so arithmetic is what counts.
#include <benchmark/benchmark.h>

#include "accel/primitive.h"
#include "core/image.h"
#include "core/sampler.h"

namespace {

using namespace glint;

constexpr std::uint32_t kCount = 64;  // primitives and rays, a power of two
constexpr float kMagnitude = 2.0f;

glm::vec3 random_point(std::uint32_t i) {
    const Sampler sampler(SamplerKind::random, i, 0, 0, 1);
    return {2.0f * sampler.square(0) - 1.0f, 2.0f * sampler.interval(1) - 1.0f};
}

// One of each kind around every random point; rays to such points meet about half of them.
Geometry small_geometry() {
    Geometry g;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const glm::vec3 p = random_point(i);
        const std::uint32_t first = 3 * i;
        g.vertices.push_back(p + glm::vec3(-0.3f, -0.2f, 0.0f));
        g.vertices.push_back(p + glm::vec3(0.3f, -0.2f, 0.1f));
        g.vertices.push_back(p + glm::vec3(0.0f, 0.4f, -0.1f));
        g.triangles.push_back({first, first + 1, first + 2});
        g.spheres.push_back({p, 0.2f});
        g.boxes.push_back({p - 0.15f, p + 0.15f});
        g.cones.push_back({p, 0.2f, p + glm::vec3(0.1f, 0.4f, 0.0f), 0.1f});
    }
    return g;
}

std::vector<PreparedRay> rays_to_the_points() {
    std::vector<PreparedRay> rays;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        const glm::vec3 origin = 4.0f * glm::normalize(random_point(i + 1000));
        const glm::vec3 target = random_point(i) + 0.3f * random_point(i + 2000);
        rays.emplace_back(Ray{origin, glm::normalize(target - origin), kInfinity}, kMagnitude);
    }
    return rays;
}

template <PrimitiveKind kind>
void one_primitive(benchmark::State& state) {
    const Geometry geometry = small_geometry();
    const std::vector<PreparedRay> rays = rays_to_the_points();
    std::uint32_t i = 0;
    for (auto _ : state) {
        Hit hit;
        intersect<kind>(rays[i], geometry, i, hit);
        benchmark::DoNotOptimize(hit);
        i = (i + 1) % kCount;
    }
}
BENCHMARK(one_primitive<PrimitiveKind::triangle>)->Name("triangle");
BENCHMARK(one_primitive<PrimitiveKind::sphere>)->Name("sphere");
BENCHMARK(one_primitive<PrimitiveKind::box>)->Name("box");
BENCHMARK(one_primitive<PrimitiveKind::cone>)->Name("cone");

void prepare_ray(benchmark::State& state) {
    Ray ray{{0.0f, 0.0f, 4.0f}, {0.1f, 0.2f, -1.0f}, kInfinity};
    for (auto _ : state) {
        benchmark::DoNotOptimize(ray);
        PreparedRay prepared(ray, kMagnitude);
        benchmark::DoNotOptimize(prepared);
    }
}
BENCHMARK(prepare_ray);

// As many as a node of the BVH has.
void eight_boxes(benchmark::State& state) {
    const Geometry geometry = small_geometry();
    const std::vector<PreparedRay> rays = rays_to_the_points();
    std::vector<Aabb> boxes;
    for (const Box& b : geometry.boxes) boxes.push_back({b.lo, b.hi});
    std::uint32_t i = 0;
    for (auto _ : state) {
        unsigned met = 0;
        for (std::uint32_t k = 0; k < 8; ++k) met += !slab_interval(rays[i], boxes[(i + k) % kCount]).empty();
        benchmark::DoNotOptimize(met);
        i = (i + 1) % kCount;
    }
}
BENCHMARK(eight_boxes);

template <SamplerKind kind>
void sample(benchmark::State& state) {
    std::uint32_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(Sampler(kind, 17, 42, i, 1).square(i & 7));
        ++i;
    }
}
BENCHMARK(sample<SamplerKind::sobol>)->Name("sample_sobol");
BENCHMARK(sample<SamplerKind::jittered>)->Name("sample_jittered");
BENCHMARK(sample<SamplerKind::random>)->Name("sample_random");

void tone_map(benchmark::State& state) {
    Image image{256, 256, {}};
    for (std::uint32_t i = 0; i < 256 * 256; ++i) image.pixels.push_back(glm::abs(random_point(i)));
    for (auto _ : state) benchmark::DoNotOptimize(to_display(image, DisplaySettings{}).rgb.data());
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 256 * 256);
}
BENCHMARK(tone_map)->Unit(benchmark::kMillisecond);

}  // namespace
