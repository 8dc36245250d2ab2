// Renders a scene to an image the way `glint render` does: for tests of whole pictures.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <memory>
#include <string>

#include "accel/isa.h"
#include "core/accelerator_cache.h"
#include "core/renderer.h"
#include "core/scene_io.h"

namespace glint {

struct Picture {
    int width = 64, height = 64, spp = 1, threads = 2;
    AcceleratorKind accelerator = AcceleratorKind::bvh;
    RenderSettings settings;
};

inline Frame frame_of(const std::shared_ptr<const Scene>& scene, const Picture& p) {
    Frame frame;
    frame.scene = scene;
    frame.accelerator = build_accelerator(p.accelerator, scene->geometry);
    frame.camera = scene->cameras.front();
    frame.settings = p.settings;
    frame.width = p.width;
    frame.height = p.height;
    frame.spp = p.spp;
    return frame;
}

inline Image render_picture(const std::shared_ptr<const Scene>& scene, const Picture& p, Progress* progress = nullptr) {
    Renderer renderer(p.threads, false);
    renderer.restart(frame_of(scene, p));
    renderer.wait(1e9, nullptr);
    Image image;
    EXPECT_TRUE(renderer.resolve(image));
    if (progress != nullptr) *progress = renderer.progress();
    return image;
}

// Calls test(isa) with each instruction set of this machine in use; accelerators built in there trace with it.
template <class Test>
void for_each_isa(Test test) {
    const Isa before = isa_in_use();
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (!supported(isa)) continue;
        use_isa(isa);
        test(isa);
    }
    use_isa(before);
}

// A scene's spec, builtin:NAME,KEY=VALUE, as a test may be called.
inline std::string test_name(const testing::TestParamInfo<const char*>& spec) {
    std::string name(spec.param + 8);
    for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    return name;
}

// Number of pixels that are not equal to the bit.
inline std::size_t differing_pixels(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) return ~std::size_t{0};
    return difference(a, b).differing;
}

}  // namespace glint
