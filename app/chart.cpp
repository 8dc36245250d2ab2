#include "app/chart.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "accel/isa.h"
#include "app/chart_experiments.h"
#include "app/chart_files.h"
#include "app/chart_page.h"
#include "app/chart_scaling.h"
#include "app/chart_subjects.h"
#include "app/options.h"

namespace glint {
namespace {

using namespace chart;
namespace fs = std::filesystem;

std::atomic<bool> stop_requested{false};
std::atomic<int> stop_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

// Once; whoever insists ends the program at once.
extern "C" void stop_chart(int signal) {
    std::signal(signal, SIG_DFL);
    stop_signal = signal;
    stop_requested = true;
}

// Whether files can be made there is tried before hours are spent.
fs::path checked_folder(const std::string& output) {
    const fs::path folder = output;
    std::error_code error;
    fs::create_directories(folder / "references", error);
    if (error) throw ImageError(fmt::format("{}: cannot write: {}", output, error.message()));
    const fs::path probe = folder / "chart.json";
    if (!fs::exists(probe, error)) {
        write_file_atomically(probe, "{}\n");
        fs::remove(probe, error);
    } else if (fs::is_directory(probe, error)) {
        throw ImageError(fmt::format("{}: cannot write: is a folder", probe.string()));
    } else {
        write_file_atomically(folder / "probe.tmp", "");
        fs::remove(folder / "probe.tmp", error);
    }
    return folder;
}

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
    }
    return "unknown processor";
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[16];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d", &utc)};
}

std::string command_line(const Options& o) {
    std::string c = "glint chart";
    for (const std::string& scene : o.arguments) c += " " + scene;
    c += " -o " + o.output;
    if (o.quick) c += " --quick";
    if (o.width > 0) c += fmt::format(" --resolution {}x{}", o.width, o.height);
    if (o.spp > 0) c += fmt::format(" --spp {}", o.spp);
    if (!o.features.empty()) c += " --features " + o.features;
    if (o.threads != 0) c += fmt::format(" --threads {}", o.threads);
    if (o.settings.seed != 0) c += fmt::format(" --seed {}", o.settings.seed);
    return c;
}

// The sections in the order of the page; experiments on each scene add to them in turn.
struct Sections {
    Section samplers{
        "samplers",
        "Samplers: error against seconds and samples",
        "relMSE is the mean over pixels and channels of the squared difference from the reference over its square plus "
        "0.01. Curves are medians over seeds, bands hold the median with 95 % (bootstrap); the second figure of each pair "
        "has samples for seconds and so tells a better sampler from a cheaper one.",
        {},
        {},
        {}};
    Table targets{
        "targets",
        "Time to two errors",
        "Seconds to relMSE 0.01 and 0.001, by straight lines in log-log between the measured points, build included. > is a run "
        "that did not get there by its last sample, ≤ one that was there with its first. a: root relMSE ~ N^-a, ± two standard "
        "errors of the fit.",
        {"scene", "sampler", "to 0.01", "to 0.001", "last relMSE", "after", "a"},
        {}};
    Section error_bars{"errorbars",
                       "The error bar: what the renderer says of itself",
                       "From what each doubling of the samples changes in a picture the renderer estimates how far it is from "
                       "its limit, without a "
                       "reference. Here its estimate is divided by the error that the reference shows.",
                       {},
                       {},
                       {}};
    Section accelerators{
        "accelerators",
        "Accelerators: the same error at other times",
        "All of them give the same bytes, so only seconds can differ. Where brute force would take longer than half a second "
        "for a picture its curve ends.",
        {},
        {},
        {}};
    Section features{
        "features",
        "Features: what each adds in time and takes away in error",
        "Judged by the picture with all of the scene's features. A curve that levels off has lost something that no number of "
        "samples brings back.",
        {},
        {},
        {}};
    Section settings{
        "settings",
        "Approximations: bias, noise and the front",
        "Each setting differs by one thing from the scene as it comes. Squared bias and variance are told apart from pictures "
        "of many seeds, against a reference of twice the depth. A setting keeps up at a sample count if its error is within "
        "5 % of the least error that another reaches in the same time; curves are read as straight lines in log-log, which go on "
        "past the last sample count but not below the setting's bias.",
        {},
        {},
        {}};
    Table all_settings{
        "settings-table",
        "Settings",
        "Time beside the scene as it comes, both at the largest sample count. Bias² with < could not be told from chance.",
        {"scene", "setting", "time", "relMSE", "bias²", "variance", "keeps up"},
        {}};
    Section scaling{"scaling", "Machines: break-even and threads", "", {}, {}, {}};
    Section references{"references",
                       "References",
                       "What all errors are measured against: means in double of replicates with seeds of their own. Curves of "
                       "sobol and joint are "
                       "judged by the jittered one, the others by the sobol one, approximations by a jittered one of twice the "
                       "depth. The squared "
                       "error of the reference is taken off every relMSE.",
                       {},
                       {},
                       {}};
    Table reference_table{
        "references-table",
        "How exact they are",
        "Share: the reference's squared error over the smallest relMSE that it judges; the protocol allows 1 %.",
        {"scene", "reference", "size", "samples", "× the most judged", "its relMSE", "share", "file"},
        {}};
};

