#include "app/option_parser.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "app/keys.h"
#include "app/option_values.h"

namespace glint {
namespace {

constexpr int kMaxSide = 65535;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

constexpr std::string_view kUsage =
    "glint: a progressive CPU ray tracer you fly through, and a headless renderer with the same bits.\n\n"
    "  glint [view] [SCENE] [OPTION...]        open the viewer (no SCENE: the showpiece)\n"
    "  glint render SCENE -o OUT [OPTION...]   render to a .png, .pfm, .hdr or .exr file, without any window\n"
    "  glint compare A B [OPTION...]           errors of picture A against B; exit 1 when over the threshold\n"
    "  glint chart [SCENE...] -o DIR           speed against accuracy, measured and drawn as a page\n"
    "  glint info SCENE                        what a scene holds, which accelerator and kernels it gets\n"
    "  glint list                              built-in scenes, accelerators, samplers, instruction sets\n\n"
    "SCENE is a .p3f, .nff, .gltf, .glb, .ply or .ply.gz file, or builtin:NAME[,key=value...].\n";

// Settings on the measured front of error against seconds: `glint chart` compares each cut-off with none at equal time. A weight
// below 0.1 costs less light than four samples err by, one below 0.01 less than 64 do; beyond that nothing is left out. From 16
// samples on `joint` errs as little as `sobol` or less, in depth of field a third.
struct Preset {
    std::string_view name;
    int spp, depth;
    float cutoff;
    SamplerKind sampler;
    bool adaptive;
};
constexpr std::array<Preset, 3> kPresets{{{"draft", 4, 8, 0.1f, SamplerKind::sobol, false},
                                          {"good", 64, 8, 0.01f, SamplerKind::joint, true},
                                          {"reference", 1024, 16, 0.0f, SamplerKind::joint, false}}};

// One CLI::App that fills `o`; each value is checked where it is declared.
class Parser {
public:
    explicit Parser(Options& options) : o_(options) {
        app_.set_version_flag("--version", "glint " GLINT_VERSION);
        app_.allow_extras();
    }

    void machine_options() {
        text("--isa", "auto|baseline|avx2|avx512", "instruction set of the BVH; all give the same picture",
             [this](auto n, auto v) { o_.isa = chosen_isa(n, v); });
    }

