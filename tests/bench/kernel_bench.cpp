// kernel_bench: glint's accelerators beside Embree 3, on the same rays, in one process. See --help.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <CLI/CLI.hpp>

#include "report.h"

namespace {

using namespace glint;
using namespace glint::bench;

struct Arguments {
    std::vector<std::string> scenes, sets;
    std::vector<int> threads{1, 2};
    int rounds = 7, build_rounds = 3, thin = 1;
    bool quick = false, cpu_clock = false, no_grid = false, no_build = false, list = false;
    std::string json_file, shared = GLINT_SHARED;
};

void add_options(CLI::App& app, Arguments& a) {
    app.add_option("scenes", a.scenes, "scenes by name (see --list); default: all but the largest");
    app.add_option("--sets", a.sets, "kinds of rays by name, comma-separated; default: all")->delimiter(',');
    app.add_option("--threads", a.threads, "comma-separated; default 1,2")->delimiter(',')->check(CLI::Range(1, 256));
    app.add_option("--rounds", a.rounds, "passes over the rays (7)")->check(CLI::Range(1, 1000));
    app.add_option("--build-rounds", a.build_rounds, "builds of each kind (3)")->check(CLI::Range(1, 1000));
    app.add_option("--thin", a.thin, "trace every N-th tile only (1)")->check(CLI::Range(1, 1024));
    app.add_flag("--quick", a.quick, "knot-1e5 alone, three rounds, every eighth tile");
    app.add_flag("--cpu-clock", a.cpu_clock, "time of the threads' processors instead of the wall's: for a busy machine");
    app.add_flag("--no-grid", a.no_grid, "leave the uniform grid out");
    app.add_flag("--no-build", a.no_build, "do not measure building");
    app.add_flag("--list", a.list, "list the scenes");
    app.add_option("--json", a.json_file, "all figures of every round");
    app.add_option("--shared", a.shared, "folder of the shared scenes");
}

bool is_named(const std::vector<std::string>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

SceneResult measure(const BenchScene& scene, const Arguments& arguments) {
    SceneResult result;
    result.name = scene.name;
    result.triangles = scene.geometry->triangles.size();
    result.spheres = scene.geometry->spheres.size();
    result.left_out = scene.left_out;
    result.threads = arguments.threads;
    if (!arguments.no_build) result.builds = race_builds(scene.geometry, !arguments.no_grid, arguments.build_rounds);

    const auto bvh = std::make_shared<const Bvh>(scene.geometry);
    const auto fast_tree = std::make_shared<const Bvh>(scene.geometry, serial_for, isa_in_use(), BuildQuality::fast);
    const auto grid = arguments.no_grid ? nullptr : std::make_shared<const UniformGrid>(scene.geometry);
    Competitors competitors = embree_competitors(*scene.geometry);
    for (auto& c : glint_competitors(bvh, fast_tree, grid)) competitors.push_back(std::move(c));
    const BruteForce brute_force(scene.geometry);
    for (const RaySet& set : make_ray_sets(scene, *bvh, arguments.thin)) {
        if (!arguments.sets.empty() && !is_named(arguments.sets, set.name)) continue;
        if (set.rays.empty()) continue;
        fmt::print(stderr, "{}: {}, {} rays\n", scene.name, set.name, set.rays.size());
        SetResult& out = result.sets.emplace_back();
        out.check = check(competitors, set, brute_force, scene.geometry->bounded_count());
        out.cost = traversal_cost(*bvh, set);
        for (int threads : arguments.threads) {
            out.by_threads.push_back(
                race(competitors, set, threads, arguments.rounds, arguments.cpu_clock ? Clock::cpu : Clock::wall));
        }
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    result.peak_kib = usage.ru_maxrss;
    return result;
}

std::vector<SceneSource> chosen_scenes(const Arguments& arguments) {
    for (const std::string& name : arguments.scenes) {
        const auto& known = scene_sources();
        const bool found = std::any_of(known.begin(), known.end(), [&](const SceneSource& s) { return s.name == name; });
        if (!found) throw CLI::ValidationError(fmt::format("unknown scene '{}'; see --list", name));
    }
    std::vector<SceneSource> chosen;
    for (const SceneSource& source : scene_sources()) {
        if (arguments.scenes.empty() ? source.by_default : is_named(arguments.scenes, source.name)) chosen.push_back(source);
    }
    return chosen;
}

int run(const Arguments& arguments) {
    nlohmann::json scenes = nlohmann::json::array();
    std::size_t failed = 0;
    for (const SceneSource& source : chosen_scenes(arguments)) {
        const std::optional<BenchScene> scene = load_bench_scene(source, arguments.shared);
        if (!scene) continue;
        const SceneResult result = measure(*scene, arguments);
        if (result.sets.empty()) continue;
        fmt::print("{}", to_markdown(result));
        std::fflush(stdout);
        scenes.push_back(to_json(result));
        for (const SetResult& set : result.sets) failed += set.check.failed();
    }
    if (!arguments.json_file.empty()) {
        const nlohmann::json all{{"rounds", arguments.rounds},
                                 {"thin", arguments.thin},
                                 {"clock", arguments.cpu_clock ? "cpu" : "wall"},
                                 {"scenes", scenes}};
        std::ofstream file(arguments.json_file);
        file << all.dump(1) << '\n';
        if (!file) {
            fmt::print(stderr, "{}: cannot write\n", arguments.json_file);
            return 1;
        }
    }
    if (failed > 0) fmt::print(stderr, "kernel_bench: {} of glint's answers differ from its own reference\n", failed);
    return failed > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Rays per second of glint's accelerators and of Embree 3, interleaved, with ratios; answers are checked."};
    Arguments arguments;
    add_options(app, arguments);
    try {
        app.parse(argc, argv);
        if (arguments.list) {
            for (const SceneSource& s : scene_sources())
                fmt::print("{:14} {}{}\n", s.name, s.source, s.by_default ? "" : "  (not by default)");
            return 0;
        }
        if (arguments.quick) {
            arguments.scenes = {"knot-1e5"};
            arguments.rounds = 3;
            arguments.thin = 8;
        }
        return run(arguments);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "kernel_bench: {}\n", error.what());
        return 1;
    }
}
