// Approximations: the list of them, what each does to bias, noise and time, and the front of all.
#include <algorithm>
#include <array>
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

// What is drawn in one colour.
enum class Kind { base, sampler, glass, depth, cutoff, light, adaptive };
constexpr std::array<const char*, 7> kKindNames{"as it comes", "sampler",       "glass",   "depth",
                                                "cut-off",     "light samples", "adaptive"};

struct Knob {
    const char* name;
    Kind kind;
    Acts acts;
    void (*turn)(RenderSettings&);
};

// One line each; the first is what all others differ from by one thing.
const Knob kKnobs[] = {
    {"as it comes", Kind::base, Acts::always, [](RenderSettings&) {}},
    {"joint", Kind::sampler, Acts::always, [](RenderSettings& s) { s.sampler = SamplerKind::joint; }},
    {"jittered", Kind::sampler, Acts::always, [](RenderSettings& s) { s.sampler = SamplerKind::jittered; }},
    {"adaptive", Kind::adaptive, Acts::always, [](RenderSettings& s) { s.adaptive = true; }},
    {"joint, adaptive", Kind::adaptive, Acts::always,
     [](RenderSettings& s) { s.sampler = SamplerKind::joint, s.adaptive = true; }},
    {"schlick", Kind::glass, Acts::glass, [](RenderSettings& s) { s.fresnel = Fresnel::schlick; }},
    {"one glass branch", Kind::glass, Acts::glass, [](RenderSettings& s) { s.glass = GlassBranches::one; }},
    {"depth 1", Kind::depth, Acts::branches, [](RenderSettings& s) { s.depth = 1; }},
    {"depth 2", Kind::depth, Acts::branches, [](RenderSettings& s) { s.depth = 2; }},
    {"depth 3", Kind::depth, Acts::branches, [](RenderSettings& s) { s.depth = 3; }},
    {"depth 4", Kind::depth, Acts::branches, [](RenderSettings& s) { s.depth = 4; }},
    {"depth 6", Kind::depth, Acts::branches, [](RenderSettings& s) { s.depth = 6; }},
    {"cut-off 0.1", Kind::cutoff, Acts::branches, [](RenderSettings& s) { s.cutoff = 0.1f; }},
    {"cut-off 0.03", Kind::cutoff, Acts::branches, [](RenderSettings& s) { s.cutoff = 0.03f; }},
    {"cut-off 0.01", Kind::cutoff, Acts::branches, [](RenderSettings& s) { s.cutoff = 0.01f; }},
    {"cut-off 0.002", Kind::cutoff, Acts::branches, [](RenderSettings& s) { s.cutoff = 0.002f; }},
    {"2 light samples", Kind::light, Acts::area_light, [](RenderSettings& s) { s.light_samples = 2; }},
    {"4 light samples", Kind::light, Acts::area_light, [](RenderSettings& s) { s.light_samples = 4; }},
    {"8 light samples", Kind::light, Acts::area_light, [](RenderSettings& s) { s.light_samples = 8; }},
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

Kind kind_of(const std::string& name) { return std::ranges::find(kKnobs, name, &Knob::name)->kind; }

// A setting's points against the least error that another one reaches in the same time, between whose sample counts curves are
// read as straight lines that go on to their bias: the counts at which it keeps up, and the least factor by which it falls
// behind.
struct Standing {
    std::vector<int> keeps_up;
    double behind = std::numeric_limits<double>::infinity();
};

// Timings scatter by a few per cent, so what falls behind by less than this is not called dominated.
constexpr double kTie = 1.05;

Standing standing(const std::vector<Curve>& curves, std::size_t which) {
    Standing s;
    for (const Measured& m : curves[which].points) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < curves.size(); ++i) {
            if (i == which) continue;
            const double bias2 = curves[i].split->bias2(), floor = bias2 > curves[i].split->bias2_noise() ? bias2 : 0.0;
            least = std::min(least, value_at(curves[i].error_over_seconds(), m.total(curves[which].build), floor));
        }
        const double behind = std::isfinite(least) && least > 0.0 ? m.error.middle / least : 0.0;
        s.behind = std::min(s.behind, behind);
        if (behind <= kTie) s.keeps_up.push_back(m.spp);
    }
    return s;
}

