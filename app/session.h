// What the user of the viewer wants, and the frames that follow from it.
// Knows no window, no GL, no threads and no clock: the viewer hands in actions, elapsed seconds and the renderer's progress.
// Invariant: restart is derived. A frame is due exactly when the wanted inputs differ from the submitted ones, so no
// action can forget to ask for it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/fly_camera.h"
#include "app/keys.h"
#include "core/renderer.h"

namespace glint {

// Where accelerators come from; in the viewer an AcceleratorCache. None of the calls waits.
struct AcceleratorSource {
    AcceleratorKind automatic = AcceleratorKind::bvh;  // what `auto` means for this scene
    // Null while it is being built; may be followed by a better one of its kind.
    std::function<std::shared_ptr<const AnyAccelerator>(AcceleratorKind)> request;
    std::function<bool(AcceleratorKind)> failed;  // true when it can never be built
};

// What the user may choose; everything here may be changed by an action.
struct Choices {
    RenderSettings settings;
    DisplaySettings display;
    std::optional<AcceleratorKind> accelerator;  // empty = auto
    int spp = 4096;
    bool paused = false;

    bool operator==(const Choices&) const = default;
};

class Session {
public:
    Session(std::shared_ptr<const Scene> scene, const Choices& choices, const CameraPose& camera, AcceleratorSource source);

    // One press of a key. Actions that need a window (help, screenshot, quit) and held ones do nothing here.
    void apply(Action action);
    // Keys that act while they are down, by the code of the key, so that left and right Shift do not release each other.
    void hold(int key, Action action) { held_[key] = action; }
    void release(int key) { held_.erase(key); }
    void release_all() { held_.clear(); }
    // Moves the camera by what is held, `seconds` long.
    void advance(double seconds);
    [[nodiscard]] bool moving() const { return !held_.empty(); }
    void look(double right_radians, double up_radians) { camera_.look(right_radians, up_radians); }
    void change_speed(double notches);
    // The size of the window's framebuffer in pixels; 0 x 0 when minimised. Larger than the cap: the picture is smaller.
    void resize(int width, int height);

    // The frame to submit now, if one is due. A new camera alone waits until at least the preview of the submitted frame
    // was shown, so that a continuous flight shows pictures; everything else is due at once.
    // shown: the progress of the submitted frame when it was last drawn; fresh when it was not drawn yet.
    [[nodiscard]] std::optional<Frame> next_frame(const Progress& shown);
    // An accelerator of the submitted frame's kind that the frame should go on with, since the last call: a better tree, and
    // the same bits, so no frame is due for it.
    [[nodiscard]] std::shared_ptr<const AnyAccelerator> take_replacement() { return std::exchange(replacement_, nullptr); }
    // Whether the workers should rest: paused, and the preview of the latest frame is complete.
    [[nodiscard]] bool resting(const Progress& progress) const;
    // Whether an accelerator is still being built, so that next_frame() should be asked again soon.
    [[nodiscard]] bool building() const { return building_; }

    [[nodiscard]] const Choices& choices() const { return choices_; }
    [[nodiscard]] const CameraPose& camera() const { return camera_.pose(); }
    [[nodiscard]] const Scene& scene() const { return *scene_; }
    // The accelerator of the submitted frame; empty before the first frame.
    [[nodiscard]] std::optional<AcceleratorKind> accelerator_in_use() const;
    [[nodiscard]] std::string title(const Progress& progress, const ErrorEstimate& error = {}) const;
    // For the help: "on", "off", a value, or why the setting cannot act in this scene; empty where there is no state.
    [[nodiscard]] std::string state_of(Action action) const;
    // Lines for the user since the last call, for example why a toggle cannot act.
    [[nodiscard]] std::vector<std::string> take_messages();

private:
    // Everything that decides the samples. Two equal ones need no restart.
    struct Inputs {
        std::shared_ptr<const AnyAccelerator> accelerator;
        CameraPose camera;
        RenderSettings settings;
        int width = 0, height = 0, spp = 0;
        std::uint64_t restarts = 0;  // how often the user asked for one

        bool operator==(const Inputs&) const = default;
    };

    // Why the setting behind the action has nothing to act on in this scene; empty when it has.
    [[nodiscard]] std::string_view obstacle(Action action) const;
    void toggle(Action action);
    [[nodiscard]] AcceleratorKind wanted_kind() const { return choices_.accelerator.value_or(source_.automatic); }
    [[nodiscard]] std::shared_ptr<const AnyAccelerator> wanted_accelerator();

    std::shared_ptr<const Scene> scene_;
    Choices choices_;
    FlyCamera camera_;
    AcceleratorSource source_;
    float first_exposure_;
    int exposure_steps_ = 0;  // thirds of a stop
    int width_ = 0, height_ = 0;
    std::uint64_t restarts_ = 0;
    std::map<int, Action> held_;
    std::optional<Inputs> submitted_;
    std::shared_ptr<const AnyAccelerator> replacement_;
    bool building_ = false;
    std::vector<std::string> messages_;
};

}  // namespace glint
