#include "report.h"

#include <algorithm>

#include <fmt/core.h>

namespace glint::bench {
namespace {

using Role = Competitor::Role;
using nlohmann::json;

std::string with_spread(const Spread& s) { return fmt::format("{:.2f} [{:.2f}–{:.2f}]", s.median, s.low, s.high); }

const Rates* of_role(const std::vector<Rates>& rates, Role role) {
    const auto found = std::find_if(rates.begin(), rates.end(), [&](const Rates& r) { return r.role == role; });
    return found == rates.end() ? nullptr : &*found;
}

// The best of Embree's packets and streams for this query; null where there is none.
const Rates* best_wide(const std::vector<Rates>& rates) {
    const Rates* best = nullptr;
    for (const Rates& r : rates) {
        if (r.role != Role::embree_wide) continue;
        if (best == nullptr || spread(r.mrays).median > spread(best->mrays).median) best = &r;
    }
    return best;
}

std::string ratio_cell(const Rates* a, const Rates* b) { return a && b ? with_spread(ratio(a->mrays, b->mrays)) : "–"; }

std::string plural(int threads) { return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"); }

std::string build_table(const SceneResult& result) {
    const auto primitives = static_cast<double>(result.triangles + result.spheres);
    std::string text = "| builder | threads | seconds | bytes per primitive |\n| --- | --- | --- | --- |\n";
    for (const Build& b : result.builds) {
        const Spread s = spread(b.seconds);
        text += fmt::format("| {} | {} | {:.3f} [{:.3f}–{:.3f}] | {:.1f} |\n", b.name, b.threads, s.median, s.low, s.high,
                            static_cast<double>(b.bytes) / primitives);
    }
    const auto of = [&](std::string_view name, int threads) {
        return std::find_if(result.builds.begin(), result.builds.end(),
                            [&](const Build& b) { return b.name == name && b.threads == threads; });
    };
    text += "\n| seconds, ratios | 1 thread | 2 threads |\n| --- | --- | --- |\n";
    constexpr std::string_view kPairs[][2] = {{"glint bvh", "embree medium"}, {"glint bvh, fast", "embree low"}};
    for (const auto& [ours, theirs] : kPairs) {
        text +=
            fmt::format("| {} : {} | {} | {} |\n", ours, theirs, with_spread(ratio(of(ours, 1)->seconds, of(theirs, 1)->seconds)),
                        with_spread(ratio(of(ours, 2)->seconds, of(theirs, 2)->seconds)));
    }
    return text;
}

std::string rate_table(const SceneResult& result, std::size_t t) {
    std::string head = fmt::format("| Mrays/s, {} |", plural(result.threads[t])), rule = "| --- |";
    for (const SetResult& set : result.sets) {
        head += fmt::format(" {} |", set.check.set);
        rule += " --- |";
    }
    std::string text = head + "\n" + rule + "\n";
    const std::size_t competitors = result.sets.front().by_threads[t].size();
    for (std::size_t c = 0; c < competitors; ++c) {
        text += fmt::format("| {} |", result.sets.front().by_threads[t][c].name);
        for (const SetResult& set : result.sets) text += fmt::format(" {:.2f} |", spread(set.by_threads[t][c].mrays).median);
        text += "\n";
    }
    return text;
}

std::string ratio_table(const SceneResult& result, std::size_t t) {
    std::string text = fmt::format(
        "| ratios, {} | bvh, one ray : embree 1 | bvh, batches : embree 1 | bvh, batches : best wide | best wide | grid : embree "
        "1 | fast tree : tree |\n"
        "| --- | --- | --- | --- | --- | --- | --- |\n",
        plural(result.threads[t]));
    for (const SetResult& set : result.sets) {
        const std::vector<Rates>& rates = set.by_threads[t];
        const Rates *single = of_role(rates, Role::embree_single), *wide = best_wide(rates);
        const Rates *one = of_role(rates, Role::bvh_single), *batch = of_role(rates, Role::bvh_batch);
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", set.check.set, ratio_cell(one, single),
                        ratio_cell(batch, single), ratio_cell(batch, wide), wide ? wide->name : "–",
                        ratio_cell(of_role(rates, Role::grid), single), ratio_cell(of_role(rates, Role::bvh_fast_tree), batch));
    }
    return text;
}

std::string check_table(const SceneResult& result) {
    std::string text =
        "| checks | rays | hits | glint's paths differ | brute force differs | Embree robust: other verdict, other hit |"
        " nodes, leaves, primitives a ray |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const SetResult& set : result.sets) {
        const Check& c = set.check;
        const std::string cost =
            set.cost ? fmt::format("{:.1f}, {:.1f}, {:.1f}", set.cost->nodes, set.cost->leaves, set.cost->primitives) : "–";
        text += fmt::format("| {} | {} | {} | {} | {} of {} | {}, {} | {} |\n", c.set, c.rays, c.hits, c.paths_differ,
                            c.brute_force_differs, c.sampled, c.peer_hit_or_miss, c.peer_distance, cost);
    }
    return text;
}

json check_json(const Check& c) {
    return {{"rays", c.rays},
            {"hits", c.hits},
            {"paths_differ", c.paths_differ},
            {"sampled", c.sampled},
            {"brute_force_differs", c.brute_force_differs},
            {"embree_robust_other_verdict", c.peer_hit_or_miss},
            {"embree_robust_other_hit", c.peer_distance}};
}

}  // namespace

std::string to_markdown(const SceneResult& result) {
    std::string text = fmt::format("### {}: {} triangles, {} spheres\n\n", result.name, result.triangles, result.spheres);
    if (result.left_out > 0) text += fmt::format("{} cones and planes of the scene left out.\n\n", result.left_out);
    if (!result.builds.empty()) text += build_table(result) + "\n";
    for (std::size_t t = 0; t < result.threads.size(); ++t) text += rate_table(result, t) + "\n" + ratio_table(result, t) + "\n";
    return text + check_table(result) + fmt::format("\nPeak memory of the process so far: {} MiB.\n\n", result.peak_kib / 1024);
}

nlohmann::json to_json(const SceneResult& result) {
    json out{{"scene", result.name},
             {"triangles", result.triangles},
             {"spheres", result.spheres},
             {"left_out", result.left_out},
             {"peak_kib", result.peak_kib}};
    for (const Build& b : result.builds) {
        out["builds"].push_back({{"name", b.name}, {"threads", b.threads}, {"seconds", b.seconds}, {"bytes", b.bytes}});
    }
    for (const SetResult& set : result.sets) {
        json entry{{"set", set.check.set}, {"check", check_json(set.check)}};
        if (set.cost)
            entry["per_ray"] = {{"nodes", set.cost->nodes}, {"leaves", set.cost->leaves}, {"primitives", set.cost->primitives}};
        for (std::size_t t = 0; t < result.threads.size(); ++t) {
            json rates;
            for (const Rates& r : set.by_threads[t]) rates[r.name] = r.mrays;
            entry["runs"].push_back({{"threads", result.threads[t]}, {"mrays_per_second", std::move(rates)}});
        }
        out["sets"].push_back(std::move(entry));
    }
    return out;
}

}  // namespace glint::bench