// Rows of settings: noise, bias, and how much bias would not have been seen.
Figure split_figure(const Stage& stage, const std::vector<Curve>& curves) {
    const Subject& subject = stage.subject();
    Figure f;
    f.id = fmt::format("bias-{}", subject.file_name());
    f.title = fmt::format("{}, {} samples", subject.title(), curves.front().points.back().spp);
    f.x.label = "variance and squared bias, relative";
    f.y.logarithmic = false;
    f.extra = {"spp", "seconds", "seconds_as_it_comes"};
    Series variance{"variance", "", "", 0, Series::Look::dots, {}}, bias{"bias²", "", "", 1, Series::Look::dots, {}};
    Series unseen{"bias² below this", "", "", 7, Series::Look::dots, {}};
    const double base = curves.front().points.back().total(curves.front().build);
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& c = curves[i];
        const Measured& m = c.points.back();
        const double bias2 = c.split->bias2(), noise = c.split->bias2_noise(), row = static_cast<double>(i + 1);
        const std::vector<double> extra{static_cast<double>(m.spp), m.total(c.build), base};
        f.y.places.push_back(fmt::format("{}  ×{:.2f}", c.name, m.total(c.build) / base));
        variance.points.push_back({c.split->variance(), row, Point{}.low, Point{}.high, extra});
        const bool seen = bias2 > noise;
        (seen ? bias : unseen).points.push_back({seen ? bias2 : noise, row, Point{}.low, Point{}.high, extra});
    }
    for (const Curve& c : curves) variance.command += render_command(subject, c.settings, c.points.back().spp) + "\n";
    f.series = {std::move(variance), std::move(bias), std::move(unseen)};
    return f;
}

Figure front_figure(const Stage& stage, const std::vector<Curve>& curves) {
    Figure by_setting = error_figure(stage, "front", curves, false), f = by_setting;
    f.levels.clear();
    f.series.clear();
    f.extra.insert(f.extra.begin(), "setting");
    std::vector<XY> all;
    for (const Curve& c : curves) {
        for (const XY& p : c.error_over_seconds()) all.push_back(p);
    }
    // The dots of one kind share a colour and a name.
    for (std::size_t kind = 0; kind < kKindNames.size(); ++kind) {
        Series s{kKindNames[kind], "", "", static_cast<int>(kind), Series::Look::dots, {}};
        for (std::size_t i = 0; i < curves.size(); ++i) {
            if (kind_of(curves[i].name) != static_cast<Kind>(kind)) continue;
            for (Point p : by_setting.series[i].points) {
                p.extra.insert(p.extra.begin(), static_cast<double>(i));
                s.points.push_back(std::move(p));
            }
        }
        if (!s.points.empty()) f.series.push_back(std::move(s));
    }
    Series front{"", "", "", 7, Series::Look::front, {}};
    for (const std::size_t i : pareto_front(all)) {
        front.points.push_back({all[i].x, all[i].y, Point{}.low, Point{}.high, {}});
    }
    f.series.push_back(std::move(front));
    f.series.front().command = "the command lines of all settings stand with the figure beside";
    return f;
}

}  // namespace

std::vector<Figure> chart_settings(const Stage& stage, Table& table) {
    const Subject& subject = stage.subject();
    stage.meter.say(fmt::format("{}: settings", subject.spec));
    const std::vector<Curve> curves = measure_curves(stage.bench, variants_of(stage.bench, &stage.references, stage.effort),
                                                     stage.effort.seeds, true, stage.meter);
    Figure split = split_figure(stage, curves), front = front_figure(stage, curves);
    const Curve& base = curves.front();
    const double base_seconds = base.points.back().total(base.build);
    std::string dominated, best, biased;
    double worst_bias = 0.0, worst_variance = 1.0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const Curve& c = curves[i];
        const Measured& m = c.points.back();
        const Standing stands = standing(curves, i);
        const double bias2 = c.split->bias2(), noise = c.split->bias2_noise();
        const bool seen = bias2 > noise;
        std::string where;
        for (const int spp : stands.keeps_up) where += fmt::format("{}{}", where.empty() ? "at " : ", ", spp);
        if (!stands.keeps_up.empty() && stands.keeps_up.back() == m.spp)
            best += fmt::format("{}{}", best.empty() ? "" : ", ", c.name);
        if (where.empty()) {
            where = fmt::format("no: ×{:.2f}", stands.behind);
            dominated += fmt::format("{}{} (×{:.2f})", dominated.empty() ? "" : ", ", c.name, stands.behind);
        }
        if (seen && bias2 > worst_bias) worst_bias = bias2, worst_variance = c.split->variance(), biased = c.name;
        table.rows.push_back({subject.spec, c.name, fmt::format("{:.2f}", m.total(c.build) / base_seconds),
                              short_number(m.error.middle), seen ? short_number(bias2) : fmt::format("< {}", short_number(noise)),
                              short_number(c.split->variance()), where});
    }
    split.caption =
        fmt::format("Pictures of {} seeds; × is the time beside the scene as it comes. {}", stage.effort.seeds,
                    biased.empty() ? std::string("None of these settings has a bias that can be told from chance.")
                                   : fmt::format("The most biased is {}: its squared bias is {}, {} times its variance.", biased,
                                                 short_number(worst_bias), short_number(worst_bias / worst_variance)));
    front.caption =
        fmt::format("With {} samples {} keep up with the best at equal time. {}", base.points.back().spp,
                    best.empty() ? std::string("none") : best,
                    dominated.empty() ? std::string("None is dominated at every sample count.")
                                      : fmt::format("Dominated at every sample count, by at least the factor: {}.", dominated));
    return {std::move(split), std::move(front)};
}

double planned_settings_seconds(Bench& bench, const Effort& effort) {
    return planned_seconds(bench, variants_of(bench, nullptr, effort), effort.seeds);
}

}  // namespace glint::chart
