// accelerator_cost SCENE: why one accelerator renders a scene faster than another. Seconds of the paper's render with grid and
// BVH, and beside them what each does for a ray: nodes or cells entered, blocks of up to eight primitives tested.
#include <array>
#include <cmath>
#include <cstdio>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "core/accelerator_cache.h"
#include "core/sampler.h"
#include "core/scene_io.h"
#include "core/surface_point.h"
#include "timed_frame.h"

namespace {

using namespace glint;

struct Arguments {
    std::string scene;
    int width = 800, height = 600, spp = 64, grid_spp = 64, threads = 1;
};

// The paper's work: 64 jittered samples, soft shadows from a small square, three bounces, the background colour.
RenderSettings paper_settings() {
    RenderSettings settings;
    settings.features = FeatureSet::whitted();
    settings.features.set(Feature::aa, true);
    settings.features.set(Feature::soft, true);
    settings.background = Background::color;
    settings.depth = 3;
    settings.light_size = 0.05f;
    settings.seed = 1;
    return settings;
}

struct Rays {
    std::vector<Ray> camera, shadow, mirrored;
};

// The rays of one sample in every pixel; mirrored ones from mirrors only.
Rays make_rays(const Scene& scene, const Bvh& bvh, int width, int height) {
    Rays rays;
    const Camera camera(scene.cameras.front(), width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, glm::vec2(0.0f));
            rays.camera.push_back(ray);
            const Hit hit = bvh.closest_hit(ray);
            if (!hit.found()) continue;
            const SurfacePoint s = surface_point(scene, ray, hit);
            for (const Light& light : scene.lights) {
                const glm::vec3 origin = spawn_origin(s, s.ng), to = light.position - origin;
                if (glm::dot(to, s.ng) > 0.0f) rays.shadow.push_back({origin, to, 1.0f});
            }
            if (!scene.materials[s.material].has_mirror()) continue;
            const glm::vec3 direction = ray.direction - 2.0f * glm::dot(ray.direction, s.ns) * s.ns;
            if (glm::dot(direction, s.ng) > 0.0f) rays.mirrored.push_back({spawn_origin(s, s.ng), direction, kInfinity});
        }
    }
    return rays;
}

// Entered nodes or cells, and tested blocks, a ray.
template <class A>
std::string cost(const A& accelerator, const std::vector<Ray>& rays) {
    TraversalCounts sum;
    RayBatch batch;
    for (std::size_t first = 0; first < rays.size(); first += kRayBatch) {
        batch.clear(RayOrder::divergent);
        batch.assign(&rays[first], static_cast<int>(std::min<std::size_t>(kRayBatch, rays.size() - first)));
        const TraversalCounts counts = accelerator.count_traversal(batch);
        sum.nodes += counts.nodes;
        sum.leaves += counts.leaves;
    }
    const double n = std::max(1.0, static_cast<double>(rays.size()));
    return fmt::format("{:.1f}, {:.1f}", static_cast<double>(sum.nodes) / n, static_cast<double>(sum.leaves) / n);
}

template <class A>
void print_row(const std::shared_ptr<const Scene>& scene, const Rays& rays, AcceleratorKind kind, int spp, const Arguments& a) {
    AcceleratorCache cache(scene, a.threads);
    const auto accelerator = cache.wait(kind);
    Renderer renderer(a.threads, false);
    const Progress p = bench::render(renderer, bench::frame_of(scene, accelerator, paper_settings(), a.width, a.height, spp));
    const double scale = static_cast<double>(a.spp) / spp;
    const A& queries = std::get<A>(*accelerator);
    fmt::print("| {} | {:.1f} | {}{:.2f} | {:.2f} | {} | {} | {} |\n", kAcceleratorNames[static_cast<std::size_t>(kind)],
               1e3 * cache.build_seconds(kind), spp == a.spp ? "" : "~", p.seconds * scale,
               static_cast<double>(p.rays.total()) / p.seconds * 1e-6, cost(queries, rays.camera), cost(queries, rays.shadow),
               cost(queries, rays.mirrored));
    std::fflush(stdout);
}

void run(const Arguments& a) {
    LoadOptions options;
    options.load_environment = false;
    const std::shared_ptr<const Scene> scene = load_scene(a.scene, options);
    const Rays rays = make_rays(*scene, Bvh(scene->geometry), a.width, a.height);
    fmt::print(
        "{}, {}x{}, {} samples a pixel, {} thread{}; {} primitives. Behind the seconds: nodes or cells entered, and blocks of "
        "up to\neight primitives tested, by a ray that looks for the closest hit ({} camera rays, {} towards the lights, {} "
        "off mirrors).\n",
        a.scene.substr(a.scene.find_last_of('/') + 1), a.width, a.height, a.spp, a.threads, a.threads == 1 ? "" : "s",
        scene->geometry->bounded_count(), rays.camera.size(), rays.shadow.size(), rays.mirrored.size());
    if (a.grid_spp != a.spp) fmt::print("~: rendered with {} samples a pixel and scaled up.\n", a.grid_spp);
    fmt::print(
        "\n| accelerator | build, ms | seconds | Mrays/s | camera | to lights | off mirrors |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n");
    print_row<UniformGrid>(scene, rays, AcceleratorKind::grid, a.grid_spp, a);
    print_row<Bvh>(scene, rays, AcceleratorKind::bvh, a.spp, a);
}

}  // namespace

int main(int argc, char** argv) {
    Arguments a;
    CLI::App app("Why one accelerator renders a scene faster than another");
    app.add_option("scene", a.scene, "the paper's dragon, for example")->required();
    app.add_option("--spp", a.spp, "samples a pixel (64)")->check(CLI::Range(1, 65536));
    CLI::Option* grid = app.add_option("--grid-spp", a.grid_spp, "fewer for the grid: its seconds are then scaled up");
    grid->check(CLI::Range(1, 65536));
    app.add_option("--threads", a.threads, "1, as in the paper")->check(CLI::Range(1, 256));
    app.add_option("--width", a.width, "800")->check(CLI::Range(1, 8192));
    app.add_option("--height", a.height, "600")->check(CLI::Range(1, 8192));
    CLI11_PARSE(app, argc, argv);
    if (grid->count() == 0) a.grid_spp = a.spp;
    try {
        run(a);
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
