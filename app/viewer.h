// The interactive viewer: a window on a converging picture that the user flies through.
// Knows no options' syntax; main hands it finished choices. Errors of the display end in an exit code, not in an exception.
#pragma once

#include <memory>
#include <optional>

#include "core/renderer.h"

namespace glint {

struct ViewerOptions {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings;
    DisplaySettings display;
    std::optional<CameraPose> camera;            // empty: the scene's first
    std::optional<AcceleratorKind> accelerator;  // empty: auto
    int width = 0, height = 0;                   // of the window; 0: the scene's size, made to fit the monitor
    int spp = 4096;
    int threads = 1;
};

// Returns the exit code: 0 when the user closed the window, 6 without display or OpenGL (one line on stderr says so and
// names `glint render`), 128 + n when signal n closed it. Paths of screenshots go to stdout, all else to stderr.
[[nodiscard]] int run_viewer(const ViewerOptions& options);

}  // namespace glint
