#include "app/chart_subjects.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>

#include "app/chart_figure.h"
#include "core/render_plan.h"

namespace glint::chart {
namespace {

struct Shipped {
    const char *spec, *features, *stresses;
    int most_spp, quick_spp;  // 0 = not among the quick ones
};

// The glass ball follows two branches at every surface and costs ten times as much a sample.
constexpr std::array<Shipped, 6> kShipped{{
    {"builtin:balls,level=3", "", "edges in mirrors", 256, 64},
    {"builtin:cornell", "", "soft shadows under an area light", 256, 64},
    {"builtin:dof", "", "depth of field", 256, 0},
    {"builtin:glass,what=ball", "", "glass", 64, 16},
    {"builtin:balls,level=2", "all", "fuzzy mirrors, and everything else at once", 256, 0},
    {"builtin:knot,n=100000", "+soft", "a fine mesh under soft light", 256, 0},
}};

// C-01 of the protocol: at least so many times the samples of what is judged, in replicates of an eighth each.
constexpr int kTimesSamples = 64, kReplicates = 8;
// The reference's squared error against the smallest one it judges; the rule asks for 0.01.
constexpr double kWantedShare = 0.009;
constexpr int kMostReplicates = 8 * kReplicates;
// How many are needed in common scenes; for the progress line, until it is known.
constexpr int kJitteredGuess = 18, kDeepGuess = 18;
// Seeds of references, far from those of tests.
constexpr std::uint64_t kReferenceSeed = std::uint64_t{1} << 40;

Subject subject_of(const Options& o, const std::string& spec, const std::string& features, const std::string& stresses,
                   int most_spp) {
    Subject s;
    s.spec = spec;
    s.stresses = stresses;
    s.features = o.features.empty() ? features : o.features;
    s.scene = load_scene(spec);
    s.settings.features = features_of(*s.scene);
    bool whitted = false;
    if (!s.features.empty()) s.settings.features = edit_features(s.features, s.settings.features, whitted);
    s.seed = o.settings.seed == 0 ? 1 : o.settings.seed;
    s.most_spp = static_cast<int>(std::bit_floor(static_cast<unsigned>(o.spp > 0 ? o.spp : most_spp)));
    if (o.width > 0) {
        s.width = o.width;
        s.height = o.height;
        return s;
    }
    // As many pixels for each scene, in its own shape.
    const double pixels = o.quick ? 64.0 * 48.0 : 80.0 * 60.0;
    const double aspect = std::clamp(static_cast<double>(s.scene->width) / s.scene->height, 0.1, 10.0);
    s.height = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels / aspect))));
    s.width = std::max(1, static_cast<int>(std::lround(pixels / s.height)));
    return s;
}

RenderSettings reference_settings(const Subject& subject, SamplerKind sampler, bool deep) {
    RenderSettings s = subject.settings;
    s.sampler = sampler;
    if (deep) s.depth *= 2;
    return s;
}

int replicate_spp(int judged_spp) { return kTimesSamples / kReplicates * judged_spp; }

bool has_branches(const Subject& subject) {
    const RenderPlan plan = plan_render(*subject.scene, subject.settings, subject.scene->cameras.front());
    return plan.has(kernel_part::glass) || plan.has(kernel_part::mirror);
}

}  // namespace

std::vector<Subject> subjects_of(const Options& o) {
    std::vector<Subject> list;
    for (const std::string& spec : o.arguments) {
        if (std::ranges::find(list, spec, &Subject::spec) == list.end())
            list.push_back(subject_of(o, spec, "", "", o.quick ? 64 : 256));
    }
    if (!list.empty()) return list;
    for (const Shipped& s : kShipped) {
        if (o.quick && s.quick_spp == 0) continue;
        list.push_back(subject_of(o, s.spec, s.features, s.stresses, o.quick ? s.quick_spp : s.most_spp));
    }
    return list;
}

std::string reference_key(Bench& bench, const RenderSettings& settings, int spp) {
    const Subject& s = bench.subject();
    const Geometry& g = *s.scene->geometry;
    // The camera and settings stand in the command; what the scene and the program make of them shows in the bytes of the first
    // samples, which are the same on every machine until one of the two changes.
    RenderSettings probe = settings;
    probe.seed = kReferenceSeed;
    const Shot shot = bench.take(probe, 4);
    const std::string_view bytes(reinterpret_cast<const char*>(shot.image.pixels.data()),
                                 shot.image.pixels.size() * sizeof(glm::vec3));
    return fmt::format("glint {}\n{}\n{} primitives, {} materials, {} lights\nfirst samples {:016x}", GLINT_VERSION,
                       render_command(s, probe, spp), g.seen_count() + g.planes.size(), s.scene->materials.size(),
                       s.scene->lights.size(), digest(bytes));
}

double planned_reference_seconds(Bench& bench, const Effort& effort) {
    const Subject& subject = bench.subject();
    const int deep = has_branches(subject) ? std::min(effort.settings_most, subject.most_spp) : 0;
    return bench.seconds_per_spp() *
           (replicate_spp(subject.most_spp) * (kJitteredGuess + kReplicates) + replicate_spp(deep) * kDeepGuess);
}

