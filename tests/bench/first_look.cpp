// first_look [SCENE...]: how soon the viewer has something to show. The viewer's renderer without its window, 1280x720: the first
// whole picture from loading on, and the answer to a camera that flies.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <thread>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "app/options.h"
#include "core/accelerator_cache.h"
#include "core/scene_io.h"
#include "timed_frame.h"

namespace {

using namespace glint;
using Clock = std::chrono::steady_clock;

constexpr int kWidth = 1280, kHeight = 720;
constexpr double kTurn = 0.01;  // radians around the scene's up between two pictures of a flight
constexpr int kSpp = 4096;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Seconds of every camera change; the three milestones come in this order.
struct Latencies {
    std::vector<double> preview;  // until the coarse picture covers the window
    std::vector<double> shown;    // until that is the 8-bit image that the window gets
    std::vector<double> pass;     // until every pixel has a sample of its own
};

struct FirstLook {
    std::string scene, accelerator;
    std::size_t primitives = 0;
    double load = 0.0, build = 0.0, pass = 0.0;  // seconds, one after the other
    Latencies flight;
};

CameraPose turned(const CameraPose& pose, const glm::vec3& axis, double angle) {
    const glm::dvec3 a(axis), v = glm::dvec3(pose.eye) - glm::dvec3(pose.target);
    // Rodrigues' rotation.
    const glm::dvec3 moved =
        v * std::cos(angle) + glm::cross(a, v) * std::sin(angle) + a * glm::dot(a, v) * (1.0 - std::cos(angle));
    CameraPose result = pose;
    result.eye = glm::vec3(glm::dvec3(pose.target) + moved);
    return result;
}

// Asks as often as a renderer can be asked without being slowed down.
template <class Reached>
void wait_until(const Renderer& renderer, Reached reached) {
    while (!reached(renderer.progress())) std::this_thread::sleep_for(std::chrono::microseconds(200));
}

bool previewed(const Progress& p) { return p.preview_complete; }
bool passed(const Progress& p) { return p.spp_min >= 1; }

// A change of camera while the workers are busy with the picture before, as in a flight.
void fly(Renderer& renderer, Frame frame, int changes, Latencies& result) {
    const CameraPose home = frame.camera;
    const glm::vec3 up = frame.scene->world_up();
    Image image;
    for (int i = 1; i <= changes; ++i) {
        // Some changes come early in the pass before, some late.
        std::this_thread::sleep_for(std::chrono::milliseconds(1 + 3 * (i % 4)));
        frame.camera = turned(home, up, kTurn * i);
        const Clock::time_point start = Clock::now();
        renderer.restart(frame);
        wait_until(renderer, previewed);
        result.preview.push_back(since(start));
        (void)renderer.resolve(image);
        (void)to_display(image, {});
        result.shown.push_back(since(start));
        // Every other flight goes on from the preview; the rest waits for the whole picture.
        if (i % 2 != 0) continue;
        wait_until(renderer, passed);
        result.pass.push_back(since(start));
    }
}

FirstLook look_at(const std::string& source, int threads, int changes) {
    FirstLook look;
    Clock::time_point start = Clock::now();
    const std::shared_ptr<const Scene> scene = load_scene(source);
    look.load = since(start);
    look.scene = source.substr(source.find_last_of('/') + 1);
    look.primitives = scene->geometry->bounded_count();
    const AcceleratorChoice choice = automatic_accelerator(*scene, expected_rays(*scene, kWidth, kHeight, kSpp));
    look.accelerator = kAcceleratorNames[static_cast<std::size_t>(choice.kind)];

    start = Clock::now();
    AcceleratorCache cache(scene, threads);
    RenderSettings settings;
    settings.features = features_of(*scene);
    const Frame frame = bench::frame_of(scene, cache.wait(choice), settings, kWidth, kHeight, kSpp);
    look.build = since(start);

    start = Clock::now();
    Renderer renderer(threads, true);
    renderer.restart(frame);
    wait_until(renderer, passed);
    look.pass = since(start);
    fly(renderer, frame, changes, look.flight);
    return look;
}

double quantile(std::vector<double> values, double q) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

std::string milliseconds(const std::vector<double>& seconds) {
    return fmt::format("{:.1f} [{:.1f}]", 1e3 * quantile(seconds, 0.5), 1e3 * quantile(seconds, 0.95));
}

nlohmann::json to_json(const FirstLook& look) {
    return {{"scene", look.scene},
            {"accelerator", look.accelerator},
            {"primitives", look.primitives},
            {"load_s", look.load},
            {"build_s", look.build},
            {"first_pass_s", look.pass},
            {"preview_s", look.flight.preview},
            {"shown_s", look.flight.shown},
            {"pass_s", look.flight.pass}};
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("How soon the viewer has something to show");
    std::vector<std::string> scenes{default_scene(), "builtin:knot,n=868870", "builtin:mount", "builtin:balls"};
    int threads = available_threads(), changes = 60;
    std::string json_file;
    app.add_option("scenes", scenes, "default: the viewer's own, knot, mount, balls");
    app.add_option("--threads", threads, "default: all")->check(CLI::Range(1, 256));
    app.add_option("--changes", changes, "of the camera (60)")->check(CLI::Range(2, 10000));
    app.add_option("--json", json_file, "all figures");
    CLI11_PARSE(app, argc, argv);
    try {
        fmt::print(
            "{}x{}, {} threads. First whole picture: seconds from loading the scene to one sample in every pixel. Flying: "
            "milliseconds from a change of\nthe camera (while the picture before is being rendered) to a coarse preview "
            "of the whole window, to its 8-bit image, to one sample in\nevery pixel; median [95th percentile].\n\n",
            kWidth, kHeight, threads);
        fmt::print(
            "| scene | primitives | accelerator | first whole picture | = load + build + pass | preview | shown | whole pass |\n"
            "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
        nlohmann::json all = nlohmann::json::array();
        for (const std::string& scene : scenes) {
            const FirstLook look = look_at(scene, threads, changes);
            fmt::print("| {} | {} | {} | {:.3f} | {:.3f} + {:.3f} + {:.3f} | {} | {} | {} |\n", look.scene, look.primitives,
                       look.accelerator, look.load + look.build + look.pass, look.load, look.build, look.pass,
                       milliseconds(look.flight.preview), milliseconds(look.flight.shown), milliseconds(look.flight.pass));
            std::fflush(stdout);
            all.push_back(to_json(look));
        }
        if (!json_file.empty()) std::ofstream(json_file) << all.dump(2) << "\n";
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
}
