#include "app/chart_bench.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <limits>
#include <new>
#include <vector>

#include <fmt/format.h>

#include "app/chart_reference.h"
#include "app/chart_statistics.h"
#include "app/options.h"
#include "core/threads.h"

namespace glint::chart {
namespace {

// A word of a command line that any shell takes as it stands.
std::string shell_word(const std::string& word) {
    const auto plain = [](unsigned char c) {
        return std::isalnum(c) != 0 || std::string_view("_-+=,.:/@%").find(static_cast<char>(c)) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, plain)) return word;
    std::string out = "'";
    for (const char c : word) {
        if (c == '\'')
            out += "'\\''";
        else
            out += c;
    }
    return out + "'";
}

std::string feature_list(FeatureSet features) {
    std::string list;
    for (std::size_t i = 0; i < kFeatureNames.size(); ++i) {
        if (features.has(static_cast<Feature>(i))) list += fmt::format("{}{}", list.empty() ? "" : ",", kFeatureNames[i]);
    }
    return list;
}

}  // namespace

std::string Subject::file_name() const {
    std::string name = spec.substr(spec.find_last_of('/') + 1);
    if (name.starts_with("builtin:")) name.erase(0, 8);
    for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    }
    name.resize(std::min(name.size(), std::size_t{60}));
    // Files of one name in different folders are different scenes.
    return spec.starts_with("builtin:") ? name : fmt::format("{}_{:08x}", name, static_cast<std::uint32_t>(digest(spec)));
}

std::string render_command(const Subject& subject, const RenderSettings& s, int spp, const std::string& more) {
    std::string c = fmt::format("glint render {} -o out.pfm --resolution {}x{} --spp {} --seed {} --sampler {} --features {}",
                                shell_word(subject.spec), subject.width, subject.height, spp, s.seed,
                                kSamplerNames[static_cast<std::size_t>(s.sampler)], feature_list(s.features));
    const RenderSettings usual;
    if (s.depth != usual.depth) c += fmt::format(" --depth {}", s.depth);
    if (s.fresnel == Fresnel::schlick) c += " --fresnel schlick";
    if (s.cutoff != usual.cutoff) c += fmt::format(" --cutoff {:g}", s.cutoff);
    if (s.light_samples != usual.light_samples) c += fmt::format(" --light-samples {}", s.light_samples);
    if (s.adaptive) c += " --adaptive";
    if (s.glass == GlassBranches::one) c += " --glass one";
    if (s.light_size) c += fmt::format(" --light-size {:g}", *s.light_size);
    if (s.background == Background::color) c += " --background color";
    return more.empty() ? c : fmt::format("{} {}", c, more);
}

Bench::Bench(const Subject& subject, int threads, const std::atomic<bool>& stop)
    : subject_(subject),
      threads_(threads),
      stop_(stop),
      automatic_(automatic_accelerator(*subject.scene, expected_rays(*subject.scene, subject.width, subject.height,
                                                                     static_cast<double>(subject.most_spp), threads))),
      accelerators_(subject.scene, threads),
      renderer_(threads, false, threads <= available_threads()) {}

Shot Bench::take(const RenderSettings& settings, int spp, AcceleratorChoice accelerator, int crop_rows) {
    Frame frame;
    frame.scene = subject_.scene;
    frame.accelerator = accelerators_.wait(accelerator);
    frame.camera = subject_.scene->cameras.front();
    frame.settings = settings;
    frame.width = frame.x1 = subject_.width;
    frame.height = frame.y1 = subject_.height;
    if (crop_rows > 0 && crop_rows < frame.height) {
        frame.y0 = (frame.height - crop_rows) / 2;
        frame.y1 = frame.y0 + crop_rows;
    }
    frame.spp = spp;
    renderer_.restart(std::move(frame));
    Progress p = renderer_.progress();
    while (!p.finished) {
        if (stop_) throw Stopped();
        if (p.out_of_memory) throw std::bad_alloc();
        renderer_.wait(std::numeric_limits<double>::infinity(), &stop_);
        p = renderer_.progress();
    }
    Shot shot;
    renderer_.resolve(shot.image);
    shot.seconds = p.seconds;
    shot.rays = p.rays;
    shot.estimate = renderer_.error();
    return shot;
}

double Bench::build_seconds(AcceleratorChoice accelerator) {
    const auto slot = static_cast<std::size_t>(std::ranges::find(kAcceleratorChoices, accelerator) - kAcceleratorChoices.begin());
    if (build_[slot] > 0.0) return build_[slot];
    std::vector<double> seconds;
    for (int i = 0; i <= 5; ++i) {
        if (stop_) throw Stopped();
        const auto start = std::chrono::steady_clock::now();
        const auto built =
            build_accelerator(accelerator.kind, subject_.scene->geometry, parallel_for_on(threads_), accelerator.quality);
        // The first one warms up.
        if (i > 0) seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return build_[slot] = std::max(median(seconds), 1.0e-9);
}

double Bench::seconds_per_spp() {
    if (subject_.seconds_per_spp > 0.0) return subject_.seconds_per_spp;
    (void)take(subject_.settings, 4);
    return take(subject_.settings, 16).seconds / 16.0;
}

}  // namespace glint::chart
