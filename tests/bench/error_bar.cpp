// How far the renderer's own estimate of its error is from the truth, and its predictions from what came: error_bar --help.
// Each scene is rendered with many seeds and doubled up to the end; the truth comes from another sampler and far more samples.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/accelerator_cache.h"
#include "core/error_metrics.h"
#include "core/renderer.h"
#include "core/scene_io.h"

namespace glint::bench {
namespace {

struct Setup {
    std::vector<std::string> scenes{
        "builtin:balls,level=2", "builtin:mount,level=4", "builtin:balls_box",       "builtin:dof",         "builtin:cornell",
        "builtin:glass",         "builtin:knot,n=10000",  "builtin:stadium,n=10000", "builtin:soup,n=1000", "builtin:crowd,n=20"};
    std::vector<std::string> samplers{"sobol", "joint", "jittered", "random"};
    int width = 128, height = 96, seeds = 8, most = 256, threads = 2, truth = 16;
    bool adaptive = false;
};

Frame frame_of(const std::shared_ptr<const Scene>& scene, const std::shared_ptr<const AnyAccelerator>& accelerator,
               const Setup& setup, SamplerKind sampler, std::uint64_t seed) {
    Frame frame;
    frame.scene = scene;
    frame.accelerator = accelerator;
    frame.camera = scene->cameras.front();
    frame.settings.features = features_of(*scene);
    frame.settings.sampler = sampler;
    frame.settings.seed = seed;
    frame.settings.adaptive = setup.adaptive;
    frame.width = setup.width;
    frame.height = setup.height;
    frame.spp = 1;
    return frame;
}

// What one seed gave at 2^k samples.
struct Run {
    std::vector<ErrorEstimate> estimate;
    std::vector<double> error;
};

Run run_seed(Renderer& renderer, Frame frame, const Setup& setup, const Image& truth) {
    Run run;
    const std::uint64_t generation = renderer.restart(std::move(frame));
    for (int spp = 1; spp <= setup.most; spp *= 2) {
        renderer.extend(generation, spp);
        renderer.wait(1e9, nullptr);
        Image image;
        renderer.resolve(image);
        run.estimate.push_back(renderer.error());
        run.error.push_back(std::sqrt(error_metrics(image, truth).relmse));
    }
    return run;
}

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

// Samples at which log-log interpolation of the true errors crosses the target.
double samples_reaching(const std::vector<double>& error, double target) {
    for (std::size_t k = 1; k < error.size(); ++k) {
        if (error[k] > target || !(error[k - 1] > target)) continue;
        const double part = std::log(error[k - 1] / target) / std::log(error[k - 1] / error[k]);
        return std::exp2(static_cast<double>(k - 1) + part);
    }
    return std::nan("");
}

struct Totals {
    std::vector<double> ratio, predicted;
    std::size_t covered = 0, intervals = 0;
};

void print_row(const std::string& scene, const std::string& sampler, const std::vector<Run>& runs, Totals& totals) {
    fmt::print("{:<24} {:<8}", scene, sampler);
    const std::size_t columns = runs.front().error.size();
    // The expected error is what the estimate is of: the root of the mean over seeds.
    std::vector<double> expected(columns);
    for (std::size_t k = 0; k < columns; ++k) {
        for (const Run& r : runs) expected[k] += r.error[k] * r.error[k] / static_cast<double>(runs.size());
        expected[k] = std::sqrt(expected[k]);
    }
    for (std::size_t k = 2; k < columns; ++k) {
        std::vector<double> ratio;
        std::size_t covered = 0;
        for (const Run& r : runs) {
            ratio.push_back(r.estimate[k].relrmse / expected[k]);
            if (r.estimate[k].low <= r.error[k] && r.error[k] <= r.estimate[k].high) ++covered;
        }
        fmt::print(" {:5.2f} {:3.0f}%", median(ratio), 100.0 * static_cast<double>(covered) / static_cast<double>(runs.size()));
        if (k < 4) continue;
        totals.ratio.insert(totals.ratio.end(), ratio.begin(), ratio.end());
        totals.covered += covered;
        totals.intervals += runs.size();
    }
    // From a quarter of the samples: how many are needed for the error that the last doubling has?
    const std::size_t from = columns - 3;
    std::vector<double> predicted;
    for (const Run& r : runs) {
        const double target = expected[columns - 1] * 1.0001;
        const double spp =
            std::exp2(static_cast<double>(from)) * times_until(r.estimate[from], target / r.estimate[from].relrmse);
        predicted.push_back(spp / samples_reaching(expected, target));
    }
    // Within its first block of strata jittered knows only bounds.
    const bool bound_only = sampler == "jittered" && from <= 6;
    fmt::print("  {}\n", bound_only ? std::string("    -") : fmt::format("{:5.2f}", median(predicted)));
    if (!bound_only) totals.predicted.push_back(median(predicted));
}

void measure(const Setup& setup) {
    Totals totals;
    fmt::print(
        "{}x{}, {} seeds; estimate/true (median) and how often the 95 % interval holds the true error, by samples a pixel;\n"
        "last column: samples predicted for the last error, from a quarter of them, over samples needed\n\n{:<33}",
        setup.width, setup.height, setup.seeds, "");
    for (int spp = 4; spp <= setup.most; spp *= 2) fmt::print(" {:>10}", spp);
    fmt::print("  predicted\n");
    for (const std::string& spec : setup.scenes) {
        const auto scene = load_scene(spec);
        const std::shared_ptr<const AnyAccelerator> accelerator = build_accelerator(AcceleratorKind::bvh, scene->geometry);
        Renderer renderer(setup.threads, false);
        Image truth;
        Frame frame = frame_of(scene, accelerator, setup, SamplerKind::joint, 0x7275746874);
        frame.spp = setup.truth * setup.most;
        frame.settings.adaptive = false;
        renderer.restart(frame);
        renderer.wait(1e9, nullptr);
        renderer.resolve(truth);
        for (const std::string& sampler : setup.samplers) {
            const auto kind =
                static_cast<SamplerKind>(std::find(kSamplerNames.begin(), kSamplerNames.end(), sampler) - kSamplerNames.begin());
            std::vector<Run> runs;
            for (int seed = 1; seed <= setup.seeds; ++seed)
                runs.push_back(run_seed(renderer, frame_of(scene, accelerator, setup, kind, static_cast<std::uint64_t>(seed)),
                                        setup, truth));
            print_row(spec, sampler, runs, totals);
            std::fflush(stdout);
        }
    }
    std::sort(totals.ratio.begin(), totals.ratio.end());
    std::sort(totals.predicted.begin(), totals.predicted.end());
    const auto at = [](const std::vector<double>& v, double q) {
        return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
    };
    fmt::print(
        "\nfrom 16 samples on: estimate/true {:.2f} in the median, 5 % below {:.2f}, 5 % above {:.2f}; the interval holds {:.1f} "
        "%\n"
        "predicted/needed samples: {:.2f} in the median, {:.2f} to {:.2f}\n",
        at(totals.ratio, 0.5), at(totals.ratio, 0.05), at(totals.ratio, 0.95),
        100.0 * static_cast<double>(totals.covered) / static_cast<double>(totals.intervals), at(totals.predicted, 0.5),
        totals.predicted.front(), totals.predicted.back());
}

}  // namespace
}  // namespace glint::bench

int main(int argc, char** argv) {
    glint::bench::Setup setup;
    CLI::App app{"Estimated against true errors."};
    app.add_option("scenes", setup.scenes, "scenes");
    app.add_option("--samplers", setup.samplers, "samplers")->delimiter(',');
    app.add_option("--width", setup.width);
    app.add_option("--height", setup.height);
    app.add_option("--seeds", setup.seeds);
    app.add_option("--spp", setup.most, "most samples a pixel, a power of two");
    app.add_option("--truth", setup.truth, "times as many samples for the truth");
    app.add_flag("--adaptive", setup.adaptive, "samples are the mean over pixels");
    app.add_option("--threads", setup.threads);
    CLI11_PARSE(app, argc, argv);
    glint::bench::measure(setup);
}
