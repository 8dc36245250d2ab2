#include "app/chart_experiments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/chart_figure.h"
#include "core/render_plan.h"

namespace glint::chart {
namespace {

constexpr std::array<double, 2> kTargets{1.0e-2, 1.0e-3};

std::vector<Variant> sampler_variants(const Bench& bench, const References* r, const Effort& effort) {
    std::vector<Variant> list;
    // In the order of the figures' legend, the best first.
    for (const SamplerKind kind :
         {SamplerKind::joint, SamplerKind::sobol, SamplerKind::jittered, SamplerKind::regular, SamplerKind::random}) {
        RenderSettings s = bench.subject().settings;
        s.sampler = kind;
        const bool sequence = kind == SamplerKind::joint || kind == SamplerKind::sobol;
        const Reference* judge = r == nullptr ? nullptr : sequence ? &r->jittered : &r->sobol;
        list.push_back({std::string(kSamplerNames[static_cast<std::size_t>(kind)]), s, bench.automatic(),
                        powers(effort.step, bench.subject().most_spp), judge});
    }
    return list;
}

// Brute force that would take longer than this for one picture is left out, and its curve ends.
constexpr double kLongestPicture = 0.5;

std::vector<Variant> accelerator_variants(Bench& bench, const References* r) {
    std::vector<Variant> list;
    const Subject& subject = bench.subject();
    for (const AcceleratorKind kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) {
        Variant v{std::string(kAcceleratorNames[static_cast<std::size_t>(kind)]),
                  subject.settings,
                  kind,
                  {},
                  r ? &r->jittered : nullptr};
        for (int spp = 4; spp <= std::min(64, subject.most_spp); spp *= 4) {
            const RayDemand demand = expected_rays(*subject.scene, subject.width, subject.height, spp, bench.threads());
            const auto estimate = estimated_seconds(*subject.scene->geometry, demand);
            if (kind != AcceleratorKind::none || estimate[static_cast<std::size_t>(kind)] <= kLongestPicture)
                v.spps.push_back(spp);
        }
        if (!v.spps.empty()) list.push_back(v);
    }
    return list;
}

// The scene's own features, taken away and given back one by one.
std::vector<Variant> feature_variants(const Bench& bench, const References* r, const Effort& effort) {
    const Subject& subject = bench.subject();
    std::vector<Variant> list;
    RenderSettings s = subject.settings;
    s.features.bits &= FeatureSet::whitted().bits;
    const Reference* judge = r == nullptr ? nullptr : &r->jittered;
    list.push_back({"whitted", s, bench.automatic(), {1}, judge});
    for (const Feature f : {Feature::aa, Feature::soft, Feature::dof, Feature::fuzzy}) {
        if (!subject.settings.features.has(f) || !can_act(*subject.scene, f)) continue;
        s.features.set(f, true);
        const std::string name = fmt::format("+{}", kFeatureNames[static_cast<std::size_t>(f)]);
        list.push_back({name, s, bench.automatic(), powers(std::max(4, effort.step), subject.most_spp), judge});
    }
    list.back().name += " = all";
    return list;
}

Point point_of(const Curve& c, const Measured& m, bool over_samples) {
    return {over_samples ? m.spp : m.total(c.build),
            m.error.middle,
            m.error.low,
            m.error.high,
            {static_cast<double>(m.spp), m.seconds, m.seconds_mad, c.build, m.rays}};
}

std::string time_to(const Curve& c, double target) {
    const Crossing at = first_below(c.error_over_seconds(), target);
    switch (at.kind) {
        case Crossing::Kind::reached: return seconds_text(at.x);
        case Crossing::Kind::before_first: return fmt::format("≤ {}", seconds_text(at.x));
        case Crossing::Kind::after_last: break;
    }
    return fmt::format("> {}", seconds_text(at.x));
}

const Curve& named(const std::vector<Curve>& curves, std::string_view name) {
    return *std::ranges::find(curves, name, &Curve::name);
}

// The renderer's estimate of its error over the error it has.
Figure error_bar_figure(const Stage& stage, const std::vector<Curve>& curves) {
    Figure f = error_figure(stage, "errorbar", curves, true);
    f.y.label = "estimated over true relRMSE";
    f.levels = {1.0};
    f.extra = {"coverage"};
    double covered = 0.0, points = 0.0;
    std::string last;
    std::vector<Series> told;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        Series s = f.series[i];
        s.points.clear();
        for (const Measured& m : curves[i].points) {
            if (!(m.honesty.middle > 0.0)) continue;
            s.points.push_back({static_cast<double>(m.spp), m.honesty.middle, m.honesty.low, m.honesty.high, {m.coverage}});
            covered += m.coverage;
            points += 1.0;
        }
        if (s.points.empty()) continue;
        last += fmt::format("{}{:.2f} for {}", last.empty() ? "" : ", ", s.points.back().y, s.name);
        told.push_back(std::move(s));
    }
    f.series = std::move(told);
    f.caption = fmt::format(
        "With the most samples the estimate is {} of the true error (1 is right). Its 95 % interval holds the true error in "
        "{:.0f} % of all these pictures.",
        last.empty() ? std::string("nothing") : last, points > 0.0 ? 100.0 * covered / points : 0.0);
    return f;
}

}  // namespace

