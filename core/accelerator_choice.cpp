#include "core/accelerator_choice.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {
namespace {

// Nanoseconds of one thread, rounded from what `tests/bench/regret --calibrate` fitted on Zen 4 (AVX-512); ratios matter alone.
// A ray's figures hold a mean share of shading.
struct Costs {
    double build, build_triangle, build_other;       // once, and for each primitive by kind
    double ray, doubling_triangles, doubling_other;  // for each ray, and for each doubling of the blocks of eight
    double serial;                                   // the part of the primitives' building that threads do not share
};
// In the order of kAcceleratorChoices, from the grid on.
constexpr std::array<Costs, kAcceleratorChoices.size() - 1> kCosts{{{25.0e3, 650.0, 420.0, 95.0, 15.0, 15.0, 0.05},
                                                                    {14.0e3, 235.0, 210.0, 45.0, 4.5, 5.0, 0.09},
                                                                    {22.0e3, 110.0, 155.0, 45.0, 4.8, 5.55, 0.05}}};
// Of the loop: a ray, and a test by kind of primitive (triangle, sphere, box, cone).
constexpr double kLoopRay = 85.0;
constexpr std::array<double, 4> kLoopTest{9.5, 4.0, 5.0, 20.0};

// Primitives as the model counts them.
struct Counts {
    double triangles = 0.0, other = 0.0;

    void add(const Geometry& geometry, double times = 1.0) {
        const auto n = static_cast<double>(geometry.triangles.size());
        triangles += times * n;
        other += times * (static_cast<double>(geometry.bounded_count()) - n);
    }
};

double seconds(const Costs& c, const Counts& built, const Counts& seen, const RayDemand& demand) {
    const double n = seen.triangles + seen.other, threads = std::max(1, demand.threads);
    const double building = c.build_triangle * built.triangles + c.build_other * built.other;
    const double doublings =
        std::log2(1.0 + n / 8.0) / std::max(1.0, n) * (c.doubling_triangles * seen.triangles + c.doubling_other * seen.other);
    return 1.0e-9 * (c.build + building * (c.serial + (1.0 - c.serial) / threads) + demand.rays * (c.ray + doublings) / threads);
}

double loop_tests(const Geometry& geometry) {
    double loop = 0.0;
    for (std::size_t kind = 0; kind < kLoopTest.size(); ++kind) {
        loop += kLoopTest[kind] * static_cast<double>(geometry.count(static_cast<PrimitiveKind>(kind)));
    }
    return loop;
}

}  // namespace

RayDemand expected_rays(const Scene& scene, int width, int height, double samples_per_pixel, int threads) {
    // Glass sends two branches on at each of its surfaces; what a mirror reflects is often the sky.
    double branches = 1.0;
    for (const Material& m : scene.materials) branches = std::max(branches, m.glass ? 4.0 : m.has_mirror() ? 1.5 : 1.0);
    const double a_sample = branches * (1.0 + static_cast<double>(scene.lights.size()));
    return {static_cast<double>(width) * height * samples_per_pixel * a_sample, threads};
}

std::array<double, kAcceleratorChoices.size()> estimated_seconds(const Geometry& geometry, const RayDemand& demand) {
    double loop = kLoopRay + loop_tests(geometry);
    Counts built, seen;
    built.add(geometry);
    seen.add(geometry);
    // A mesh is built once, and each of its instances as one box; rays meet them all.
    std::vector<double> uses(geometry.prototypes.size());
    for (const Instance& instance : geometry.instances) ++uses[instance.prototype];
    built.other += static_cast<double>(geometry.instances.size());
    for (std::size_t i = 0; i < uses.size(); ++i) {
        const Geometry& mesh = *geometry.prototypes[i].geometry;
        built.add(mesh);
        seen.add(mesh, uses[i]);
        loop += uses[i] * (kLoopRay + loop_tests(mesh));
    }
    std::array<double, kAcceleratorChoices.size()> estimate{1.0e-9 * demand.rays * loop / std::max(1, demand.threads)};
    for (std::size_t i = 0; i < kCosts.size(); ++i) {
        estimate[i + 1] = seconds(kCosts[i], built, seen, demand);
    }
    return estimate;
}

RayDemand within(const RayDemand& demand, const Geometry& geometry, double seconds) {
    // With a fast tree, which is what a short time gets.
    const RayDemand million{1.0e6, demand.threads}, none{0.0, demand.threads};
    const double a_million = estimated_seconds(geometry, million).back() - estimated_seconds(geometry, none).back();
    return {std::min(demand.rays, 1.0e6 * std::max(0.0, seconds) / a_million), demand.threads};
}

AcceleratorChoice automatic_accelerator(const Scene& scene, const RayDemand& demand) {
    const auto estimate = estimated_seconds(*scene.geometry, demand);
    return kAcceleratorChoices[static_cast<std::size_t>(std::ranges::min_element(estimate) - estimate.begin())];
}

}  // namespace glint
