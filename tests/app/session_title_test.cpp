// What the window's title says.
#include "app/session.h"

#include <gtest/gtest.h>

#include "tests/app/session_fixture.h"

namespace glint {
namespace {

TEST_F(SessionTest, TitleTellsTheErrorAndWhenTheNextTargetIsReached) {
    const std::optional<Frame> frame = session->next_frame({});
    ASSERT_TRUE(frame);
    ErrorEstimate e;
    e.kind = ErrorEstimate::Kind::estimated;
    e.spp = 64, e.relrmse = 0.04, e.low = 0.036, e.high = 0.044, e.cautious = 0.05, e.slope = 1.0;
    // Ten seconds for 64 samples of every pixel; a target of 0.02 takes 2.5 times as many, at the next doubling.
    Progress p{.spp = 64, .seconds = 10.0, .rays = {}};
    p.rays.camera = 64ull * static_cast<unsigned>(frame->width * frame->height);
    const std::string title = session->title(p, e);
    EXPECT_NE(title.find("relRMSE 0.0400 \u00b1 0.0040, 0.02 in 30 s"), std::string::npos) << title;
    EXPECT_EQ(session->title(p).find("relRMSE"), std::string::npos);
}

TEST_F(SessionTest, TitleNamesSceneAcceleratorSamplesSpeedAndFeatures) {
    ASSERT_TRUE(session->next_frame({}));
    Progress p{.spp = 37, .seconds = 2.0, .rays = {}};
    p.rays.camera = 10'200'000;
    const std::string title = session->title(p);
    for (const char* part :
         {"glint \u2014 ball.p3f \u2014 bvh \u2014 37 spp \u2014 5.1 Mrays/s \u2014 aa", "shadows", "reflections"})
        EXPECT_NE(title.find(part), std::string::npos) << title;
    EXPECT_EQ(title.find("dof"), std::string::npos) << title;
    EXPECT_EQ(title.find("converged"), std::string::npos) << title;
    p.finished = true;
    session->apply(Action::toggle_dof);
    EXPECT_NE(session->title(p).find("dof"), std::string::npos);
    EXPECT_NE(session->title(p).find("converged"), std::string::npos);
    session->apply(Action::pause);
    p.finished = false;
    EXPECT_NE(session->title(p).find("paused"), std::string::npos);
}

}  // namespace
}  // namespace glint
