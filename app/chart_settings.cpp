// Approximations: the list of them, what each does to bias, noise and time, and the front of all.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/chart_experiments.h"
#include "app/chart_figure.h"
#include "core/render_plan.h"

namespace glint::chart {
namespace {

// Where a setting can make a difference.
enum class Acts { always, glass, branches, area_light };

struct Knob {
    const char* name;
    Acts acts;
    void (*turn)(RenderSettings&);
};

// One line each; the first is what all others differ from by one thing.
const Knob kKnobs[] = {
    {"as it comes", Acts::always, [](RenderSettings&) {}},
    {"joint", Acts::always, [](RenderSettings& s) { s.sampler = SamplerKind::joint; }},
    {"jittered", Acts::always, [](RenderSettings& s) { s.sampler = SamplerKind::jittered; }},
    {"schlick", Acts::glass, [](RenderSettings& s) { s.fresnel = Fresnel::schlick; }},
    {"one glass branch", Acts::glass, [](RenderSettings& s) { s.glass = GlassBranches::one; }},
    {"depth 1", Acts::branches, [](RenderSettings& s) { s.depth = 1; }},
    {"depth 2", Acts::branches, [](RenderSettings& s) { s.depth = 2; }},
    {"depth 3", Acts::branches, [](RenderSettings& s) { s.depth = 3; }},
    {"depth 4", Acts::branches, [](RenderSettings& s) { s.depth = 4; }},
    {"depth 6", Acts::branches, [](RenderSettings& s) { s.depth = 6; }},
    {"cut-off 0.1", Acts::branches, [](RenderSettings& s) { s.cutoff = 0.1f; }},
    {"cut-off 0.03", Acts::branches, [](RenderSettings& s) { s.cutoff = 0.03f; }},
    {"cut-off 0.01", Acts::branches, [](RenderSettings& s) { s.cutoff = 0.01f; }},
    {"cut-off 0.002", Acts::branches, [](RenderSettings& s) { s.cutoff = 0.002f; }},
    {"2 light samples", Acts::area_light, [](RenderSettings& s) { s.light_samples = 2; }},
    {"4 light samples", Acts::area_light, [](RenderSettings& s) { s.light_samples = 4; }},
    {"8 light samples", Acts::area_light, [](RenderSettings& s) { s.light_samples = 8; }},
};

bool can_act_here(const Subject& subject, Acts acts) {
    const RenderPlan plan = plan_render(*subject.scene, subject.settings, subject.scene->cameras.front());
    switch (acts) {
        case Acts::always: return true;
        case Acts::glass: return plan.has(kernel_part::glass);
        case Acts::branches: return plan.has(kernel_part::glass) || plan.has(kernel_part::mirror);
        case Acts::area_light: return plan.has(kernel_part::soft);
    }
    return false;
}

std::vector<Variant> variants_of(const Bench& bench, const References* r, const Effort& effort) {
    std::vector<Variant> list;
    const Subject& subject = bench.subject();
    for (const Knob& knob : kKnobs) {
        if (!can_act_here(subject, knob.acts)) continue;
        RenderSettings s = subject.settings;
        knob.turn(s);
        const bool jittered = s.sampler == SamplerKind::jittered;
        // Jittered pictures would share their family with the deep reference; where depth cannot matter the other one serves.
        const Reference* judge = r == nullptr ? nullptr : &r->deep;
        if (jittered && judge != nullptr && !can_act_here(subject, Acts::branches)) judge = &r->sobol;
        list.push_back({knob.name, s, bench.automatic(), powers(4, std::min(effort.settings_most, subject.most_spp)), judge});
    }
    return list;
}

// All of a setting's points against the front of everything: the least factor by which its error exceeds the front's at equal
// time, without its own points. Below 1 it stands on the front.
double excess(const std::vector<Curve>& curves, std::size_t which) {
    std::vector<XY> others;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        if (i == which) continue;
        for (const XY& p : curves[i].error_over_seconds()) others.push_back(p);
    }
    double least = std::numeric_limits<double>::infinity();
    for (const XY& p : curves[which].error_over_seconds()) {
        const double front = front_at(others, p.x);
        least = std::min(least, std::isfinite(front) && front > 0.0 ? p.y / front : 0.0);
    }
    return least;
}

// Timings scatter by a few per cent, so what exceeds the front by less than this is not called dominated.
constexpr double kTie = 1.05;

Figure split_figure(const Stage& stage, const std::vector<Curve>& curves) {
    Figure f;
    f.id = fmt::format("bias-{}", stage.subject().file_name());
    f.title = fmt::format("{}: bias and noise at {} samples", stage.subject().spec, curves.front().points.back().spp);
    f.x.label = "seconds, build included";
    f.y.label = "variance or squared bias, relative";
    f.extra = {"spp", "bias2", "bias2_noise", "variance", "relmse"};
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& c = curves[i];
        const Measured& m = c.points.back();
        const double bias2 = c.split->bias2(), noise = c.split->bias2_noise();
        const std::vector<double> extra{static_cast<double>(m.spp), bias2, noise, c.split->variance(), m.error.middle};
        const int colour = static_cast<int>(i);
        const bool seen = bias2 > noise;
        Series s{c.name, seen ? "biased" : "", render_command(stage.subject(), c.settings, m.spp),
                 colour, Series::Look::dots,   {}};
        s.points.push_back({m.total(c.build), c.split->variance(), Point{}.low, Point{}.high, extra});
        // A stalk from the noise to the bias, where there is one.
        if (seen) {
            s.look = Series::Look::curve;
            s.points.push_back({m.total(c.build), bias2, Point{}.low, Point{}.high, extra});
        }
        f.series.push_back(std::move(s));
    }
    return f;
}

