// The rule that finds a scene's origin, by random extents.
#include "core/scene_origin.h"

#include <gtest/gtest.h>

#include "tests/core/test_scene.h"

namespace glint {
namespace {

using namespace test;

TEST(SceneOrigin, S_MET_01_IsScaledWithTheScene) {
    Random random(5);
    for (int i = 0; i < 10000; ++i) {
        Aabb box;
        const double far = std::pow(10.0, random.uniform(-2, 8));
        for (int k = 0; k < 2; ++k) box.grow(glm::vec3(far * random.direction() + random.direction()));
        Aabb scaled;
        scaled.grow(0x1p20f * box.lo), scaled.grow(0x1p20f * box.hi);
        ASSERT_EQ(0x1p20 * origin_shift(box), origin_shift(scaled));
        // The centre is then within half a step, and a step is at most twice the size.
        const glm::dvec3 centre = 0.5 * (glm::dvec3(box.lo) + glm::dvec3(box.hi)) - origin_shift(box);
        const glm::dvec3 side = glm::dvec3(box.hi) - glm::dvec3(box.lo);
        const double rest = std::max(std::abs(centre.x), std::max(std::abs(centre.y), std::abs(centre.z)));
        ASSERT_LE(rest, (lies_near(box) ? 8.0 : 1.0) * (side.x + side.y + side.z));
    }
}

TEST(SceneOrigin, WhatLiesNearStaysNearWhateverIsAdded) {
    Random random(6);
    for (int i = 0; i < 10000; ++i) {
        Aabb box;
        const double far = random.uniform(0.0, 40.0);
        bool near = false;
        for (int k = 0; k < 10; ++k) {
            box.grow(glm::vec3(far * glm::dvec3(1.0, 0.3, 0.2) + std::pow(10.0, random.uniform(-2, 2)) * random.direction()));
            ASSERT_TRUE(!near || lies_near(box));
            near = lies_near(box);
        }
    }
}

}  // namespace
}  // namespace glint
