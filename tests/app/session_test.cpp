#include "app/session.h"

#include <gtest/gtest.h>

#include "tests/app/session_fixture.h"

namespace glint {
namespace {

TEST_F(SessionTest, FirstFrameCarriesWhatIsWanted) {
    const auto frame = session->next_frame({});
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->scene, builds.scene);
    EXPECT_EQ(frame->accelerator, builds.ready[2]);
    EXPECT_EQ(frame->camera, builds.scene->cameras[0]);
    EXPECT_EQ(frame->settings, session->choices().settings);
    EXPECT_EQ(frame->width, 64);
    EXPECT_EQ(frame->height, 48);
    EXPECT_EQ(frame->spp, 4096);
    EXPECT_FALSE(session->next_frame({})) << "nothing changed";
}

TEST_F(SessionTest, EachFeatureKeyChangesExactlyItsFeatureAndBack) {
    const std::pair<Action, Feature> keys[] = {{Action::toggle_dof, Feature::dof},
                                               {Action::toggle_soft, Feature::soft},
                                               {Action::toggle_fuzzy, Feature::fuzzy},
                                               {Action::toggle_aa, Feature::aa}};
    for (const auto& [action, feature] : keys) {
        const Choices before = session->choices();
        Choices expected = before;
        expected.settings.features.bits ^= 1u << static_cast<unsigned>(feature);
        session->apply(action);
        EXPECT_EQ(session->choices(), expected);
        EXPECT_EQ(session->state_of(action), expected.settings.features.has(feature) ? "on" : "off");
        session->apply(action);
        EXPECT_EQ(session->choices(), before);
    }
    EXPECT_TRUE(session->take_messages().empty());
}

TEST_F(SessionTest, EveryOtherKeyChangesExactlyItsSetting) {
    const auto changed = [&](Action action, auto change) {
        Choices expected = session->choices();
        change(expected);
        session->apply(action);
        EXPECT_EQ(session->choices(), expected) << static_cast<int>(action);
    };
    changed(Action::accelerator_none, [](Choices& c) { c.accelerator = AcceleratorKind::none; });
    changed(Action::accelerator_grid, [](Choices& c) { c.accelerator = AcceleratorKind::grid; });
    changed(Action::accelerator_bvh, [](Choices& c) { c.accelerator = AcceleratorKind::bvh; });
    changed(Action::accelerator_auto, [](Choices& c) { c.accelerator.reset(); });
    changed(Action::pause, [](Choices& c) { c.paused = true; });
    changed(Action::pause, [](Choices& c) { c.paused = false; });
    changed(Action::exposure_up, [](Choices& c) { c.display.exposure_ev = 1.0f / 3.0f; });
    changed(Action::exposure_down, [](Choices& c) { c.display.exposure_ev = 0.0f; });
    changed(Action::help, [](Choices&) {});
    changed(Action::screenshot, [](Choices&) {});
    changed(Action::quit, [](Choices&) {});
    changed(Action::move_forward, [](Choices&) {});
    use(ball(glass()));
    changed(Action::toggle_fresnel, [](Choices& c) { c.settings.fresnel = Fresnel::schlick; });
    changed(Action::toggle_fresnel, [](Choices& c) { c.settings.fresnel = Fresnel::exact; });
}

TEST_F(SessionTest, ToggleThatCannotActSaysWhyAndChangesNothing) {
    use(ball(mirror(0.0f), false));
    (void)session->next_frame({});
    const Choices before = session->choices();
    const std::pair<Action, std::string> cases[] = {
        {Action::toggle_fuzzy, "mirror"}, {Action::toggle_soft, "light"}, {Action::toggle_fresnel, "glass"}};
    for (const auto& [action, word] : cases) {
        session->apply(action);
        EXPECT_EQ(session->choices(), before);
        const auto lines = session->take_messages();
        ASSERT_EQ(lines.size(), 1u);
        EXPECT_NE(lines[0].find(word), std::string::npos) << lines[0];
        EXPECT_NE(session->state_of(action).find(word), std::string::npos);
    }
    EXPECT_FALSE(session->next_frame({}));
}

TEST_F(SessionTest, EveryChangeOfTheSamplesRestartsAtOnce) {
    use(ball(glass()));
    ASSERT_TRUE(session->next_frame({}));
    // No preview was shown yet: only a camera would wait for that.
    for (const Action action : {Action::toggle_dof, Action::toggle_soft, Action::toggle_aa, Action::toggle_fresnel,
                                Action::accelerator_grid, Action::accelerator_none, Action::restart}) {
        session->apply(action);
        EXPECT_TRUE(session->next_frame({})) << static_cast<int>(action);
        EXPECT_FALSE(session->next_frame({})) << static_cast<int>(action);
    }
    session->resize(65, 48);
    const auto frame = session->next_frame({});
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->width, 65);
}

TEST_F(SessionTest, WhatOnlyTheDisplayShowsDoesNotRestart) {
    ASSERT_TRUE(session->next_frame({}));
    for (const Action action : {Action::exposure_up, Action::pause, Action::help, Action::screenshot, Action::accelerator_bvh}) {
        session->apply(action);
        EXPECT_FALSE(session->next_frame(preview())) << static_cast<int>(action);
    }
}