Figure front_figure(const Stage& stage, const std::vector<Curve>& curves) {
    Figure f = error_figure(stage, "front", curves, false);
    f.title = fmt::format("{}: all settings, and the front", stage.subject().spec);
    f.levels.clear();
    std::vector<XY> all;
    for (const Curve& c : curves) {
        for (const XY& p : c.error_over_seconds()) all.push_back(p);
    }
    Series front{"", "", "", 7, Series::Look::front, {}};
    for (const std::size_t i : pareto_front(all)) front.points.push_back({all[i].x, all[i].y, Point{}.low, Point{}.high, {}});
    for (Series& s : f.series) s.look = Series::Look::dots;
    f.series.push_back(std::move(front));
    return f;
}

}  // namespace

std::vector<Figure> chart_settings(const Stage& stage, Table& table) {
    const Subject& subject = stage.subject();
    stage.meter.say(fmt::format("{}: settings", subject.spec));
    const std::vector<Curve> curves = measure_curves(stage.bench, variants_of(stage.bench, &stage.references, stage.effort),
                                                     stage.effort.seeds, true, stage.meter);
    Figure split = split_figure(stage, curves), front = front_figure(stage, curves);
    std::string dominated, on_front, biased;
    const Curve& base = curves.front();
    const double base_seconds = base.points.back().total(base.build);
    const auto add = [](std::string& list, const std::string& word) { list += (list.empty() ? "" : ", ") + word; };
    double worst_bias = 0.0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& c = curves[i];
        const Measured& m = c.points.back();
        const double over = excess(curves, i), bias2 = c.split->bias2(), noise = c.split->bias2_noise();
        const bool seen = bias2 > noise, beaten = over > kTie;
        add(beaten ? dominated : on_front, c.name);
        if (seen && bias2 > worst_bias) worst_bias = bias2, biased = c.name;
        front.series[i].note = beaten ? fmt::format("×{:.2f}", over) : "";
        table.rows.push_back({subject.spec, c.name, fmt::format("{:.2f}", m.total(c.build) / base_seconds),
                              short_number(m.error.middle),
                              seen ? short_number(bias2) : fmt::format("< {}", short_number(std::max(noise, bias2))),
                              short_number(c.split->variance()),
                              beaten       ? fmt::format("no: ×{:.2f} at equal time", over)
                              : over > 1.0 ? "tie"
                                           : "yes"});
    }
    split.caption = fmt::format(
        "From {} seeds: a dot is the variance of one picture, the other end of a stalk the squared bias where it can be told "
        "from chance. {}",
        stage.effort.seeds,
        biased.empty() ? std::string("None of these settings is visibly biased.")
                       : fmt::format("The most biased is {} with {}, as much as {} samples of noise as it comes.", biased,
                                     short_number(worst_bias),
                                     short_number(std::max(1.0, base.split->variance() * base.points.back().spp / worst_bias))));
    front.caption = fmt::format("On the front (or within {:.0f} % of it): {}. {}", 100.0 * (kTie - 1.0), on_front,
                                dominated.empty()
                                    ? std::string("None is dominated.")
                                    : fmt::format("Dominated, with the error beside the front's at equal time: {}.", dominated));
    return {std::move(split), std::move(front)};
}

double planned_settings_seconds(Bench& bench, const Effort& effort) {
    return planned_seconds(bench, variants_of(bench, nullptr, effort), effort.seeds);
}

}  // namespace glint::chart
