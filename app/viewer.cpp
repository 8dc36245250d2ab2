#include "app/viewer.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "app/blit.h"
#include "app/screenshot.h"
#include "app/session.h"
#include "app/viewer_input.h"
#include "app/viewer_window.h"
#include "core/accelerator_cache.h"

namespace glint {
namespace {

constexpr double kFrameSeconds = 1.0 / 30.0;  // software GL takes the cores that render: never redraw more often
constexpr double kIdleSeconds = 0.25;         // how soon a signal is noticed while nothing happens
constexpr double kTitleSeconds = 0.25;
constexpr double kLongestStep = 0.1;  // of flight, seconds: after a stall the camera must not leap

volatile std::sig_atomic_t caught_signal = 0;

void catch_signal(int number) { caught_signal = number; }

// Signals close the window while one of these lives.
class SignalGuard {
public:
    SignalGuard() {
        caught_signal = 0;
        interrupt_ = std::signal(SIGINT, catch_signal);
        terminate_ = std::signal(SIGTERM, catch_signal);
    }
    ~SignalGuard() {
        std::signal(SIGINT, interrupt_);
        std::signal(SIGTERM, terminate_);
    }
    SignalGuard(const SignalGuard&) = delete;
    SignalGuard& operator=(const SignalGuard&) = delete;

private:
    void (*interrupt_)(int);
    void (*terminate_)(int);
};

// A picture that is looked at gets that many samples.
constexpr double kSamplesLookedAt = 64.0;

// Whoever flies at once sees no whole pass; the better tree is begun after so many seconds all the same.
constexpr double kPatience = 2.0;

// looked_at: whether the first picture is there, and the cores are free to build a better tree.
AcceleratorSource source_of(AcceleratorCache& cache, const Scene& scene, Extent window, int threads, const bool& looked_at) {
    const RayDemand demand = expected_rays(scene, window.width, window.height, kSamplesLookedAt, threads);
    return {automatic_accelerator(scene, demand).kind,
            [&cache, &looked_at](AcceleratorKind kind) { return cache.request_best_so_far(kind, looked_at); },
            [&cache](AcceleratorKind kind) { return cache.failed(kind); }};
}

class Viewer {
public:
    Viewer(const ViewerOptions& options, std::unique_ptr<ViewerWindow> window);
    void run();

private:
    void command(Action action);
    void take_screenshot();
    void draw(const Progress& progress, double now);
    void update_title(double now);
    [[nodiscard]] double seconds_to_wait(const Progress& progress, double now) const;
    // The progress that the screen shows of the submitted frame; fresh while it still shows an older one.
    [[nodiscard]] Progress shown_of_frame() const { return shown_.generation == generation_ ? shown_ : Progress{}; }

    bool looked_at_ = false;  // the first picture has been there
    // The order matters at the end: the window disappears first, then threads are waited for.
    AcceleratorCache cache_;
    Renderer renderer_;
    Session session_;
    std::unique_ptr<ViewerWindow> window_;
    Blit blit_;
    ViewerInput input_;

