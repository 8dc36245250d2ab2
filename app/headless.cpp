#include "app/headless.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "accel/isa.h"
#include "app/budget.h"
#include "app/compare.h"
#include "app/convergence.h"
#include "app/error_bar.h"
#include "app/picture_format.h"
#include "core/accelerator_cache.h"
#include "core/image.h"
#include "core/renderer.h"

namespace glint {
namespace {

std::atomic<bool> stop_requested{false};
std::atomic<int> stop_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void request_stop(int signal) {
    stop_signal = signal;
    stop_requested = true;
}

std::string_view name_of(Isa isa) { return kIsaNames[static_cast<std::size_t>(isa)]; }

void replace_all(std::string& text, const std::string& field, const std::string& value) {
    for (std::size_t at = text.find(field); at != std::string::npos; at = text.find(field, at + value.size())) {
        text.replace(at, field.size(), value);
    }
}

// {scene} {accel} {spp} in a file name, and {n}: the first number from 1 whose file does not exist yet.
std::string filled_in(std::string name, const Job& job) {
    std::string scene = job.scene->name.substr(job.scene->name.find_last_of('/') + 1);
    for (char& c : scene) {
        if (c == ':' || c == ',' || c == '=') c = '_';
    }
    replace_all(name, "{scene}", scene);
    replace_all(name, "{accel}", std::string(kAcceleratorNames[static_cast<std::size_t>(job.accelerator.kind)]));
    replace_all(name, "{spp}", std::to_string(job.spp));
    if (name.find("{n}") == std::string::npos) return name;
    for (int n = 1;; ++n) {
        std::string numbered = name;
        replace_all(numbered, "{n}", std::to_string(n));
        std::error_code ignored;
        if (!std::filesystem::exists(numbered, ignored)) return numbered;
    }
}

void apply_crop(Frame& frame, const Options& o) {
    if (!o.crop) return;
    const auto [x0, x1, y0, y1] = *o.crop;
    if (x0 >= x1 || y0 >= y1 || x1 > frame.width || y1 > frame.height) {
        throw UsageError(
            fmt::format("--crop: {},{},{},{} is no window of a {}x{} picture", x0, x1, y0, y1, frame.width, frame.height));
    }
    frame.x0 = x0;
    frame.x1 = x1;
    frame.y0 = y0;
    frame.y1 = y1;
}

// Progress on stderr: redrawn on a terminal, one line every five seconds elsewhere.
class ProgressLine {
public:
    ProgressLine(bool quiet, int spp) : terminal_(isatty(STDERR_FILENO) != 0), quiet_(quiet), spp_(spp) {}
    void show(const Progress& p, const Renderer& renderer) {
        if (quiet_ || p.seconds < next_) return;
        next_ = p.seconds + (terminal_ ? 0.2 : 5.0);
        if (p.seconds < 1.0) return;
        const std::string error = error_text(renderer.error());
        const std::string limit = spp_ < kMaxSamples ? fmt::format(" of {}", spp_) : "";
        fmt::print(stderr, "{}{}-{}{} spp, {:.1f} s, {:.2f} Mrays/s{}{}{}", terminal_ ? "\r" : "", p.spp_min, p.spp_max, limit,
                   p.seconds, static_cast<double>(p.rays.total()) / p.seconds * 1e-6, error.empty() ? "" : ", ", error,
                   terminal_ ? "  " : "\n");
        shown_ = true;
    }
    void end() const {
        if (terminal_ && shown_) std::fputs("\n", stderr);
    }

private:
    bool terminal_, quiet_, shown_ = false;
    int spp_;
    double next_ = 0.0;
};

nlohmann::json stats(const Job& job, const Options& o, const Progress& p, double build_seconds, double load_seconds,
                     std::size_t accelerator_bytes, const nlohmann::json& error, std::string_view stopped_by) {
    const double seconds = std::max(p.seconds, 1e-9);
    const RayCounts& r = p.rays;
    return {{"scene", job.scene->name},
            {"accelerator", kAcceleratorNames[static_cast<std::size_t>(job.accelerator.kind)]},
            {"width", job.width},
            {"height", job.height},
            {"spp", job.spp},
            {"spp_min", p.spp_min},
            {"spp_max", p.spp_max},
            {"adaptive", job.settings.adaptive},
            {"threads", job.threads},
            {"seed", o.settings.seed},
            {"sampler", kSamplerNames[static_cast<std::size_t>(job.settings.sampler)]},
            {"stopped_by", stopped_by},
            {"seconds", p.seconds},
            {"load_ms", load_seconds * 1e3},
            {"build_ms", build_seconds * 1e3},
            {"build_quality", job.accelerator.quality == BuildQuality::fast ? "fast" : "quality"},
            {"accelerator_bytes", accelerator_bytes},
            {"primitives", job.scene->geometry->seen_count() + job.scene->geometry->planes.size()},
            {"instances", job.scene->geometry->instances.size()},
            {"rays", {{"camera", r.camera}, {"shadow", r.shadow}, {"reflection", r.reflection}, {"refraction", r.refraction}}},
            {"mrays_per_s", static_cast<double>(r.total()) / seconds * 1e-6},
            {"non_finite_samples", r.non_finite},
            {"depth_cut_branches", r.depth_cut},
            {"depth_cut_weight", r.depth_cut_weight},
            {"weight_cut_branches", r.weight_cut},
            {"weight_cut_weight", r.weight_cut_weight},
            {"samples_per_s", static_cast<double>(r.camera) / seconds},
            {"error", error},
            {"isa", name_of(isa_in_use())}};
}

void print_verdict(const Reference::Verdict& verdict, const Options& o) {
    if (o.quiet) return;
    fmt::print(stderr, "{} {:.6g} against {}: {}\n", kMetricNames[static_cast<std::size_t>(o.metric)], verdict.value, o.reference,
               verdict.within ? "within the threshold" : "not within the threshold");
}

}  // namespace

void print_warnings(const Scene& scene, const Options& options) {
    if (options.quiet) return;
    constexpr std::size_t kShown = 5;
    const std::size_t shown = options.verbose ? scene.warnings.size() : std::min(kShown, scene.warnings.size());
    for (std::size_t i = 0; i < shown; ++i) fmt::print(stderr, "{}\n", scene.warnings[i]);
    if (shown < scene.warnings.size())
        fmt::print(stderr, "and {} more warnings (--verbose shows them)\n", scene.warnings.size() - shown);
}

int run_render(const Options& o) {
    const PictureFormat format = format_of(o.output);
    const auto start = std::chrono::steady_clock::now();
    Job job = prepare_job(o, o.arguments.empty() ? default_scene() : o.arguments.front());
    const double load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print_warnings(*job.scene, o);
    Frame frame{job.scene, nullptr, job.camera, job.settings, job.width, job.height, 0, 0, job.width, job.height, job.spp};
    apply_crop(frame, o);
    std::optional<Reference> reference;
    if (!o.reference.empty()) reference.emplace(o, frame.x1 - frame.x0, frame.y1 - frame.y0);

    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    AcceleratorCache cache(job.scene, job.threads);
    frame.accelerator = cache.wait(job.accelerator);
    const std::size_t accelerator_bytes = memory_bytes(*frame.accelerator);

    Renderer renderer(job.threads, false);
    // An error alone is no bound on samples.
    const Budget budget{o.noise > 0.0 && o.spp == 0 ? kMaxSamples : job.spp, o.time, o.noise, !o.convergence.empty()};
    ProgressLine line(o.quiet, budget.spp);
    ConvergenceTable table(o, reference ? &*reference : nullptr, job.display);
    const std::string_view stopped_by =
        render_within(renderer, frame, budget, stop_requested,
                      {[&](const Progress& p) { line.show(p, renderer); },
                       [&](const Progress& p, const ErrorEstimate& e) { table.add(p, e, renderer); }});
    line.end();
    const Progress p = renderer.progress();
    const ErrorEstimate error = renderer.error();
    if (o.noise > 0.0) job.spp = p.spp;
    if (o.noise > 0.0 && !o.quiet) fmt::print(stderr, "{} at {} spp, stopped by {}\n", error_text(error), error.spp, stopped_by);
    table.write();

    Image image;
    renderer.resolve(image);
    const std::string bytes = encode(image, format, job.display);
    const bool to_stdout = o.output == "-";
    if (to_stdout) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0) {
            throw ImageError("stdout: cannot write");
        }
    } else {
        write_file_atomically(filled_in(o.output, job), bytes);
    }
    nlohmann::json compared = nlohmann::json::object();
    Reference::Verdict verdict{true, 0.0};
    if (reference) {
        verdict = reference->check(image, job.display, compared);
        print_verdict(verdict, o);
    }
    if (o.stats_json) {
        const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
        const double target = o.noise > 0.0 ? o.noise : next_target(error);
        auto json = stats(job, o, p, cache.build_seconds(job.accelerator), load_seconds, accelerator_bytes,
                          error_json(error, forecast(error, p, pixels, target)), stopped_by);
        if (reference) json.update(compared);
        (to_stdout ? std::cerr : std::cout) << json.dump(2) << "\n";
    }
    if (p.rays.non_finite > 0 && !o.quiet) {
        fmt::print(stderr, "{} non-finite sample{} left out\n", p.rays.non_finite, p.rays.non_finite == 1 ? " was" : "s were");
    }
    if (stop_requested) return 128 + stop_signal;
    if (o.strict && p.rays.non_finite > 0) return 4;
    return verdict.within ? 0 : 1;
}

