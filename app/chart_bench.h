// One scene on the bench: pictures of it with any settings, and how long each took.
// Knows no statistics, figure or file. Invariant: a picture is a pure function of (subject, settings, samples); only its
// seconds depend on the machine. Seconds are the renderer's own, from the order to the last sample; builds stand apart.
#pragma once

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/accelerator_cache.h"
#include "core/renderer.h"

namespace glint::chart {

// A scene as it is charted.
struct Subject {
    std::string spec;      // as `glint render` takes it
    std::string stresses;  // what it is hard on, in a few words
    std::string features;  // --features LIST that `settings` came from; empty = the scene's own
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;  // what every experiment varies one thing of
    int width = 80, height = 60;
    int most_spp = 256;  // where curves end: a power of two
    std::uint64_t seed = 1;
    double seconds_per_spp = 0.0;  // estimated once, so that what is planned and what is done count alike; 0 = not yet

    // For headings.
    [[nodiscard]] std::string title() const { return stresses.empty() ? spec : spec + ": " + stresses; }
    // For ids of figures and files: letters, digits and underscores, another one for each scene.
    [[nodiscard]] std::string file_name() const;
    [[nodiscard]] double pixels() const { return static_cast<double>(width) * height; }
};

// `glint render …` that makes this very picture.
[[nodiscard]] std::string render_command(const Subject& subject, const RenderSettings& settings, int spp,
                                         const std::string& more = "");

// The user wants no more.
class Stopped : public std::exception {
public:
    [[nodiscard]] const char* what() const noexcept override { return "stopped"; }
};

struct Shot {
    Image image;
    double seconds = 0.0;
    RayCounts rays;
    ErrorEstimate estimate;  // the renderer's own
};

class Bench {
public:
    // `stop` is looked at while rendering: Stopped is thrown once it is true.
    Bench(const Subject& subject, int threads, const std::atomic<bool>& stop);

    [[nodiscard]] const Subject& subject() const { return subject_; }
    [[nodiscard]] int threads() const { return threads_; }
    // The accelerator that the largest picture of the chart would get.
    [[nodiscard]] AcceleratorChoice automatic() const { return automatic_; }
    [[nodiscard]] Shot take(const RenderSettings& settings, int spp) { return take(settings, spp, automatic_); }
    [[nodiscard]] Shot take(const RenderSettings& settings, int spp, AcceleratorChoice accelerator, int crop_rows = 0);
    // The median of five builds, measured at the first call.
    [[nodiscard]] double build_seconds(AcceleratorChoice accelerator);
    // The subject's estimate, or one measured now.
    [[nodiscard]] double seconds_per_spp();

private:
    const Subject& subject_;
    int threads_;
    const std::atomic<bool>& stop_;
    AcceleratorChoice automatic_;
    AcceleratorCache accelerators_;
    Renderer renderer_;
    std::array<double, kAcceleratorChoices.size()> build_{};
};

}  // namespace glint::chart