    void render_options() {
        resolution("image size; default the scene's");
        text("--spp", "N", "samples a pixel; default the scene's, else 64 (viewer: 4096)",
             [this](auto n, auto v) { o_.spp = number(n, v, 1, kMaxSamples, "a number of samples (1 or more)"); });
        text("--threads", "N", "0 = all that the process may use, -1 = all but one",
             [this](auto n, auto v) { o_.threads = number(n, v, -1, 1024, "a number of threads (-1 to 1024)"); });
        text("--seed", "N", "same seed, same bytes", [this](auto n, auto v) {
            o_.settings.seed = number(n, v, std::uint64_t{0}, ~std::uint64_t{0}, "a whole number of at most 64 bits");
        });
        text("--accel", "auto|none|grid|bvh", "accelerator; all give the same picture", [this](auto n, auto v) {
            constexpr std::array<std::string_view, 4> names{"auto", "none", "grid", "bvh"};
            const std::size_t i = choice(n, v, names);
            o_.accelerator_given = true;
            o_.accelerator = i == 0 ? std::nullopt : std::optional(static_cast<AcceleratorKind>(i - 1));
        });
        text("--features", "LIST",
             "of aa,dof,soft,fuzzy,specular,shadows,reflections,refractions; a plain list replaces what the "
             "scene starts with, +name and -name edit it; also all, whitted (one centred ray, spp 1)",
             [this](auto, auto v) { o_.features = v; });
        text("--fresnel", "exact|schlick", "reflectance of glass", [this](auto n, auto v) {
            o_.settings.fresnel = static_cast<Fresnel>(choice(n, v, std::array<std::string_view, 2>{"exact", "schlick"}));
        });
        text("--sampler", "NAME", "sobol, joint (pixel, lens and first light from one sequence), jittered, random or regular",
             [this](auto n, auto v) { o_.settings.sampler = static_cast<SamplerKind>(choice(n, v, kSamplerNames)); });
        app_.add_flag("--adaptive", o_.settings.adaptive,
                      "samples go where they take most error away; --spp and {spp} are then the mean over pixels");
        app_.add_flag_callback(
            "--no-adaptive", [this] { o_.settings.adaptive = false; }, "not so, beside --preset good");
        text("--depth", "N", "bounces after the camera ray; default 8",
             [this](auto n, auto v) { o_.settings.depth = number(n, v, 0, 100000, "a number of bounces (0 to 100000)"); });
        text("--cutoff", "X", "branches of a weight up to X are not followed; default 0. Darkens by at most X times their light",
             [this](auto n, auto v) { o_.settings.cutoff = number(n, v, 0.0f, 1.0f, "a weight (0 to 1)"); });
        text("--preset", "draft|good|reference",
             "--spp 4 --cutoff 0.1, --spp 64 --cutoff 0.01 --sampler joint --adaptive or --spp 1024 --depth 16 --sampler joint; "
             "what is "
             "given beside it counts more",
             [this](auto n, auto v) {
                 std::array<std::string_view, kPresets.size()> names;
                 std::transform(kPresets.begin(), kPresets.end(), names.begin(), [](const Preset& p) { return p.name; });
                 preset_ = &kPresets[choice(n, v, names)];
             });
        text("--light-samples", "N", "points on each area light at every surface; default 1",
             [this](auto n, auto v) { o_.settings.light_samples = number(n, v, 1, 4096, "a number of points (1 to 4096)"); });
        text("--glass", "both|one", "rays that go on from glass: both, or one of them by chance", [this](auto n, auto v) {
            o_.settings.glass = static_cast<GlassBranches>(choice(n, v, std::array<std::string_view, 2>{"both", "one"}));
        });
        length("--light-size", "half side of the square around point lights, scene units",
               [this](float x) { o_.settings.light_size = x; });
        length("--aperture", "lens radius, scene units", [this](float x) { o_.aperture = x; });
        length("--focus", "focus distance along the axis, scene units", [this](float x) { o_.focus = x; });
        length("--roughness", "fuzz radius of every mirror", [this](float x) { o_.settings.roughness = x; });
    }

    void camera_options() {
        text("--camera-position", "X,Y,Z", "where the eye is", [this](auto n, auto v) { o_.camera_position = vector3(n, v); });
        text("--camera-focal-point", "X,Y,Z", "what it looks at",
             [this](auto n, auto v) { o_.camera_focal_point = vector3(n, v); });
        text("--camera-view-up", "X,Y,Z", "up in the picture", [this](auto n, auto v) {
            o_.camera_view_up = vector3(n, v);
            if (*o_.camera_view_up == glm::vec3(0.0f)) refuse_value(n, v, "a direction");
        });
        text("--camera-view-angle", "DEG", "vertical field of view",
             [this](auto n, auto v) { o_.view_angle = number(n, v, 0.001f, 179.0f, "an angle from 0.001 to 179 degrees"); });
        text("--camera-index", "N", "the scene's camera to use, from 0",
             [this](auto n, auto v) { o_.camera_index = number(n, v, 0, 1 << 20, "a camera's number"); });
        text("--background", "scene|color|environment",
             "what rays see that hit nothing; environment = a procedural sky where the scene has none", [this](auto n, auto v) {
                 o_.settings.background =
                     static_cast<Background>(choice(n, v, std::array<std::string_view, 3>{"scene", "color", "environment"}));
             });
        text("--environment,--hdri-file", "DIR", "folder of six pictures right, left, top, bottom, front, back",
             [this](auto, auto v) { o_.environment = v; });
        text("--exposure", "EV", "stops brighter (or darker) on display; never touches PFM, HDR, EXR",
             [this](auto n, auto v) { o_.exposure = number(n, v, -64.0f, 64.0f, "a number of stops"); });
        text("--transfer", "linear|srgb", "display transfer; default the scene's", [this](auto n, auto v) {
            o_.transfer = static_cast<Transfer>(choice(n, v, std::array<std::string_view, 2>{"linear", "srgb"}));
        });
        app_.add_flag("--quiet", o_.quiet, "no progress, no warnings");
        app_.add_flag("--verbose", o_.verbose, "every warning, and what was chosen");
    }

