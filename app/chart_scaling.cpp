#include "app/chart_scaling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/chart_curves.h"
#include "app/chart_experiments.h"
#include "app/chart_figure.h"
#include "app/chart_statistics.h"
#include "core/scene_io.h"

namespace glint::chart {
namespace {

constexpr std::array<AcceleratorKind, 3> kKinds{AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh};
std::string name_of(AcceleratorKind kind) { return std::string(kAcceleratorNames[static_cast<std::size_t>(kind)]); }

Subject subject_of(const std::string& spec, int width, int height) {
    Subject s;
    s.spec = spec;
    s.scene = load_scene(spec);
    s.settings.features = features_of(*s.scene);
    s.width = width;
    s.height = height;
    return s;
}

// What building and asking costs on one scene.
struct Cost {
    double build = 0.0, build_mad = 0.0, ray = 0.0, ray_mad = 0.0;  // seconds
    bool extrapolated = false;
};

// Brute force costs a ray as many tests as there are primitives: beyond this many it is scaled up from the count before.
constexpr int kMostForNone = 1 << 14;

std::array<Cost, 3> costs_of(const Machine& machine, const std::string& spec, int n, const std::array<Cost, 3>& before,
                             int rounds) {
    const Subject subject = subject_of(spec, 64, 64);
    Bench bench(subject, machine.threads, machine.stop);
    std::array<Cost, 3> cost;
    std::array<std::vector<double>, 3> ray;
    // The first round warms up.
    for (int round = 0; round <= rounds; ++round) {
        for (std::size_t k = 0; k < kKinds.size(); ++k) {
            if (kKinds[k] == AcceleratorKind::none && n > kMostForNone) continue;
            // Enough rays to be timed, few enough for brute force.
            const bool slow = kKinds[k] == AcceleratorKind::none && n > 256;
            const Shot shot = bench.take(subject.settings, slow ? 1 : 16, kKinds[k], slow ? 16 : 0);
            if (round > 0) ray[k].push_back(shot.seconds / static_cast<double>(shot.rays.total()));
        }
    }
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
        cost[k].build = bench.build_seconds(kKinds[k]);
        cost[k].ray = median(ray[k]);
        cost[k].ray_mad = median_deviation(ray[k]);
        if (!ray[k].empty()) continue;
        cost[k] = before[k];
        cost[k].ray *= 4.0;
        cost[k].extrapolated = true;
    }
    return cost;
}

double total(const Cost& c, double rays) { return c.build + rays * c.ray; }

void chart_break_even(const Machine& machine, const std::string& scene, const std::string& what, int least, int most,
                      Section& section, Meter& meter) {
    WinnerMap map;
    map.id = fmt::format("breakeven-{}", scene);
    map.title = fmt::format("builtin:{}: {}", scene, what);
    map.x = {"primitives", true};
    map.y = {"rays, of all kinds", true};
    map.command = fmt::format(
        "glint render builtin:{},n=N -o out.pfm --resolution 64x64 --spp 16 --accel none|grid|bvh --stats json", scene);
    for (const AcceleratorKind kind : kKinds) map.candidates.push_back(name_of(kind));
    for (int k = 0; k <= 12; ++k) map.ys.push_back(std::pow(10.0, 0.5 * k));
    Figure figure;
    figure.id = fmt::format("costs-{}", scene);
    figure.title = fmt::format("builtin:{}: what a ray and a build cost", scene);
    figure.x = {"primitives", true};
    figure.y = {"seconds", true};
    figure.extra = {"mad", "extrapolated"};
    for (const AcceleratorKind kind : kKinds) {
        figure.series.push_back({name_of(kind) + ", 10⁶ rays", "", "", static_cast<int>(kind), Series::Look::curve, {}});
        if (kind != AcceleratorKind::none)
            figure.series.push_back({name_of(kind) + ", build", "", "", static_cast<int>(kind) + 4, Series::Look::curve, {}});
    }
    std::vector<std::array<Cost, 3>> costs;
    for (int n = least; n <= most; n *= 4) {
        meter.say(fmt::format("break-even: builtin:{},n={}", scene, n));
        costs.push_back(costs_of(machine, fmt::format("builtin:{},n={}", scene, n), n,
                                 costs.empty() ? std::array<Cost, 3>{} : costs.back(), machine.quick ? 3 : 5));
        map.xs.push_back(n);
        std::size_t series = 0;
        for (std::size_t k = 0; k < kKinds.size(); ++k) {
            const Cost& c = costs.back()[k];
            figure.series[series++].points.push_back({static_cast<double>(n),
                                                      1.0e6 * c.ray,
                                                      Point{}.low,
                                                      Point{}.high,
                                                      {1.0e6 * c.ray_mad, c.extrapolated ? 1.0 : 0.0}});
            if (kKinds[k] == AcceleratorKind::none) continue;
            figure.series[series++].points.push_back(
                {static_cast<double>(n), c.build, Point{}.low, Point{}.high, {c.build_mad, 0.0}});
        }
        meter.did(2.0 + 2.0e-6 * n);
    }
    for (const double rays : map.ys) {
        for (const auto& c : costs) {
            std::array<double, 3> t{};
            for (std::size_t k = 0; k < t.size(); ++k) t[k] = total(c[k], rays);
            const auto best = static_cast<std::size_t>(std::ranges::min_element(t) - t.begin());
            map.winner.push_back(best);
            std::ranges::sort(t);
            map.margin.push_back(t[1] / t[0]);
        }
    }
    // R* = build / (cost of a ray without - with): where the tree has paid for itself.
    const auto pays_at = [&](std::size_t i) {
        const double gain = costs[i][0].ray - costs[i][2].ray;
        return gain > 0.0 ? costs[i][2].build / gain : std::numeric_limits<double>::infinity();
    };
    const std::size_t middle = costs.size() / 2, last = costs.size() - 1;
    map.caption = fmt::format(
        "A place is coloured by who builds and traces that many rays first ({} thread{}). The bvh has paid for itself after {} "
        "rays with {} "
        "primitives and after {} with {}.",
        machine.threads, machine.threads == 1 ? "" : "s", short_number(pays_at(middle)), short_number(map.xs[middle]),
        short_number(pays_at(last)), short_number(map.xs[last]));
    figure.caption = fmt::format(
        "With {} primitives a million rays take {} without an accelerator{}, {} with the grid and {} with the bvh; building "
        "takes {} and {}. Rays hold their shading.",
        short_number(map.xs[last]), seconds_text(1.0e6 * costs[last][0].ray),
        costs[last][0].extrapolated ? " (scaled up from 16384)" : "", seconds_text(1.0e6 * costs[last][1].ray),
        seconds_text(1.0e6 * costs[last][2].ray), seconds_text(costs[last][1].build), seconds_text(costs[last][2].build));
    figure.series.front().command = map.command;
    section.maps.push_back(std::move(map));
    section.figures.push_back(std::move(figure));
}

struct PaperRow {
    const char *name, *spec, *figures;
};
// The paper's own seconds: none / grid / bvh on one thread of a 2021 laptop.
constexpr std::array<PaperRow, 6> kPaper{{{"balls_low", "builtin:balls,level=1", "0.46 / 0.60 / 0.56"},
                                          {"balls_high", "builtin:balls,level=4", "96.07 / 2.08 / 2.46"},
                                          {"balls_box", "builtin:balls_box", "0.90 / 0.52 / 0.42"},
                                          {"dof", "builtin:dof", "0.36 / 0.48 / 0.39"},
                                          {"mount_low", "builtin:mount,level=1", "0.39 / 0.50 / 0.44"},
                                          {"mount_high", "builtin:mount,level=5", "27.11 / 0.76 / 0.95"}}};

void chart_paper(const Machine& machine, Section& section, Meter& meter) {
    Table table{"paper",
                "The paper's table, with built-in scenes",
                "512x512, one centred sample, one shadow ray to a random point of each light's square, three bounces, one "
                "thread; medians, build "
                "included. ~: scaled up from a strip of the picture by the number of rays. The paper: none / grid / bvh on one "
                "thread of a 2021 "
                "laptop, where no accelerator won on three of its seven scenes and the bvh was 2.4 times as slow as the grid on "
                "the dragon.",
                {"scene", "primitives", "none", "grid", "bvh", "first", "the paper"},
                {}};
    for (const PaperRow& row : kPaper) {
        meter.say(fmt::format("the paper's table: {}", row.name));
        Subject subject = subject_of(row.spec, 512, 512);
        subject.settings.features = FeatureSet::whitted();
        subject.settings.features.set(Feature::soft, true);
        subject.settings.depth = 3;
        subject.settings.light_size = 0.05f;
        subject.settings.background = Background::color;
        Bench bench(subject, 1, machine.stop);
        const std::size_t primitives = subject.scene->geometry->seen_count() + subject.scene->geometry->planes.size();
        const bool strip = primitives > 500;
        std::array<std::vector<double>, 3> seconds;
        double rays = 0.0;
        for (int round = 0; round < (machine.quick ? 2 : 6); ++round) {
            for (std::size_t k = kKinds.size(); k-- > 0;) {
                const bool part = strip && kKinds[k] == AcceleratorKind::none;
                const Shot shot = bench.take(subject.settings, 1, kKinds[k], part ? 8 : 0);
                const auto cast = static_cast<double>(shot.rays.total());
                if (!part) rays = cast;
                if (round > 0) seconds[k].push_back(shot.seconds * (part ? rays / cast : 1.0));
            }
        }
        std::array<double, 3> t{};
        for (std::size_t k = 0; k < t.size(); ++k) t[k] = median(seconds[k]) + bench.build_seconds(kKinds[k]);
        const auto best = static_cast<std::size_t>(std::ranges::min_element(t) - t.begin());
        table.rows.push_back({row.name, std::to_string(primitives), fmt::format("{}{:.3f}", strip ? "~" : "", t[0]),
                              fmt::format("{:.3f}", t[1]), fmt::format("{:.3f}", t[2]), name_of(kKinds[best]), row.figures});
        meter.did(2.0);
    }
    section.tables.push_back(std::move(table));
}

}  // namespace