    std::uint64_t generation_ = 0;  // of the submitted frame
    bool too_large_ = false;        // that frame's picture for this memory
    Progress shown_;                // of the picture in the texture
    DisplaySettings shown_display_;
    Image image_;
    double next_draw_ = 0.0, next_refinement_ = 0.0, next_title_ = 0.0;
};

Viewer::Viewer(const ViewerOptions& options, std::unique_ptr<ViewerWindow> window)
    : cache_(options.scene, options.threads, BuildPriority::background),
      renderer_(std::max(1, options.threads), true),
      session_(options.scene, {options.settings, options.display, options.accelerator, options.spp},
               options.camera.value_or(options.scene->cameras.at(0)),
               source_of(cache_, *options.scene, window->framebuffer(), options.threads, looked_at_)),
      window_(std::move(window)),
      input_(window_->handle(), session_, [this](Action action) { command(action); }) {}

void Viewer::command(Action action) {
    if (action == Action::quit) window_->close();
    if (action == Action::screenshot) take_screenshot();
    if (action == Action::help) {
        const auto state = [this](Action a) { return session_.state_of(a); };
        fmt::print(stderr, "{}", keys_help(input_.key_map(), state));
    }
    for (const std::string& line : session_.take_messages()) fmt::print(stderr, "glint: {}\n", line);
}

void Viewer::take_screenshot() {
    const auto kind = session_.accelerator_in_use();
    Image image;
    int spp = renderer_.resolve_pass(image);
    // No pass is whole yet, or one tile is far slower than all others: then what is shown.
    if (spp == 0) spp = renderer_.progress().spp;
    const bool any = !image.pixels.empty() || renderer_.resolve(image);
    if (!kind || !any) return fmt::print(stderr, "glint: no screenshot: there is no picture yet\n");
    try {
        const auto name = kAcceleratorNames[static_cast<std::size_t>(*kind)];
        const auto path = screenshot_path(pictures_folder(), session_.scene().name, name, spp);
        write_screenshot(path, image, session_.choices().display);
        fmt::print("{}\n", path.string());
        std::fflush(stdout);
    } catch (const std::exception& error) {
        fmt::print(stderr, "glint: no screenshot: {}\n", error.what());
    }
}

void Viewer::draw(const Progress& progress, double now) {
    const Extent size = window_->framebuffer();
    if (size.width == 0 || size.height == 0) return;
    const DisplaySettings& display = session_.choices().display;
    const bool news =
        progress.preview_complete && (progress.generation != shown_.generation || progress.rays.camera != shown_.rays.camera ||
                                      progress.finished != shown_.finished || display != shown_display_);
    // A picture that merely gets cleaner leaves the cores to the workers; everything else is shown as soon as may be.
    const bool merely_cleaner = progress.generation == shown_.generation && !progress.finished && display == shown_display_;
    const bool upload = news && now >= (merely_cleaner ? next_refinement_ : next_draw_);
    if (now < next_draw_ || (!upload && !input_.damaged())) return;
    input_.clear_damage();
    if (upload && renderer_.resolve(image_)) {
        blit_.upload(to_display(image_, display));
        shown_ = progress;
        shown_display_ = display;
        // Drawing takes at most a fifth of the time, and less once more samples change little.
        const double cost = glfwGetTime() - now;
        next_refinement_ = now + std::max(4.0 * cost, (progress.spp_min < 16 ? 1.0 : 5.0) * kFrameSeconds);
    }
    blit_.draw(size.width, size.height);
    window_->swap();
    next_draw_ = now + kFrameSeconds;
}

void Viewer::update_title(double now) {
    const Progress progress = shown_of_frame();
    if (now < next_title_ && !progress.finished) return;
    const bool current = progress.generation == generation_;
    window_->set_title(session_.title(progress, current ? renderer_.error() : ErrorEstimate()));
    next_title_ = now + kTitleSeconds;
}

double Viewer::seconds_to_wait(const Progress& progress, double now) const {
    const bool current = shown_.generation == generation_ && shown_display_ == session_.choices().display &&
                         shown_.finished == progress.finished && !input_.damaged();
    if (window_->framebuffer().width == 0) return kIdleSeconds;
    if (session_.moving() || !current || session_.building()) return std::clamp(next_draw_ - now, 0.005, kFrameSeconds);
    if (progress.finished || session_.resting(progress)) return kIdleSeconds;
    return std::clamp(next_refinement_ - now, 0.005, kIdleSeconds);
}

void Viewer::run() {
    double last = glfwGetTime(), first_frame = 0.0;
    bool rested = false;
    while (!window_->should_close() && caught_signal == 0) {
        const double now = glfwGetTime();
        session_.advance(std::min(now - last, kLongestStep));
        last = now;
        // Drawn before the next frame is submitted: in flight every preview reaches the screen.
        draw(renderer_.progress(), now);
        if (std::optional<Frame> frame = session_.next_frame(shown_of_frame()))
            generation_ = renderer_.restart(std::move(*frame));
        if (generation_ != 0 && first_frame == 0.0) first_frame = now;
        if (auto better = session_.take_replacement()) renderer_.replace_accelerator(generation_, std::move(better));
        for (const std::string& line : session_.take_messages()) fmt::print(stderr, "glint: {}\n", line);
        const Progress progress = renderer_.progress();
        looked_at_ = looked_at_ || progress.spp_min > 0 || (first_frame > 0.0 && now - first_frame > kPatience);
        if (progress.out_of_memory && !too_large_)
            fmt::print(stderr, "glint: not enough memory for a picture of this size; still showing the one before\n");
        too_large_ = progress.out_of_memory;
        if (session_.resting(progress) != rested) renderer_.set_paused(rested = !rested);
        update_title(now);
        window_->wait_events(seconds_to_wait(progress, glfwGetTime()));
    }
}

}  // namespace

int run_viewer(const ViewerOptions& options) {
    try {
        const Scene& scene = *options.scene;
        const bool given = options.width > 0 && options.height > 0;
        const Extent size = given ? Extent{options.width, options.height} : Extent{scene.width, scene.height};
        auto window = std::make_unique<ViewerWindow>(size, !given, "glint");
        const SignalGuard guard;
        Viewer(options, std::move(window)).run();
        return caught_signal == 0 ? 0 : 128 + caught_signal;
    } catch (const WindowError& error) {
        fmt::print(stderr, "glint: {}; `glint render SCENE -o FILE` needs neither display nor OpenGL\n", error.what());
    } catch (const BlitError& error) {
        fmt::print(stderr, "glint: {}; `glint render SCENE -o FILE` needs neither display nor OpenGL\n", error.what());
    }
    return 6;
}

}  // namespace glint
