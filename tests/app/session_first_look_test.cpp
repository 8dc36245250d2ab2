// A better tree takes the place of the first one without a new frame.
#include "app/session.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

class FirstLook : public testing::Test {
protected:
    FirstLook() {
        SceneBuilder builder;
        builder.add(Sphere{{0, 0, 0}, 1.0f}, builder.add_material(Material{}));
        builder.scene().cameras.push_back(CameraPose{});
        scene = builder.finish();
        fast = build_accelerator(AcceleratorKind::bvh, scene->geometry, serial_for, BuildQuality::fast);
        best = build_accelerator(AcceleratorKind::bvh, scene->geometry);
        grid = build_accelerator(AcceleratorKind::grid, scene->geometry);
        ready = fast;
        const auto request = [this](AcceleratorKind kind) { return kind == AcceleratorKind::grid ? grid : ready; };
        session =
            std::make_unique<Session>(scene, Choices{}, scene->cameras[0],
                                      AcceleratorSource{AcceleratorKind::bvh, request, [](AcceleratorKind) { return false; }});
        session->resize(64, 48);
    }
    static Progress preview() {
        Progress p;
        p.preview_complete = true;
        return p;
    }

    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AnyAccelerator> fast, best, grid, ready;
    std::unique_ptr<Session> session;
};

TEST_F(FirstLook, TheBetterTreeReplacesTheFirstAndNoFrameIsDue) {
    const auto frame = session->next_frame({});
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->accelerator, fast);
    EXPECT_EQ(session->take_replacement(), nullptr);
    ready = best;
    EXPECT_FALSE(session->next_frame(preview())) << "nothing restarts";
    EXPECT_EQ(session->take_replacement(), best);
    EXPECT_EQ(session->take_replacement(), nullptr) << "once";
    EXPECT_FALSE(session->next_frame(preview()));
    EXPECT_EQ(session->take_replacement(), nullptr);
}

TEST_F(FirstLook, AFrameThatIsDueAnywayCarriesTheBetterTree) {
    ASSERT_TRUE(session->next_frame({}));
    ready = best;
    session->apply(Action::restart);
    const auto frame = session->next_frame(preview());
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->accelerator, best);
    EXPECT_EQ(session->take_replacement(), nullptr);
}

TEST_F(FirstLook, ItIsReplacedWhileACameraAloneWaitsForItsPreview) {
    ASSERT_TRUE(session->next_frame({}));
    session->look(0.1, 0.0);
    ready = best;
    EXPECT_FALSE(session->next_frame({}));
    EXPECT_EQ(session->take_replacement(), best);
    const auto moved = session->next_frame(preview());
    ASSERT_TRUE(moved);
    EXPECT_EQ(moved->accelerator, best);
}

TEST_F(FirstLook, AnotherKindStillRestartsSoThatItsSpeedCanBeSeen) {
    ASSERT_TRUE(session->next_frame({}));
    session->apply(Action::accelerator_grid);
    const auto frame = session->next_frame(preview());
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->accelerator, grid);
    EXPECT_EQ(session->take_replacement(), nullptr);
}

}  // namespace
}  // namespace glint
