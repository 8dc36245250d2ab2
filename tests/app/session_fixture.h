// A session over a scene with one ball, whose accelerators are ready when the test says so. Knows no window and no renderer.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "app/session.h"

namespace glint {

// A ball of the given material under a point light.
inline std::shared_ptr<const Scene> ball(const Material& material, bool light = true) {
    SceneBuilder builder;
    builder.add(Sphere{{0, 0, 0}, 1.0f}, builder.add_material(material));
    builder.scene().name = "some/folder/ball.p3f";
    builder.scene().cameras.push_back(CameraPose{});
    if (light) builder.scene().lights.push_back(Light{});
    return builder.finish();
}

inline Material mirror(float mirror) {
    Material m;
    m.mirror = glm::vec3(mirror);
    return m;
}

inline Material glass() {
    Material m;
    m.glass = true;
    m.ior = 1.5f;
    return m;
}

// Accelerators that are ready when the test says so.
struct Builds {
    std::shared_ptr<const Scene> scene;
    std::array<std::shared_ptr<const AnyAccelerator>, 3> ready;
    std::array<bool, 3> failed{};

    void finish(AcceleratorKind kind) { ready[static_cast<std::size_t>(kind)] = build_accelerator(kind, scene->geometry); }
    AcceleratorSource source() {
        return {AcceleratorKind::bvh, [this](AcceleratorKind k) { return ready[static_cast<std::size_t>(k)]; },
                [this](AcceleratorKind k) { return failed[static_cast<std::size_t>(k)]; }};
    }
};

class SessionTest : public testing::Test {
protected:
    SessionTest() { use(ball(mirror(0.5f))); }

    void use(std::shared_ptr<const Scene> scene) {
        builds.scene = scene;
        for (const auto kind : {AcceleratorKind::none, AcceleratorKind::grid, AcceleratorKind::bvh}) builds.finish(kind);
        Choices choices;
        choices.settings.features = features_of(*scene);
        session = std::make_unique<Session>(scene, choices, scene->cameras[0], builds.source());
        session->resize(64, 48);
    }
    // What the screen shows once the submitted frame has its preview.
    static Progress preview() {
        Progress p;
        p.preview_complete = true;
        return p;
    }

    Builds builds;
    std::unique_ptr<Session> session;
};

}  // namespace glint