double planned_scaling_seconds(const Machine& machine) {
    double seconds = 2.0 * static_cast<double>(kPaper.size());
    for (int n = 1; n <= (machine.quick ? 1 << 16 : 1 << 20); n *= 4) seconds += 2.0 + 2.0e-6 * n;
    return machine.quick ? seconds : seconds * 1.5;
}

void chart_threads(const Machine& machine, const Subject& subject, Section& section, Meter& meter) {
    meter.say("threads");
    Figure f;
    f.id = "threads";
    f.title = fmt::format("{}: threads", subject.spec);
    f.x = {"threads", true};
    f.y = {"times as fast as one", false};
    f.extra = {"seconds", "seconds_mad"};
    std::vector<int> counts;
    for (int n = 1; n < machine.threads; n *= 2) counts.push_back(n);
    counts.push_back(machine.threads);
    const int spp = std::max(4, std::min(64, subject.most_spp));
    std::vector<std::vector<double>> seconds(counts.size());
    std::vector<std::unique_ptr<Bench>> benches;
    for (const int n : counts) benches.push_back(std::make_unique<Bench>(subject, n, machine.stop));
    for (int round = 0; round <= 5; ++round) {
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const Shot shot = benches[i]->take(subject.settings, spp);
            if (round > 0) seconds[i].push_back(shot.seconds);
        }
    }
    Series measured{"measured", "", render_command(subject, subject.settings, spp, "--threads N"), 0, Series::Look::curve, {}};
    Series ideal{"ideal", "", "", 7, Series::Look::front, {}};
    const double one = median(seconds.front());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const double t = median(seconds[i]);
        measured.points.push_back(
            {static_cast<double>(counts[i]), one / t, Point{}.low, Point{}.high, {t, median_deviation(seconds[i])}});
        ideal.points.push_back({static_cast<double>(counts[i]), static_cast<double>(counts[i]), Point{}.low, Point{}.high, {}});
    }
    ideal.look = Series::Look::curve;
    f.caption =
        fmt::format("{} samples take {} on one thread and {} on {}: {:.2f} times as fast. The picture is the same to the byte.",
                    spp, seconds_text(one), seconds_text(median(seconds.back())), counts.back(), one / median(seconds.back()));
    f.series = {std::move(measured), std::move(ideal)};
    section.text = "Where building an accelerator pays, and what threads add.";
    section.figures.push_back(std::move(f));
}

void chart_machine(const Machine& machine, Section& section, Meter& meter) {
    chart_break_even(machine, "soup", "triangles of any place and size", 1, machine.quick ? 1 << 16 : 1 << 20, section, meter);
    chart_break_even(machine, "knot", "one closed mesh", 10000, machine.quick ? 160000 : 2560000, section, meter);
    chart_paper(machine, section, meter);
}

}  // namespace glint::chart