    void output_options() {
        text("-o,--output", "FILE",
             "a .png, .pfm, .hdr or .exr file, - for PNG on stdout; {scene} {accel} {spp} {n} are filled in",
             [this](auto, auto v) { o_.output = v; });
        text("--time", "S", "seconds to render at most",
             [this](auto n, auto v) { o_.time = number(n, v, 0.0, 1e9, "a number of seconds"); });
        text("--noise", "X",
             "stop when the relative error (relRMSE) is X; looked at whenever the samples have doubled, from 8 on",
             [this](auto n, auto v) { o_.noise = number(n, v, 1e-9, 1e9, "a relative error above 0"); });
        text("--convergence", "FILE.csv",
             "a row per doubling of the samples: seconds, rays, error estimate, error of --reference",
             [this](auto, auto v) { o_.convergence = v; });
        text("--crop", "x0,x1,y0,y1", "a window, counted from the top left, x1 and y1 excluded", [this](auto n, auto v) {
            const auto parts = split(v, ",");
            if (parts.size() != 4) refuse_value(n, v, "four numbers x0,x1,y0,y1");
            o_.crop.emplace();
            for (std::size_t i = 0; i < 4; ++i) (*o_.crop)[i] = number(n, parts[i], 0, kMaxSide, "four numbers x0,x1,y0,y1");
        });
        text("--stats", "json", "one JSON object on stdout (on stderr with -o -)", [this](auto n, auto v) {
            (void)choice(n, v, std::array<std::string_view, 1>{"json"});
            o_.stats_json = true;
        });
        app_.add_flag("--strict", o_.strict, "non-finite samples are an error (exit 4)");
    }

    void compare_options() {
        text("-o,--output", "FILE",
             "error image: |A-B| of each channel, with --metric flip its map; in a .png the worst channel from black (0.0001) "
             "over "
             "violet (0.001), red (0.01), orange (0.1) to white (1), FLIP the same way from 0 to 1",
             [this](auto, auto v) { o_.output = v; });
        text("--stats", "json", "one JSON object instead of the lines", [this](auto n, auto v) {
            (void)choice(n, v, std::array<std::string_view, 1>{"json"});
            o_.stats_json = true;
        });
        threshold_options();
    }

    void reference_options() {
        text("--reference", "FILE", "compare with this picture after rendering; exit 1 when over the threshold",
             [this](auto, auto v) { o_.reference = v; });
        threshold_options();
    }

    void threshold_options() {
        text("--metric", "rmse|relmse|mae|psnr|flip", "what the threshold is for; default rmse",
             [this](auto n, auto v) { o_.metric = static_cast<Metric>(choice(n, v, kMetricNames)); });
        text("--reference-threshold", "X", "largest error that passes (psnr: the least decibels); default: only equal pictures",
             [this](auto n, auto v) { o_.threshold = number(n, v, 0.0, 1e18, "a number of at least 0"); });
    }

    void chart_options() {
        text("-o,--output", "DIR", "folder for index.html, pictures, numbers and references",
             [this](auto, auto v) { o_.output = v; });
        app_.add_flag("--quick", o_.quick, "three scenes, fewer seeds and samples: under two minutes");
        resolution("image size; default about 80x60 in the scene's shape (--quick: 64x48)");
        text("--spp", "N", "where curves end, rounded down to a power of two; default 256 (--quick: 64)",
             [this](auto n, auto v) { o_.spp = number(n, v, 4, 65536, "a number of samples (4 to 65536)"); });
        text("--features", "LIST", "of every scene, as for render", [this](auto, auto v) { o_.features = v; });
        text("--threads", "N", "0 = all that the process may use, -1 = all but one",
             [this](auto n, auto v) { o_.threads = number(n, v, -1, 1024, "a number of threads (-1 to 1024)"); });
        text("--seed", "N", "the first seed", [this](auto n, auto v) {
            o_.settings.seed = number(n, v, std::uint64_t{0}, std::uint64_t{1} << 32, "a whole number of at most 2^32");
        });
        app_.add_flag("--quiet", o_.quiet, "no progress");
    }