int run_info(const Options& o) {
    const std::shared_ptr<const Scene> scene = load_scene(o.arguments.front());
    const Geometry& g = *scene->geometry;
    fmt::print("scene {}\n", scene->name);
    fmt::print("triangles {}\nspheres {}\nboxes {}\ncones {}\nplanes {}\n", g.triangles.size(), g.spheres.size(), g.boxes.size(),
               g.cones.size(), g.planes.size());
    fmt::print("vertices {}\nmaterials {}\nlights {}\ncameras {}\n", g.vertices.size(), scene->materials.size(),
               scene->lights.size(), scene->cameras.size());
    if (!g.instances.empty()) {
        std::size_t stored = 0;
        for (const Prototype& prototype : g.prototypes) stored += prototype.count;
        fmt::print("instances {} of {} meshes ({} primitives stored, {} seen)\n", g.instances.size(), g.prototypes.size(), stored,
                   g.seen_count() - g.bounded_count());
    }
    const Aabb box = g.bounds();
    if (!box.empty()) {
        const glm::dvec3 origin = scene->origin, lo = glm::dvec3(box.lo) + origin, hi = glm::dvec3(box.hi) + origin;
        // Far out the usual six digits would show no shape.
        const bool far = origin != glm::dvec3(0.0);
        const int digits = far ? 12 : 6;
        fmt::print("bounds {:.{}g} {:.{}g} {:.{}g} to {:.{}g} {:.{}g} {:.{}g}\n", lo.x, digits, lo.y, digits, lo.z, digits, hi.x,
                   digits, hi.y, digits, hi.z, digits);
        if (far) fmt::print("stored relative to {:.12g} {:.12g} {:.12g}\n", origin.x, origin.y, origin.z);
    }
    fmt::print("resolution {}x{}\nspp {}\n", scene->width, scene->height,
               scene->spp > 0 ? std::to_string(scene->spp) : "not given");
    std::string features;
    for (std::size_t i = 0; i < kFeatureNames.size(); ++i) {
        if (features_of(*scene).has(static_cast<Feature>(i))) features += fmt::format(" {}", kFeatureNames[i]);
    }
    fmt::print("features{}\n", features);
    // What `render` takes without further options.
    const RayDemand demand =
        expected_rays(*scene, scene->width, scene->height, scene->spp > 0 ? scene->spp : 64, available_threads());
    const auto seconds = estimated_seconds(g, demand);
    const AcceleratorChoice choice = automatic_accelerator(*scene, demand);
    fmt::print(
        "accelerator {}{} ({} bounded primitives, {:.2g} rays: none {:.2g} s, grid {:.2g} s, bvh {:.2g} s, fast {:.2g} s)\n",
        kAcceleratorNames[static_cast<std::size_t>(choice.kind)], choice.quality == BuildQuality::fast ? ", built fast" : "",
        g.seen_count(), demand.rays, seconds[0], seconds[1], seconds[2], seconds[3]);
    fmt::print("isa {} ({})\n", name_of(isa_in_use()), o.isa ? "as asked for" : "the best that this machine supports");
    for (const std::string& w : scene->warnings) fmt::print("warning {}\n", w);
    return 0;
}

int run_list() {
    fmt::print("Built-in scenes\n");
    for (const BuiltinScene& s : builtin_scenes())
        fmt::print("  builtin:{:<12} {:<28} {}\n", s.name, s.parameters, s.description);
    fmt::print("Accelerators\n  auto");
    for (const auto name : kAcceleratorNames) fmt::print(" {}", name);
    fmt::print("\nSamplers\n ");
    for (const auto name : kSamplerNames) fmt::print(" {}", name);
    fmt::print("\nFeatures\n ");
    for (const auto name : kFeatureNames) fmt::print(" {}", name);
    fmt::print("\nInstruction sets\n");
    for (std::size_t i = 0; i < kIsaNames.size(); ++i) {
        const auto isa = static_cast<Isa>(i);
        const std::string_view state = isa == isa_in_use() ? "chosen"
                                       : supported(isa)    ? "supported"
                                                           : "not supported by this machine";
        fmt::print("  {:<9} {}\n", kIsaNames[i], state);
    }
    return 0;
}

}  // namespace glint
