#include "app/session.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/error_bar.h"
#include "core/render_plan.h"

namespace glint {
namespace {

// The feature that a toggle key flips.
std::optional<Feature> feature_of(Action action) {
    switch (action) {
        case Action::toggle_dof: return Feature::dof;
        case Action::toggle_soft: return Feature::soft;
        case Action::toggle_fuzzy: return Feature::fuzzy;
        case Action::toggle_aa: return Feature::aa;
        default: return std::nullopt;
    }
}

std::string_view name_of(AcceleratorKind kind) { return kAcceleratorNames[static_cast<std::size_t>(kind)]; }

constexpr double kStops = 3.0;      // exposure steps a stop
constexpr double kLookSpeed = 0.8;  // radians a second of the arrow keys
constexpr double kSpeedPerNotch = 1.25;
constexpr double kMaxPixels = 1 << 23;  // a framebuffer of doubles of that size takes a quarter of a gigabyte
constexpr int kMaxSide = 8192;          // every OpenGL 3.3 driver in use has textures of that size

}  // namespace

Session::Session(std::shared_ptr<const Scene> scene, const Choices& choices, const CameraPose& camera, AcceleratorSource source)
    : scene_(std::move(scene)),
      choices_(choices),
      camera_(camera, nearest_axis(scene_->world_up())),
      source_(std::move(source)),
      first_exposure_(choices.display.exposure_ev) {}

std::string_view Session::obstacle(Action action) const {
    const FeatureSet on = choices_.settings.features;
    if (action == Action::toggle_soft && !can_act(*scene_, Feature::soft))
        return scene_->lights.empty() ? "this scene has no light" : "all lights of this scene are infinitely far";
    if (action == Action::toggle_fuzzy) {
        if (!can_act(*scene_, Feature::fuzzy)) return "this scene has no mirror";
        if (!on.has(Feature::reflections)) return "reflections are switched off";
    }
    if (action == Action::toggle_fresnel) {
        if (!can_act(*scene_, Feature::refractions)) return "this scene has no glass";
        if (!on.has(Feature::reflections) && !on.has(Feature::refractions)) return "reflections and refractions are switched off";
    }
    return {};
}

void Session::toggle(Action action) {
    if (const std::string_view reason = obstacle(action); !reason.empty()) {
        const auto rows = key_table();
        const auto row = std::ranges::find(rows, action, &KeyBinding::action);
        messages_.push_back(fmt::format("{}: {}", row->help, reason));
        return;
    }
    RenderSettings& settings = choices_.settings;
    if (const std::optional<Feature> feature = feature_of(action))
        settings.features.set(*feature, !settings.features.has(*feature));
    else
        settings.fresnel = settings.fresnel == Fresnel::exact ? Fresnel::schlick : Fresnel::exact;
}

void Session::apply(Action action) {
    // Counted in whole steps, so that as many steps back give the very same exposure.
    const auto expose = [&](int steps) {
        exposure_steps_ = std::clamp(exposure_steps_ + steps, -90, 90);
        choices_.display.exposure_ev = first_exposure_ + static_cast<float>(exposure_steps_ / kStops);
    };
    switch (action) {
        case Action::accelerator_auto: choices_.accelerator.reset(); break;
        case Action::accelerator_none: choices_.accelerator = AcceleratorKind::none; break;
        case Action::accelerator_grid: choices_.accelerator = AcceleratorKind::grid; break;
        case Action::accelerator_bvh: choices_.accelerator = AcceleratorKind::bvh; break;
        case Action::toggle_dof:
        case Action::toggle_soft:
        case Action::toggle_fuzzy:
        case Action::toggle_aa:
        case Action::toggle_fresnel: toggle(action); break;
        case Action::exposure_up: expose(1); break;
        case Action::exposure_down: expose(-1); break;
        case Action::pause: choices_.paused = !choices_.paused; break;
        case Action::restart: ++restarts_; break;
        case Action::camera_home: camera_.go_home(); break;
        default: break;
    }
}

void Session::advance(double seconds) {
    const auto down = [&](Action action) {
        return std::ranges::any_of(held_, [&](const auto& entry) { return entry.second == action; }) ? 1.0 : 0.0;
    };
    using enum Action;
    const double angle = kLookSpeed * seconds;
    camera_.look(angle * (down(look_right) - down(look_left)), angle * (down(look_up) - down(look_down)));
    camera_.move(down(move_right) - down(move_left), down(move_up) - down(move_down), down(move_forward) - down(move_back),
                 seconds, (down(fast) > 0.0 ? 4.0 : 1.0) * (down(slow) > 0.0 ? 0.25 : 1.0));
}

void Session::change_speed(double notches) { camera_.change_speed(std::pow(kSpeedPerNotch, std::clamp(notches, -40.0, 40.0))); }

void Session::resize(int width, int height) {
    const double pixels = static_cast<double>(width) * height;
    const double shrink = std::min(
        {1.0, std::sqrt(kMaxPixels / std::max(pixels, 1.0)), kMaxSide / static_cast<double>(std::max({width, height, 1}))});
    // A window that is a pixel wide stays one; only a minimised one has no picture.
    width_ = width > 0 ? std::max(1, static_cast<int>(width * shrink)) : 0;
    height_ = height > 0 ? std::max(1, static_cast<int>(height * shrink)) : 0;
}

std::shared_ptr<const AnyAccelerator> Session::wanted_accelerator() {
    std::shared_ptr<const AnyAccelerator> accelerator = source_.request(wanted_kind());
    if (!accelerator && source_.failed(wanted_kind())) {
        // Brute force needs no memory of its own, so this ends at a picture in any case.
        const AcceleratorKind fallback = accelerator_in_use().value_or(AcceleratorKind::none);
        messages_.push_back(
            fmt::format("accelerator {} is too large for this machine; using {}", name_of(wanted_kind()), name_of(fallback)));
        choices_.accelerator = fallback;
        accelerator = source_.request(fallback);
    }
    building_ = !accelerator;
    if (!accelerator && submitted_) accelerator = submitted_->accelerator;
    return accelerator;
}

std::optional<Frame> Session::next_frame(const Progress& shown) {
    const std::shared_ptr<const AnyAccelerator> accelerator = wanted_accelerator();
    if (!accelerator || width_ == 0 || height_ == 0) return std::nullopt;
    Inputs wanted{accelerator, camera_.pose(), choices_.settings, width_, height_, choices_.spp, restarts_};
    if (submitted_) {
        if (accelerator != submitted_->accelerator && kind_of(*accelerator) == kind_of(*submitted_->accelerator))
            submitted_->accelerator = replacement_ = accelerator;
        if (wanted == *submitted_) return std::nullopt;
        Inputs moved = *submitted_;
        moved.camera = wanted.camera;
        if (wanted == moved && !shown.preview_complete) return std::nullopt;
    }
    submitted_ = std::move(wanted);
    replacement_ = nullptr;
    Frame frame;
    frame.scene = scene_;
    frame.accelerator = submitted_->accelerator;
    frame.camera = submitted_->camera;
    frame.settings = submitted_->settings;
    frame.width = submitted_->width;
    frame.height = submitted_->height;
    frame.spp = submitted_->spp;
    return frame;
}

bool Session::resting(const Progress& progress) const { return choices_.paused && progress.preview_complete; }

std::optional<AcceleratorKind> Session::accelerator_in_use() const {
    if (!submitted_) return std::nullopt;
    return kind_of(*submitted_->accelerator);
}

std::string Session::title(const Progress& progress, const ErrorEstimate& error) const {
    const bool builtin = scene_->name.starts_with("builtin:");
    std::string text =
        fmt::format("glint \u2014 {}", builtin ? scene_->name : std::filesystem::path(scene_->name).filename().string());
    if (const auto kind = accelerator_in_use()) text += fmt::format(" \u2014 {}", name_of(*kind));
    if (building_) text += fmt::format(" (building {})", name_of(wanted_kind()));
    if (submitted_) {
        text += fmt::format(" \u2014 {} spp", progress.spp);
        if (progress.seconds > 0.0)
            text += fmt::format(" \u2014 {:.1f} Mrays/s", static_cast<double>(progress.rays.total()) / progress.seconds * 1e-6);
    }
    if (const std::string bar = error_text(error); !bar.empty()) text += fmt::format(" \u2014 {}", bar);
    const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    const Forecast next = forecast(error, progress, pixels, next_target(error));
    if (next.target > 0.0 && next.spp > progress.spp && next.spp <= choices_.spp && !choices_.paused)
        text += fmt::format(", {:g} in {:.0f} s", next.target, std::max(1.0, next.seconds - progress.seconds));
    text += " \u2014";
    const FeatureSet on = choices_.settings.features;
    for (std::size_t i = 0; i < kFeatureNames.size(); ++i)
        if (on.has(static_cast<Feature>(i))) text += fmt::format(" {}", kFeatureNames[i]);
    if (choices_.settings.fresnel == Fresnel::schlick) text += " schlick";
    if (progress.rays.non_finite > 0) text += fmt::format(", {} non-finite samples", progress.rays.non_finite);
    if (progress.finished && submitted_)
        text += ", converged";
    else if (choices_.paused)
        text += ", paused";
    return text;
}

std::string Session::state_of(Action action) const {
    if (const std::string_view reason = obstacle(action); !reason.empty()) return std::string(reason);
    if (const std::optional<Feature> feature = feature_of(action)) return choices_.settings.features.has(*feature) ? "on" : "off";
    const auto chosen = [&](std::optional<AcceleratorKind> kind) { return choices_.accelerator == kind ? "on" : "off"; };
    switch (action) {
        case Action::accelerator_auto: return fmt::format("{} ({})", chosen(std::nullopt), name_of(source_.automatic));
        case Action::accelerator_none: return chosen(AcceleratorKind::none);
        case Action::accelerator_grid: return chosen(AcceleratorKind::grid);
        case Action::accelerator_bvh: return chosen(AcceleratorKind::bvh);
        case Action::toggle_fresnel: return choices_.settings.fresnel == Fresnel::exact ? "exact" : "schlick";
        case Action::pause: return choices_.paused ? "on" : "off";
        case Action::exposure_up: return fmt::format("{:+.2f} stops", choices_.display.exposure_ev);
        default: return {};
    }
}

std::vector<std::string> Session::take_messages() { return std::exchange(messages_, {}); }

}  // namespace glint