    // False when only help or version was asked for.
    bool parse(const std::vector<std::string>& words) {
        std::vector<std::string> reversed(words.rbegin(), words.rend());
        try {
            app_.parse(reversed);
        } catch (const CLI::CallForHelp&) {
            std::cout << kUsage << "\nOptions of " << kCommandNames[static_cast<std::size_t>(o_.command)] << ":\n"
                      << option_help();
            if (o_.command == Command::view) std::cout << "\nKeys:\n" << keys_help();
            return false;
        } catch (const CLI::CallForVersion&) {
            std::cout << "glint " GLINT_VERSION "\n";
            return false;
        } catch (const CLI::ParseError& e) {
            std::string reason = e.what();
            std::replace(reason.begin(), reason.end(), '\n', ' ');
            throw UsageError(reason);
        }
        for (const std::string& word : app_.remaining()) {
            if (word.size() > 1 && word.front() == '-') unknown_option(word.substr(0, word.find('=')));
            o_.arguments.push_back(word);
        }
        apply_preset();
        return true;
    }

private:
    template <class Check>
    void text(const std::string& names, const std::string& value, const std::string& help, Check check) {
        const std::string shown = names.substr(0, names.find(','));
        const std::string name = names.starts_with("-o") ? "--output" : shown;
        app_.add_option_function<std::string>(
                names, [check, name](const std::string& v) { check(std::string_view(name), std::string_view(v)); }, help)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
            ->type_name(value);
    }
    void resolution(const std::string& help) {
        text("--resolution", "WxH", help, [this](std::string_view n, std::string_view v) {
            const auto parts = split(v, "x,");
            if (parts.size() != 2) refuse_value(n, v, "a size WxH");
            o_.width = number(n, parts[0], 1, kMaxSide, "a size from 1x1 to 65535x65535");
            o_.height = number(n, parts[1], 1, kMaxSide, "a size from 1x1 to 65535x65535");
            if (std::int64_t{o_.width} * o_.height > kMaxPixels) refuse_value(n, v, "a size of at most 2^28 pixels");
        });
    }
    template <class Set>
    void length(const std::string& name, const std::string& help, Set set) {
        text(name, "X", help,
             [set](std::string_view n, std::string_view v) { set(number(n, v, 0.0f, 1e18f, "a number of at least 0")); });
    }

    void apply_preset() {
        if (preset_ == nullptr) return;
        if (app_.count("--spp") == 0) o_.spp = preset_->spp;
        if (app_.count("--depth") == 0) o_.settings.depth = preset_->depth;
        if (app_.count("--cutoff") == 0) o_.settings.cutoff = preset_->cutoff;
        if (app_.count("--sampler") == 0) o_.settings.sampler = preset_->sampler;
        if (app_.count("--adaptive") + app_.count("--no-adaptive") == 0) o_.settings.adaptive = preset_->adaptive;
    }

    [[nodiscard]] std::string option_help() const {
        std::string out;
        for (const CLI::Option* option : app_.get_options()) {
            const std::string value = option->get_type_name().empty() ? "" : " " + option->get_type_name();
            out += fmt::format("  {:<38} {}\n", option->get_name(false, true) + value, option->get_description());
        }
        return out;
    }

    [[noreturn]] void unknown_option(const std::string& word) const {
        std::vector<std::string> known;
        for (const CLI::Option* option : app_.get_options()) {
            for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
        }
        throw UsageError(fmt::format("unknown option '{}'{}", word, did_you_mean(word, known)));
    }

    Options& o_;
    const Preset* preset_ = nullptr;
    CLI::App app_{"glint"};
};

}  // namespace

bool fill_options(Options& options, const std::vector<std::string>& words) {
    const Command command = options.command;
    Parser parser(options);
    const bool renders = command == Command::view || command == Command::render;
    if (renders) parser.render_options(), parser.camera_options();
    if (renders || command == Command::info || command == Command::chart) parser.machine_options();
    if (command == Command::render) parser.output_options(), parser.reference_options();
    if (command == Command::compare) parser.compare_options();
    if (command == Command::chart) parser.chart_options();
    return parser.parse(words);
}

}  // namespace glint
