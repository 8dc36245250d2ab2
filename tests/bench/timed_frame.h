// A picture rendered by the renderer in this process, and how long it took.
// Knows no other renderer and no table. Seconds are those of the renderer's own clock: from restart() to the last sample.
#pragma once

#include <limits>
#include <stdexcept>

#include "core/renderer.h"

namespace glint::bench {

// The whole picture of the scene's own camera, as the renderer takes it.
[[nodiscard]] inline Frame frame_of(std::shared_ptr<const Scene> scene, std::shared_ptr<const AnyAccelerator> accelerator,
                                    const RenderSettings& settings, int width, int height, int spp) {
    const CameraPose camera = scene->cameras.front();
    return {std::move(scene), std::move(accelerator), camera, settings, width, height, 0, 0, width, height, spp};
}

// Progress of the finished frame.
[[nodiscard]] inline Progress render(Renderer& renderer, Frame frame) {
    renderer.restart(std::move(frame));
    Progress p = renderer.progress();
    while (!p.finished) {
        if (p.out_of_memory) throw std::bad_alloc();
        renderer.wait(std::numeric_limits<double>::infinity(), nullptr);
        p = renderer.progress();
    }
    return p;
}

}  // namespace glint::bench