TEST_F(SessionTest, ToggleThereAndBackBeforeTheNextFrameDoesNotRestart) {
    ASSERT_TRUE(session->next_frame({}));
    session->apply(Action::toggle_dof);
    session->apply(Action::toggle_dof);
    EXPECT_FALSE(session->next_frame(preview()));
}

TEST_F(SessionTest, CameraAloneWaitsUntilThePreviewWasShown) {
    ASSERT_TRUE(session->next_frame({}));
    session->hold('W', Action::move_forward);
    session->advance(0.1);
    EXPECT_FALSE(session->next_frame({}));
    session->advance(0.1);
    const auto frame = session->next_frame(preview());
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->camera, session->camera()) << "the latest camera, not the one that waited";
    session->advance(0.1);
    EXPECT_FALSE(session->next_frame({}));
    session->apply(Action::toggle_aa);
    EXPECT_TRUE(session->next_frame({})) << "with another change it need not wait";
}

TEST_F(SessionTest, OldAcceleratorStaysUntilTheWantedOneIsBuilt) {
    builds.ready[1] = nullptr;
    ASSERT_TRUE(session->next_frame({}));
    session->apply(Action::accelerator_grid);
    EXPECT_FALSE(session->next_frame(preview()));
    EXPECT_TRUE(session->building());
    EXPECT_EQ(session->accelerator_in_use(), AcceleratorKind::bvh);
    session->apply(Action::toggle_dof);
    const auto meanwhile = session->next_frame(preview());
    ASSERT_TRUE(meanwhile) << "other changes go on with the old one";
    EXPECT_EQ(meanwhile->accelerator, builds.ready[2]);
    builds.finish(AcceleratorKind::grid);
    const auto frame = session->next_frame({});
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->accelerator, builds.ready[1]);
    EXPECT_FALSE(session->building());
}

TEST_F(SessionTest, NoFrameBeforeTheFirstAcceleratorIsBuilt) {
    builds.ready[2] = nullptr;
    EXPECT_FALSE(session->next_frame({}));
    EXPECT_NE(session->title({}).find("building bvh"), std::string::npos);
    builds.finish(AcceleratorKind::bvh);
    EXPECT_TRUE(session->next_frame({}));
}

TEST_F(SessionTest, AcceleratorWithoutMemoryFallsBackAndSaysSo) {
    ASSERT_TRUE(session->next_frame({}));
    builds.ready[1] = nullptr;
    builds.failed[1] = true;
    session->apply(Action::accelerator_grid);
    EXPECT_FALSE(session->next_frame(preview())) << "the old picture goes on";
    EXPECT_EQ(session->choices().accelerator, AcceleratorKind::bvh);
    EXPECT_EQ(session->take_messages().size(), 1u);
    EXPECT_FALSE(session->building());
}

TEST_F(SessionTest, MinimisedWindowAsksForNothingAndAHugeOneForLess) {
    session->resize(0, 0);
    EXPECT_FALSE(session->next_frame({}));
    session->resize(20000, 10000);
    const auto frame = session->next_frame({});
    ASSERT_TRUE(frame);
    EXPECT_LE(frame->width * frame->height, 1 << 23);
    EXPECT_NEAR(frame->width / static_cast<double>(frame->height), 2.0, 0.01);
    session->resize(100000, 1);
    const auto strip = session->next_frame({});
    ASSERT_TRUE(strip);
    EXPECT_GE(strip->height, 1);
    EXPECT_LE(strip->width, 8192);
}

TEST_F(SessionTest, HeldKeysMoveUntilReleasedAndFocusLossReleasesAll) {
    const glm::vec3 start = session->camera().eye;
    session->hold('W', Action::move_forward);
    session->hold(340, Action::fast);
    session->hold(344, Action::fast);
    session->release(340);
    session->advance(0.1);
    const float fast = glm::length(session->camera().eye - start);
    session->release(344);
    const glm::vec3 from = session->camera().eye;
    session->advance(0.1);
    EXPECT_NEAR(fast / glm::length(session->camera().eye - from), 4.0, 1e-3) << "the other Shift was still down";
    session->release_all();
    const CameraPose rest = session->camera();
    session->advance(10.0);
    EXPECT_EQ(session->camera(), rest);
    EXPECT_FALSE(session->moving());
    session->apply(Action::camera_home);
    EXPECT_EQ(session->camera(), builds.scene->cameras[0]);
}

TEST_F(SessionTest, OppositeKeysCancelOut) {
    session->hold('A', Action::move_left);
    session->hold('D', Action::move_right);
    session->advance(1.0);
    EXPECT_EQ(session->camera(), builds.scene->cameras[0]);
}

TEST_F(SessionTest, ExposureStepsBackToTheStart) {
    for (int i = 0; i < 7; ++i) session->apply(Action::exposure_up);
    for (int i = 0; i < 7; ++i) session->apply(Action::exposure_down);
    EXPECT_EQ(session->choices().display, DisplaySettings{});
}

TEST_F(SessionTest, PausedWorkersStillMakeThePreviewOfAChange) {
    session->apply(Action::pause);
    EXPECT_FALSE(session->resting({}));
    EXPECT_TRUE(session->resting(preview()));
    session->apply(Action::pause);
    EXPECT_FALSE(session->resting(preview()));
}

}  // namespace
}  // namespace glint