std::string seconds_text(double s) {
    if (s >= 1.0) return fmt::format("{:.3g} s", s);
    return s >= 1.0e-3 ? fmt::format("{:.3g} ms", s * 1e3) : fmt::format("{:.3g} µs", s * 1e6);
}

Figure error_figure(const Stage& stage, const std::string& what, const std::vector<Curve>& curves, bool over_samples) {
    const Subject& subject = stage.subject();
    Figure f;
    f.id = fmt::format("{}-{}-{}", what, subject.file_name(), over_samples ? "spp" : "seconds");
    f.title = subject.title();
    f.x.label = over_samples ? "samples per pixel" : "seconds, build included";
    f.y.label = "relMSE";
    f.extra = {"spp", "render_seconds", "render_seconds_mad", "build_seconds", "rays"};
    f.levels.assign(kTargets.begin(), kTargets.end());
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& c = curves[i];
        Series s{c.name, "", render_command(subject, c.settings, c.points.back().spp), static_cast<int>(i), Series::Look::curve,
                 {}};
        for (const Measured& m : c.points) s.points.push_back(point_of(c, m, over_samples));
        f.series.push_back(std::move(s));
    }
    return f;
}

std::vector<Figure> chart_samplers(const Stage& stage, Table& targets, std::vector<Figure>& error_bars) {
    const Subject& subject = stage.subject();
    stage.meter.say(fmt::format("{}: samplers", subject.spec));
    const std::vector<Curve> curves = measure_curves(stage.bench, sampler_variants(stage.bench, &stage.references, stage.effort),
                                                     stage.effort.seeds, false, stage.meter);
    Figure seconds = error_figure(stage, "samplers", curves, false), samples = error_figure(stage, "samplers", curves, true);
    const auto last = [](const Curve& c) { return c.points.back().error.middle; };
    const Curve &random = named(curves, "random"), &sobol = named(curves, "sobol"), &jittered = named(curves, "jittered");
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const auto a = curves[i].exponent();
        if (a && curves[i].name != "regular") samples.series[i].note = fmt::format("{:.2f} ± {:.2f}", a->slope, 2.0 * a->error);
        targets.rows.push_back(
            {subject.spec, curves[i].name, time_to(curves[i], kTargets[0]), time_to(curves[i], kTargets[1]),
             short_number(last(curves[i])), seconds_text(curves[i].points.back().total(curves[i].build)),
             a && curves[i].name != "regular" ? fmt::format("{:.2f} ± {:.2f}", a->slope, 2.0 * a->error) : "–"});
    }
    seconds.caption = fmt::format(
        "At {} samples sobol's relMSE is {}, random's {} ({:.1f} times as much), in {} against {}. To relMSE 0.01 sobol takes "
        "{}, jittered {}, "
        "random {}.",
        sobol.points.back().spp, short_number(last(sobol)), short_number(last(random)), last(random) / last(sobol),
        seconds_text(sobol.points.back().total(sobol.build)), seconds_text(random.points.back().total(random.build)),
        time_to(sobol, kTargets[0]), time_to(jittered, kTargets[0]), time_to(random, kTargets[0]));
    const auto exponent = [](const Curve& c) { return c.exponent().value_or(Slope{}).slope; };
    samples.caption = fmt::format(
        "Root relMSE falls as N^-a, a beside the names: {:.2f} for sobol, {:.2f} for jittered and {:.2f} for random. Theory: "
        "0.50 for random "
        "anywhere, about 0.75 for both others where a pixel holds one edge, less with every dimension that has edges of its own.",
        exponent(sobol), exponent(jittered), exponent(random));
    error_bars.push_back(error_bar_figure(stage, curves));
    return {std::move(seconds), std::move(samples)};
}