void chart_scene(Bench& bench, const Effort& effort, const fs::path& folder, bool quiet, Meter& meter, Sections& s) {
    const References references = references_of(bench, effort, folder / "references", quiet, meter, s.reference_table);
    const Stage stage{bench, references, effort, meter};
    const auto add = [](Section& section, std::vector<Figure> figures) {
        for (Figure& f : figures) section.figures.push_back(std::move(f));
    };
    add(s.samplers, chart_samplers(stage, s.targets, s.error_bars.figures));
    add(s.accelerators, chart_accelerators(stage));
    add(s.features, chart_features(stage));
    add(s.settings, chart_settings(stage, s.all_settings));
}

Effort effort_of(const Options& o) {
    Effort e;
    if (o.quick) e = {10, 4, 16, 5};
    return e;
}

}  // namespace

int run_chart(const Options& o) {
    std::vector<Subject> subjects = subjects_of(o);
    const fs::path folder = checked_folder(o.output);
    std::signal(SIGINT, stop_chart);
    std::signal(SIGTERM, stop_chart);
    const int cores = available_threads();
    const int threads = o.threads > 0 ? o.threads : o.threads < 0 ? std::max(1, cores - 1) : cores;
    const Effort effort = effort_of(o);
    Meter meter(o.quiet);
    Sections s;
    bool stopped = false;
    try {
        meter.say("warming up");
        for (Subject& subject : subjects) {
            Bench bench(subject, threads, stop_requested);
            subject.seconds_per_spp = bench.seconds_per_spp();
            meter.plan(planned_reference_seconds(bench, effort) + planned_seconds(bench, effort) +
                       planned_settings_seconds(bench, effort));
        }
        const Machine machine{threads, o.quick, stop_requested};
        const bool whole = o.arguments.empty();
        if (whole) meter.plan(planned_scaling_seconds(machine));
        for (const Subject& subject : subjects) {
            Bench bench(subject, threads, stop_requested);
            chart_scene(bench, effort, folder, o.quiet, meter, s);
        }
        chart_threads(machine, subjects.back(), s.scaling, meter);
        if (whole) chart_machine(machine, s.scaling, meter);
    } catch (const Stopped&) {
        stopped = true;
    }
    meter.say("drawing");
    s.samplers.tables.push_back(std::move(s.targets));
    s.settings.tables.push_back(std::move(s.all_settings));
    s.references.tables.push_back(std::move(s.reference_table));
    std::error_code ignored;
    const bool numeric = fs::exists(folder / "numeric" / "index.html", ignored);
    Chart c;
    c.title = "glint: speed against accuracy";
    c.command = command_line(o);
    c.machine = fmt::format("{}, {} thread{}, {}", processor(), threads, threads == 1 ? "" : "s",
                            kIsaNames[static_cast<std::size_t>(isa_in_use())]);
    c.version = GLINT_VERSION;
    c.date = today();
    c.notes = {
        fmt::format("{} seeds a point, each one a timing; variants take turns seed by seed after a warm-up; seconds are medians "
                    "and hold the build of the accelerator. Sample counts are powers of {}.",
                    effort.seeds, effort.step),
        fmt::format("Measured in {:.0f} s. {}; bands and medians hold what else the machine did.", meter.elapsed(),
                    threads <= available_threads() ? "Each thread keeps to a processor of its own"
                                                   : "Threads are more than processors and not pinned")};
    if (stopped) c.notes.push_back("The run was stopped: what had been measured by then is shown.");
    for (Section* section : {&s.samplers, &s.error_bars, &s.accelerators, &s.features, &s.settings, &s.scaling, &s.references}) {
        const bool rows = std::ranges::any_of(section->tables, [](const Table& t) { return !t.rows.empty(); });
        if (!section->figures.empty() || !section->maps.empty() || rows) c.sections.push_back(std::move(*section));
    }
    c.numeric = numeric;
    write_data(c, folder);
    Plotter plotter(folder);
    write_file_atomically(folder / "index.html", page_of(c, plotter));
    if (!plotter.works())
        fmt::print(stderr, "gnuplot is missing (Debian package gnuplot-nox): numbers are written, nothing is drawn\n");
    meter.end();
    if (!o.quiet) fmt::print(stderr, "{} written after {:.0f} s\n", (folder / "index.html").string(), meter.elapsed());
    return stopped ? 128 + stop_signal.load() : 0;
}

}  // namespace glint
