// The command line, parsed and checked, and what it means once the scene is known.
// Knows no window, renderer or file format. Errors: UsageError, one line, for main to print (exit 2).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/accelerator.h"
#include "accel/isa.h"
#include "app/option_values.h"
#include "core/accelerator_choice.h"
#include "core/error_metrics.h"
#include "core/scene_io.h"
#include "core/settings.h"

namespace glint {

enum class Command { view, render, compare, chart, info, list };

struct Options {
    Command command = Command::view;
    std::vector<std::string> arguments;  // scenes, or the two pictures of `compare`
    std::string output;
    int width = 0, height = 0;                              // 0 = the scene's
    int spp = 0;                                            // 0 = not given
    double time = std::numeric_limits<double>::infinity();  // seconds
    double noise = 0.0;                                     // relRMSE to stop at; 0 = not given
    std::string convergence;                                // file for a row per doubling; empty = none
    int threads = 0;                                        // 0 = all that the process may use, -1 = all but one
    std::optional<AcceleratorKind> accelerator;             // empty = auto, or what the scene says
    bool accelerator_given = false;
    std::optional<Isa> isa;  // empty = the best of this machine
    std::string features;    // LIST as typed; empty = not given
    RenderSettings settings;  // what is independent of the scene
    std::optional<float> aperture, focus, view_angle;
    std::optional<glm::dvec3> camera_position, camera_focal_point;  // in the world
    std::optional<glm::vec3> camera_view_up;
    int camera_index = 0;
    std::string environment;
    float exposure = 0.0f;
    std::optional<Transfer> transfer;
    std::optional<std::array<int, 4>> crop;  // x0, x1, y0, y1 from the top left, upper bounds excluded
    std::string reference;                   // render: the picture to compare with; empty = none
    std::optional<double> threshold;         // what the metric may be at most (psnr: at least); empty = only equal pictures pass
    Metric metric = Metric::rmse;
    bool quick = false;  // chart: fewer scenes, seeds and samples
    bool stats_json = false, quiet = false, verbose = false, strict = false;
};

constexpr int kMaxSamples = 1 << 30;

// Parses the words after the program's name. Prints help or version itself and returns nothing then.
[[nodiscard]] std::optional<Options> parse_options(const std::vector<std::string>& words);

// A scene with every choice settled: what the viewer starts from and what `render` renders.
struct Job {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    DisplaySettings display;
    CameraPose camera;
    AcceleratorChoice accelerator;
    bool accelerator_is_auto = true;
    int width = 0, height = 0;
    int spp = 64;
    int threads = 1;
};

// Loads the scene and applies the options to it. Throws UsageError or SceneError.
[[nodiscard]] Job prepare_job(const Options& options, const std::string& scene);

// LIST of --features applied to what the scene starts with: plain names replace the set, +name and -name edit it;
// `all` and `whitted` are sets. centred_only tells whether `whitted` was among them, which also means one sample.
[[nodiscard]] FeatureSet edit_features(std::string_view list, FeatureSet start, bool& whitted);

// The instruction set that --isa names, if this machine has it; empty for `auto`.
[[nodiscard]] std::optional<Isa> chosen_isa(std::string_view option, std::string_view value,
                                            bool (*has)(Isa) noexcept = supported);

// The threads the process may use: its affinity mask, limited by a cgroup's quota.
[[nodiscard]] int available_threads();

// The scene that a bare `glint` shows, found beside the binary, in the source tree or where it is installed.
[[nodiscard]] std::string default_scene();

}  // namespace glint