std::vector<Figure> chart_accelerators(const Stage& stage) {
    const Subject& subject = stage.subject();
    stage.meter.say(fmt::format("{}: accelerators", subject.spec));
    const std::vector<Variant> variants = accelerator_variants(stage.bench, &stage.references);
    // The claim that errors are the same is checked on bytes before anything is timed.
    const Shot oracle = stage.bench.take(subject.settings, 1, variants.front().accelerator);
    bool same = true;
    for (const Variant& v : variants)
        same = same && stage.bench.take(subject.settings, 1, v.accelerator).image.pixels == oracle.image.pixels;
    const std::vector<Curve> curves =
        measure_curves(stage.bench, variants, std::max(5, stage.effort.timings), false, stage.meter);
    Figure f = error_figure(stage, "accelerators", curves, false);
    std::string builds;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        f.series[i].colour = static_cast<int>(std::ranges::find(kAcceleratorNames, curves[i].name) - kAcceleratorNames.begin());
        f.series[i].command =
            render_command(subject, curves[i].settings, curves[i].points.back().spp, fmt::format("--accel {}", curves[i].name));
        if (curves[i].name != "none")
            builds += fmt::format("{}{} {}", builds.empty() ? "" : ", ", curves[i].name, seconds_text(curves[i].build));
    }
    const auto at_first = [&](const char* name) {
        const auto found = std::ranges::find(curves, name, &Curve::name);
        return found == curves.end() ? std::string("too long to be measured")
                                     : seconds_text(found->points.front().total(found->build));
    };
    f.caption = fmt::format(
        "{}, so a curve only moves sideways: {} samples take {} with none, {} with the grid and {} with the bvh, "
        "build "
        "included. Builds alone: {}.",
        same ? "All give the same bytes" : "THE BYTES DIFFER", curves.front().points.front().spp, at_first("none"),
        at_first("grid"), at_first("bvh"), builds);
    return {std::move(f)};
}

std::vector<Figure> chart_features(const Stage& stage) {
    const Subject& subject = stage.subject();
    stage.meter.say(fmt::format("{}: features", subject.spec));
    const std::vector<Curve> curves = measure_curves(stage.bench, feature_variants(stage.bench, &stage.references, stage.effort),
                                                     stage.effort.seeds, false, stage.meter);
    Figure f = error_figure(stage, "features", curves, false);
    f.series.front().look = Series::Look::dots;
    const Measured &first = curves.front().points.back(), &all = curves.back().points.back();
    f.caption = fmt::format(
        "One centred ray with nothing random stays at relMSE {} after {}, however long it goes on; with everything on, {} "
        "samples come to {} in {}.",
        short_number(first.error.middle), seconds_text(first.seconds), all.spp, short_number(all.error.middle),
        seconds_text(all.seconds));
    if (curves.size() > 2) {
        const Measured& before = curves[curves.size() - 2].points.back();
        f.caption += fmt::format(
            " Without the last feature ({}) the error is still {} there: what is left out is bias, which no sample removes.",
            curves.back().name, short_number(before.error.middle));
    }
    return {std::move(f)};
}

double planned_seconds(Bench& bench, const Effort& effort) {
    return planned_seconds(bench, sampler_variants(bench, nullptr, effort), effort.seeds) +
           planned_seconds(bench, accelerator_variants(bench, nullptr), std::max(5, effort.timings)) +
           planned_seconds(bench, feature_variants(bench, nullptr, effort), effort.seeds);
}

}  // namespace glint::chart
