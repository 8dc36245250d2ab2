// Cameras and lights of a glTF file, and what is made up where it has none.
#include <cmath>
#include <numbers>

#include "gltf_fixture.h"

namespace glint::test {
namespace {

class GltfView : public GltfTest {
protected:
    // The triangle, and a node with `camera` at `place`.
    json with_camera(const json& camera, const json& place) const {
        json d = triangle();
        d["cameras"] = {camera};
        d["nodes"].push_back(place);
        d["nodes"][1]["camera"] = 0;
        d["scenes"][0]["nodes"] = {0, 1};
        return d;
    }
    json with_light(const json& light, const json& place) const {
        json d = triangle();
        d["extensions"]["KHR_lights_punctual"]["lights"] = {light};
        d["nodes"].push_back(place);
        d["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
        d["scenes"][0]["nodes"] = {0, 1};
        return d;
    }
};

const json kPerspective{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}};

TEST_F(GltfView, ACameraLooksAlongItsNodesMinusZ) {
    const auto scene = load(with_camera(kPerspective, {{"translation", {0.5, 0.5, 4}}}));
    ASSERT_EQ(scene->cameras.size(), 1u);
    const CameraPose& c = scene->cameras[0];
    EXPECT_EQ(c.eye, glm::vec3(0.5, 0.5, 4));
    EXPECT_LT(glm::length(c.target - glm::vec3(0.5, 0.5, 0)), 1e-6f);  // at the distance of the scene's middle
    EXPECT_EQ(c.up, glm::vec3(0, 1, 0));
    EXPECT_NEAR(c.view_angle, 0.5 * 180.0 / std::numbers::pi, 1e-5);
    EXPECT_FALSE(warned(*scene, "no camera"));

    // Turned a quarter to the left and scaled: looks along -x, the scale is ignored.
    const auto turned = load(with_camera(
        kPerspective, {{"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}, {"scale", {3, 3, 3}}, {"translation", {9, 0, 0}}}));
    const CameraPose& t = turned->cameras[0];
    EXPECT_LT(glm::length(glm::normalize(t.target - t.eye) - glm::vec3(-1, 0, 0)), 1e-6f);
    EXPECT_NEAR(glm::length(t.up), 1.0f, 1e-6f);
}

TEST_F(GltfView, CamerasStandInTheOrderOfTheirNodes) {
    json d = with_camera(kPerspective, {{"translation", {1, 0, 5}}});
    for (const double x : {2.0, 3.0}) d["nodes"].push_back({{"camera", 0}, {"translation", {x, 0, 5}}});
    d["scenes"][0]["nodes"] = {3, 0, 2, 1};
    const auto scene = load(d);
    ASSERT_EQ(scene->cameras.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(scene->cameras[i].eye.x, static_cast<float>(i + 1));
}

TEST_F(GltfView, AnOrthographicCameraSeesAboutTheSame) {
    const json orthographic{{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}};
    const auto scene = load(with_camera(orthographic, {{"translation", {0, 0, 4}}}));
    EXPECT_TRUE(warned(*scene, "orthographic"));
    const CameraPose& c = scene->cameras[0];
    EXPECT_NEAR(std::tan(c.view_angle / 2 * std::numbers::pi / 180.0) * 4.0, 2.0, 1e-5);
}

TEST_F(GltfView, CamerasWithoutSenseAreReplaced) {
    json d = with_camera(kPerspective, {{"scale", {0, 0, 0}}});
    EXPECT_TRUE(warned(*load(d), "no camera"));
    for (const double angle : {0.0, -1.0, 3.2, 1e300}) {
        d = with_camera(kPerspective, {{"translation", {0, 0, 4}}});
        d["cameras"][0]["perspective"]["yfov"] = angle;
        EXPECT_EQ(load(d)->cameras[0].view_angle, 45.0f);
    }
    d = with_camera(kPerspective, {{"translation", {0, 0, 1e9}}});
    const CameraPose far = load(d)->cameras[0];
    EXPECT_NE(far.eye, far.target);
}

TEST_F(GltfView, WithoutACameraEverythingJustFitsIntoThePicture) {
    for (const float size : {1e-6f, 1.0f, 1e6f}) {
        for (const glm::vec3 stretch : {glm::vec3(1, 1, 1), glm::vec3(20, 1, 1), glm::vec3(1, 20, 1), glm::vec3(1, 1, 20)}) {
            const glm::vec3 s = size * stretch;
            const auto scene = load(with_mesh(triangle(), {0, 0, 0, s.x, 0, 0, 0, s.y, 0, 0, 0, s.z}, {0, 1, 2, 0, 2, 3}));
            EXPECT_TRUE(warned(*scene, "no camera"));
            const CameraPose& c = scene->cameras.at(0);
            const glm::vec3 back = glm::normalize(c.eye - c.target), right = glm::normalize(glm::cross(c.up, back)),
                            up = glm::cross(back, right);
            const float half = std::tan(c.view_angle / 2 * std::numbers::pi_v<float> / 180);
            float largest = 0.0f;
            for (const glm::vec3 v : scene->geometry->vertices) {
                const float depth = glm::dot(c.eye - v, back);
                EXPECT_GT(depth, 0.0f);
                const float x = std::abs(glm::dot(v - c.eye, right)) / (depth * half * 4 / 3),
                            y = std::abs(glm::dot(v - c.eye, up)) / (depth * half);
                largest = std::max(largest, std::max(x, y));
            }
            EXPECT_NEAR(largest, 1.0f / 1.08f, 1e-4f);
        }
    }
}

TEST_F(GltfView, PunctualLightsKeepTheirNumbers) {
    const auto spot = load(
        with_light({{"type", "spot"},
                    {"color", {1, 0.5, 0}},
                    {"intensity", 40},
                    {"range", 7},
                    {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
                   {{"translation", {0, 5, 0}}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}, {"scale", {2, 2, 2}}}));
    ASSERT_EQ(spot->lights.size(), 1u);
    const Light& l = spot->lights[0];
    EXPECT_EQ(l.shape, Light::Shape::point);
    EXPECT_EQ(l.falloff, Light::Falloff::physical);
    EXPECT_EQ(l.position, glm::vec3(0, 5, 0));
    EXPECT_LT(glm::length(l.direction - glm::vec3(0, -1, 0)), 1e-6f);
    EXPECT_EQ(l.emission, glm::vec3(40, 20, 0));
    EXPECT_EQ(l.range, 7.0f);
    EXPECT_FLOAT_EQ(l.cos_inner, std::cos(0.2f));
    EXPECT_FLOAT_EQ(l.cos_outer, std::cos(0.6f));
    EXPECT_FALSE(warned(*spot, "no light"));

    const Light point = load(with_light({{"type", "point"}}, json::object()))->lights.at(0);
    EXPECT_EQ(point.emission, glm::vec3(1.0f));
    EXPECT_LT(point.cos_outer, -1.0f);
    const Light sun = load(with_light({{"type", "directional"}, {"intensity", 3}}, json::object()))->lights.at(0);
    EXPECT_EQ(sun.shape, Light::Shape::directional);
    EXPECT_EQ(sun.direction, glm::vec3(0, 0, -1));
    EXPECT_EQ(sun.emission, glm::vec3(3.0f));
}

TEST_F(GltfView, LightsThatMakeNoSenseAreSaidOrRefused) {
    json d = with_light({{"type", "point"}}, json::object());
    for (const json& index : {json(1), json(-1), json("0"), json(nullptr)}) {
        d["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = index;
        expect_refused(d, "names no light");
    }
    const auto negative = load(with_light({{"type", "point"}, {"intensity", -5}, {"range", -1}}, json::object()));
    EXPECT_TRUE(warned(*negative, "intensity"));
    EXPECT_EQ(negative->lights.at(0).emission, glm::vec3(0.0f));
    EXPECT_EQ(negative->lights.at(0).range, 0.0f);
    const auto wide =
        load(with_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 2}, {"outerConeAngle", 9}}}}, json::object()));
    EXPECT_TRUE(warned(*wide, "outerConeAngle"));
    EXPECT_GT(wide->lights.at(0).cos_inner, wide->lights.at(0).cos_outer);
    EXPECT_TRUE(warned(*load(with_light({{"type", "laser"}}, json::object())), "neither point"));
}

TEST_F(GltfView, WithoutALightASunShinesOnWhatTheCameraSees) {
    const auto scene = load(triangle());
    EXPECT_TRUE(warned(*scene, "no light"));
    EXPECT_EQ(scene->environment.kind, Environment::Kind::sky);
    ASSERT_FALSE(scene->lights.empty());
    const CameraPose& c = scene->cameras.at(0);
    for (const Light& l : scene->lights) {
        EXPECT_EQ(l.shape, Light::Shape::directional);
        EXPECT_NEAR(glm::length(l.direction), 1.0f, 1e-6f);
        EXPECT_GT(glm::dot(l.direction, c.target - c.eye), 0.0f);
    }
    // Straight down, where `up` has no right side.
    const auto above =
        load(with_camera(kPerspective, {{"translation", {0, 9, 0}}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}}));
    for (const Light& l : above->lights) EXPECT_TRUE(std::isfinite(l.direction.x + l.direction.y + l.direction.z));
}

}  // namespace
}  // namespace glint::test