namespace {

// What the best of these samplers will reach, told without a reference.
double least_error(Bench& bench, std::initializer_list<SamplerKind> kinds, int spp) {
    double least = std::numeric_limits<double>::infinity();
    for (const SamplerKind kind : kinds) {
        RenderSettings s = reference_settings(bench.subject(), kind, false);
        s.seed = bench.subject().seed;
        const Image a = bench.take(s, spp).image;
        ++s.seed;
        least = std::min(least, relative_error_of_pair(a, bench.take(s, spp).image));
    }
    return least;
}

// The references of one scene: those that are there, and those that have to be rendered.
struct Shelf {
    Bench& bench;
    const std::filesystem::path& folder;
    bool quiet;
    Meter& meter;
    Table& table;

    // judged_spp, judged: the most samples and the least error it will judge. guess: replicates that the progress line counts on.
    [[nodiscard]] Reference get(const char* name, const RenderSettings& settings, int judged_spp, double judged, int guess);
};

Reference Shelf::get(const char* name, const RenderSettings& settings, int judged_spp, double judged, int guess) {
    const Subject& subject = bench.subject();
    const int spp = replicate_spp(judged_spp);
    const double one = spp * bench.seconds_per_spp();
    const auto path = folder / fmt::format("{}-{}-{}x{}.ref", subject.file_name(), name, subject.width, subject.height);
    const std::string key = reference_key(bench, settings, spp);
    const auto enough = [&](const Reference& r) {
        const double share = r.relative_variance() / (kWantedShare * judged);
        const int wanted =
            static_cast<int>(std::clamp(std::ceil(r.replicates * share), 1.0 * kReplicates, 1.0 * kMostReplicates));
        meter.plan((wanted - guess) * one);
        guess = wanted;
        return r.replicates >= kReplicates && share <= 1.0;
    };
    std::string why;
    std::optional<Reference> r = read_reference(path, key, why);
    if (r && (r->width != subject.width || r->height != subject.height)) r.reset(), why = "has another size";
    if (r && !enough(*r) && r->replicates < kMostReplicates) r.reset(), why = "is not exact enough";
    if (!why.empty() && !quiet) fmt::print(stderr, "{} {}: rendered anew\n", path.string(), why);
    const bool kept = r.has_value();
    if (kept) {
        meter.plan(-guess * one);
    } else {
        const auto replicate = [&](int i) {
            meter.say(fmt::format("{}: {} reference, {} of about {}", subject.spec, name, i + 1, guess));
            RenderSettings s = settings;
            s.seed = kReferenceSeed + static_cast<std::uint64_t>(i);
            Image image = bench.take(s, spp).image;
            meter.did(one);
            return image;
        };
        r = average(spp, kMostReplicates, replicate, enough);
        write_reference(path, key, *r);
    }
    table.rows.push_back({subject.spec, name, fmt::format("{}x{}", r->width, r->height), fmt::format("{:.0f}", r->samples()),
                          fmt::format("{:.0f}", r->samples() / judged_spp), short_number(r->relative_variance()),
                          fmt::format("{:.2f} %", 100.0 * r->relative_variance() / judged), kept ? "kept" : "rendered"});
    return *r;
}

// Two families must agree within their errors: how far they differ, and how far chance lets them.
std::vector<std::string> agreement(const Subject& subject, const Reference& a, const Reference& b) {
    double off = 0.0;
    for (std::size_t i = 0; i < b.mean.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double d = a.mean[i][c] - b.mean[i][c];
            off += d * d / relative_scale(b.mean[i][c]);
        }
    }
    off /= 3.0 * static_cast<double>(b.mean.size());
    const double expected = a.relative_variance() + b.relative_variance();
    return {subject.spec,
            "jittered against sobol",
            "",
            "",
            "",
            short_number(off),
            fmt::format("{:.2f} of chance", expected > 0.0 ? off / expected : 0.0),
            ""};
}

}  // namespace

References references_of(Bench& bench, const Effort& effort, const std::filesystem::path& folder, bool quiet, Meter& meter,
                         Table& table) {
    const Subject& subject = bench.subject();
    Shelf shelf{bench, folder, quiet, meter, table};
    const auto settings = [&](SamplerKind sampler, bool deep) { return reference_settings(subject, sampler, deep); };
    const auto best = [&](int spp) { return least_error(bench, {SamplerKind::sobol, SamplerKind::joint}, spp); };
    const auto others = [&](int spp) { return least_error(bench, {SamplerKind::jittered, SamplerKind::random}, spp); };
    const int most = subject.most_spp, settings_most = std::min(effort.settings_most, most);
    References r;
    r.jittered = shelf.get("jittered", settings(SamplerKind::jittered, false), most, best(most), kJitteredGuess);
    r.sobol = shelf.get("sobol", settings(SamplerKind::sobol, false), most, others(most), kReplicates);
    table.rows.push_back(agreement(subject, r.jittered, r.sobol));
    r.deep = r.jittered;
    if (has_branches(subject)) {
        r.deep = shelf.get("deep", settings(SamplerKind::jittered, true), settings_most, best(settings_most), kDeepGuess);
    }
    return r;
}

}  // namespace glint::chart
