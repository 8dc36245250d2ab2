#include "app/fly_camera.h"

#include <gtest/gtest.h>

namespace glint {
namespace {

CameraPose pose(glm::vec3 eye, glm::vec3 target, glm::vec3 up) {
    CameraPose p;
    p.eye = eye;
    p.target = target;
    p.up = up;
    p.view_angle = 37.0f;
    p.lens_radius = 0.125f;
    return p;
}

// Cameras of scenes of both conventions, leaning ones, and some that look straight up or down.
std::vector<CameraPose> poses() {
    return {pose({2.1f, 1.3f, 1.7f}, {0, 0, 0}, {0, 0, 1}),
            pose({0.1f, 2.0f, 7.0f}, {0.3f, 1.0f, 0.0f}, {0, 1, 0}),
            pose({1e6f, 2e6f, -3e6f}, {0, 0, 0}, {0, -1, 0}),
            pose({1e-6f, 3e-6f, 2e-6f}, {0, 0, 0}, {1, 0, 0}),
            pose({4, 3, 2}, {1, 1, 1}, {0.3f, 0.1f, 0.9f}),
            pose({0, 5, 0}, {0, 0, 0}, {0, 0, -1}),
            pose({0, 0, -3}, {0, 0, 9}, {0, 0, 1})};
}

FlyCamera camera(const CameraPose& p) { return {p, nearest_axis(p.up)}; }

glm::dvec3 view_of(const CameraPose& p) { return glm::normalize(glm::dvec3(p.target) - glm::dvec3(p.eye)); }

// The picture's up direction as the renderer sees it.
glm::dvec3 picture_up(const CameraPose& p) {
    const glm::dvec3 v = view_of(p), up = p.up;
    return glm::normalize(up - glm::dot(up, v) * v);
}

TEST(FlyCamera, UnmovedIsTheLoadedPoseToTheBit) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        EXPECT_EQ(c.pose(), p);
        c.look(0.0, 0.0);
        c.move(0.0, 0.0, 0.0, 1.0, 4.0);
        c.change_speed(2.0);
        EXPECT_EQ(c.pose(), p);
    }
}

TEST(FlyCamera, HomeIsTheLoadedPoseToTheBit) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        c.look(1.0, -0.3);
        c.move(1.0, 0.5, -1.0, 0.2, 1.0);
        EXPECT_NE(c.pose(), p);
        c.go_home();
        EXPECT_EQ(c.pose(), p);
    }
}

TEST(FlyCamera, FirstMoveDoesNotTurnThePicture) {
    for (const CameraPose& p : poses()) {
        const glm::dvec3 v = view_of(p);
        // Along the loaded up there is no picture up to compare.
        const bool pole = std::abs(glm::dot(v, glm::normalize(glm::dvec3(p.up)))) > 0.999;
        FlyCamera c = camera(p);
        c.move(0.0, 0.0, 1e-3, 1.0, 1.0);
        EXPECT_GT(glm::dot(view_of(c.pose()), v), 1.0 - 1e-10);
        EXPECT_GT(pole ? 1.0 : glm::dot(picture_up(c.pose()), picture_up(p)), 1.0 - 1e-10);
        EXPECT_EQ(c.pose().view_angle, p.view_angle);
        EXPECT_EQ(c.pose().lens_radius, p.lens_radius);
    }
}

TEST(FlyCamera, ForwardGoesAlongTheViewAtHalfTheTargetDistanceASecond) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        c.move(0.0, 0.0, 1.0, 1.0, 1.0);
        const glm::dvec3 way = glm::dvec3(c.pose().eye) - glm::dvec3(p.eye);
        EXPECT_NEAR(glm::length(way) / p.target_distance(), 0.5, 1e-5);
        EXPECT_GT(glm::dot(glm::normalize(way), view_of(p)), 1.0 - 1e-9);
        EXPECT_NEAR(c.pose().target_distance() / p.target_distance(), 1.0, 1e-5) << "the focus stays at its distance";
    }
}

TEST(FlyCamera, SidewaysAndUpAreAsTheUserSeesThem) {
    // From +z towards the origin with y up: right is +x.
    FlyCamera y_up = camera(pose({0, 0, 4}, {0, 0, 0}, {0, 1, 0}));
    y_up.move(1.0, 1.0, 0.0, 0.5, 1.0);
    EXPECT_EQ(y_up.pose().eye, glm::vec3(1, 1, 4));
    // From -y towards the origin with z up: right is +x.
    FlyCamera z_up = camera(pose({0, -4, 0}, {0, 0, 0}, {0, 0, 1}));
    z_up.move(1.0, -1.0, 0.0, 0.5, 1.0);
    EXPECT_EQ(z_up.pose().eye, glm::vec3(1, -4, -1));
}

TEST(FlyCamera, LookingRightAndUpTurnsThatWay) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        const glm::dvec3 up = nearest_axis(p.up);
        const glm::dvec3 right = c.right();
        c.look(0.1, 0.0);
        EXPECT_GE(glm::dot(view_of(c.pose()), right), -1e-6);
        const double height = glm::dot(view_of(c.pose()), up);
        c.look(0.0, 0.1);
        EXPECT_GT(height < 0.9 ? glm::dot(view_of(c.pose()), up) : 2.0, height) << "unless it is at the pole already";
    }
}

TEST(FlyCamera, LookingAroundAndBackIsStable) {
    for (const CameraPose& p : poses()) {
        if (std::abs(glm::dot(view_of(p), glm::dvec3(nearest_axis(p.up)))) > 0.99) continue;  // clamped at the pole
        FlyCamera c = camera(p);
        for (int i = 0; i < 1000; ++i) c.look(0.0123, i % 2 == 0 ? 1e-3 : -1e-3);
        for (int i = 0; i < 1000; ++i) c.look(-0.0123, i % 2 == 0 ? -1e-3 : 1e-3);
        EXPECT_EQ(c.pose().eye, p.eye);
        EXPECT_GT(glm::dot(view_of(c.pose()), view_of(p)), 1.0 - 1e-9);
        EXPECT_GT(glm::dot(picture_up(c.pose()), picture_up(p)), 1.0 - 1e-9);
    }
}

TEST(FlyCamera, NeverLooksOverThePoles) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        for (const double sign : {1.0, -1.0}) {
            for (int i = 0; i < 100; ++i) c.look(0.01, 0.1 * sign);
            const glm::dvec3 up = nearest_axis(p.up);
            EXPECT_GT(sign * glm::dot(view_of(c.pose()), up), 0.99);
            EXPECT_LT(sign * glm::dot(view_of(c.pose()), up), 1.0);
        }
    }
}

TEST(FlyCamera, SpeedScalesWithTheScene) {
    const CameraPose small = pose({0, 0, 4}, {0, 0, 0}, {0, 1, 0});
    CameraPose large = small;
    large.eye *= 1024.0f;
    FlyCamera a = camera(small), b = camera(large);
    EXPECT_EQ(b.speed(), 1024.0 * a.speed());
    a.change_speed(2.0);
    EXPECT_EQ(b.speed(), 512.0 * a.speed());
}

TEST(FlyCamera, StaysFiniteHoweverFarItFlies) {
    for (const CameraPose& p : poses()) {
        FlyCamera c = camera(p);
        c.change_speed(1e9);
        for (int i = 0; i < 100; ++i) c.move(1.0, 1.0, 1.0, 1e12, 4.0);
        EXPECT_TRUE(std::isfinite(c.pose().target_distance()));
        EXPECT_NE(c.pose().eye, c.pose().target);
    }
}

}  // namespace
}  // namespace glint
