#include "choice_cost.h"

#include <algorithm>
#include <cmath>

#include <time.h>

#include "core/tile_kernels.h"

namespace glint::bench {
namespace {

// Visits of a tile as the renderer makes them: samples from .. to - 1. Those behind the last cost what it does.
constexpr std::array<std::array<int, 2>, 5> kVisits{{{0, 1}, {1, 2}, {2, 4}, {4, 8}, {8, 16}}};
// Brute force traces about so many primitives times samples a round.
constexpr double kBruteForceTests = 5.0e5;
constexpr int kLeastBruteForcePixels = 16;
constexpr double kLongBuild = 0.5;  // seconds: from here on three rounds are enough

double read_clock(clockid_t id) {
    timespec t{};
    clock_gettime(id, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Stopwatch {
    double cpu = read_clock(CLOCK_THREAD_CPUTIME_ID), wall = read_clock(CLOCK_MONOTONIC);
    [[nodiscard]] Stopwatch lap() const {
        const Stopwatch now;
        Stopwatch passed;
        passed.cpu = now.cpu - cpu;
        passed.wall = now.wall - wall;
        return passed;
    }
};

// A build on this thread; `shared` sums what runs inside loops.
std::shared_ptr<const AnyAccelerator> build(const AcceleratorChoice& choice, const Scene& scene, double& shared) {
    const auto timed_for = [&shared](std::size_t count, const std::function<void(std::size_t)>& task) {
        const Stopwatch watch;
        serial_for(count, task);
        if (count > 1) shared += watch.lap().cpu;
    };
    return build_accelerator(choice.kind, scene.geometry, timed_for, choice.quality);
}

struct Picture {
    const Scene& scene;
    RenderPlan plan;
    Camera camera;
    Demand demand;
    std::vector<TileRect> tiles;  // those that are traced
    double scale = 1.0;           // from their samples of a visit to the picture's

    Picture(const Scene& s, const Demand& d, double samples) : scene(s), demand(d) {
        RenderSettings settings;
        settings.features = features_of(s);
        plan = plan_render(s, settings, s.cameras.front());
        camera = Camera(plan.camera, d.width, d.height);
        const double measured = std::min(16, d.spp);
        const double pixels = std::max(1.0, std::min(1.0, samples / (measured * d.width * d.height)) * d.width * d.height);
        const int columns = (d.width + kTileSize - 1) / kTileSize, rows = (d.height + kTileSize - 1) / kTileSize;
        const int all = columns * rows, count = std::clamp(static_cast<int>(std::ceil(pixels / 256.0)), 1, all);
        double area = 0.0;
        for (int k = 0; k < count; ++k) {
            // A step that shares no factor with the columns would be better still; halves of a tile keep it off them.
            const int t = static_cast<int>((k + 0.5) * all / count), x = t % columns * kTileSize, y = t / columns * kTileSize;
            tiles.push_back({x, y, std::min(x + kTileSize, d.width), std::min(y + kTileSize, d.height)});
            area += static_cast<double>(tiles.back().pixels());
        }
        scale = d.width * static_cast<double>(d.height) / area;
    }
};

struct Traced {
    double cpu = 0.0, wall = 0.0, rays = 0.0;
};

// All tiles; samples beyond the measured visits at the price of the last.
Traced trace(const Picture& picture, const AnyAccelerator& accelerator, Workspace& workspace) {
    const std::atomic<std::uint64_t> generation{1};
    const KernelInput input{picture.scene, accelerator, picture.plan, picture.camera, generation, 1};
    Traced total;
    std::vector<PixelSum> sums;
    const int spp = picture.plan.stochastic() ? picture.demand.spp : 1;
    for (const TileRect& tile : picture.tiles) {
        sums.assign(tile.pixels(), {});
        for (const auto& [first, visit_end] : kVisits) {
            if (first >= spp) break;
            const int last = std::min(visit_end, spp);
            workspace.counts = RayCounts();
            const Stopwatch watch;
            (void)render_tile(input, tile, first, last, sums, workspace);
            const Stopwatch passed = watch.lap();
            const double more = last == kVisits.back()[1] ? 1.0 + static_cast<double>(spp - last) / (last - first) : 1.0;
            total.cpu += more * passed.cpu;
            total.wall += more * passed.wall;
            total.rays += more * static_cast<double>(workspace.counts.total());
        }
    }
    return {total.cpu * picture.scale, total.wall * picture.scale, total.rays * picture.scale};
}

// Every ray of brute force costs about alike, so a few pixels say what the picture's rays cost.
Traced trace_some(const Picture& picture, const AnyAccelerator& accelerator, Workspace& workspace, double rays) {
    const double primitives = static_cast<double>(picture.scene.geometry->bounded_count());
    const double pixels = std::max<double>(kLeastBruteForcePixels, kBruteForceTests / primitives);
    const int side = std::clamp(static_cast<int>(std::sqrt(pixels)), 4, kTileSize);
    Picture few = picture;
    few.demand.spp = 1;
    few.tiles.clear();
    // Pixels around the middle of the picture, where there is something to see, in as many tiles as may be.
    const int tiles = std::clamp(static_cast<int>(pixels / (side * side)), 1, static_cast<int>(picture.tiles.size()));
    for (int k = 0; k < tiles; ++k) {
        const TileRect& t =
            picture.tiles[static_cast<std::size_t>((k + 0.5) * static_cast<double>(picture.tiles.size()) / tiles)];
        few.tiles.push_back({t.x0, t.y0, std::min(t.x1, t.x0 + side), std::min(t.y1, t.y0 + side)});
    }
    const Traced seen = trace(few, accelerator, workspace);
    const double scale = rays / seen.rays;
    return {seen.cpu * scale, seen.wall * scale, rays};
}

}  // namespace

std::vector<DemandCost> measure_demands(const std::shared_ptr<const Scene>& scene, const std::vector<Demand>& demands,
                                        const Effort& effort) {
    std::vector<Picture> pictures;
    std::vector<DemandCost> costs;
    for (const Demand& d : demands) {
        pictures.emplace_back(*scene, d, effort.samples);
        costs.push_back({.demand = d, .by = {}});
        costs.back().sampled = 1.0 / pictures.back().scale * std::min(1.0, 16.0 / d.spp);
    }
    constexpr std::size_t kCount = kAcceleratorChoices.size();
    const bool heavy = static_cast<double>(scene->geometry->bounded_count()) > 100.0;
    auto workspace = std::make_unique<Workspace>();
    int rounds = effort.rounds;
    for (int round = 0; round < rounds; ++round) {
        // The order rotates, so that nobody always follows the same neighbour. Brute force of a heavy scene comes last,
        // because it needs the number of rays.
        for (std::size_t k = 0; k < kCount; ++k) {
            const std::size_t c = (k + static_cast<std::size_t>(round)) % kCount;
            double shared = 0.0;
            const Stopwatch watch;
            const auto accelerator = build(kAcceleratorChoices[c], *scene, shared);
            const Stopwatch built = watch.lap();
            if (built.cpu > kLongBuild) rounds = std::min(rounds, 3);
            for (std::size_t i = 0; i < pictures.size(); ++i) {
                const bool some = heavy && kAcceleratorChoices[c].kind == AcceleratorKind::none;
                if (some && costs[i].rays == 0.0) {
                    const Bvh bvh(scene->geometry);
                    workspace->prepared_for = 0;
                    costs[i].rays = trace(pictures[i], AnyAccelerator(bvh), *workspace).rays;
                }
                workspace->prepared_for = 0;
                const Traced t = some ? trace_some(pictures[i], *accelerator, *workspace, costs[i].rays)
                                      : trace(pictures[i], *accelerator, *workspace);
                costs[i].rays = t.rays;
                costs[i].brute_force_sampled = costs[i].brute_force_sampled || some;
                CandidateCost& cost = costs[i].by[c];
                cost.build.push_back(built.cpu);
                cost.trace.push_back(t.cpu);
                cost.wall.push_back(built.wall + t.wall);
                cost.build_serial = built.cpu - shared;
            }
        }
    }
    return costs;
}

}  // namespace glint::bench
