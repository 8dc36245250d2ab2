// One tree, byte for byte, whoever builds it: the picture must not know how many threads there were.
#include <cstring>
#include <stdexcept>

#include <gtest/gtest.h>

#include "accel/accelerator.h"
#include "tests/accel/adversarial_scenes.h"
#include "tests/accel/bvh_survey.h"
#include "tests/accel/schedules.h"

namespace glint {
namespace {

// Blocks of some kinds end in bytes that nobody writes or reads; here they are zero.
void blank_padding(BvhTree& tree, BvhRef index = 0) {
    if (tree.units.empty()) return;
    const BvhNode node = *reinterpret_cast<const BvhNode*>(tree.units[index].bytes);
    for (int k = 0; k < kBvhWidth; ++k) {
        if (absent(node, k)) continue;
        if (!is_leaf(node.child[k])) {
            blank_padding(tree, node.child[k]);
            continue;
        }
        const auto [used, size] = block_bytes(static_cast<PrimitiveKind>(leaf_kind(node.child[k])));
        std::memset(tree.units[node.child[k] & kUnitMask].bytes + used, 0, size - used);
    }
}

void expect_one_tree(const Geometry& g) {
    BvhTree expected = build_bvh(g);
    blank_padding(expected);
    for (const ParallelFor& parallel_for : {ParallelFor(shuffled_for), ParallelFor(on_four_threads)}) {
        BvhTree tree = build_bvh(g, parallel_for);
        blank_padding(tree);
        ASSERT_EQ(tree.units.size(), expected.units.size());
        EXPECT_EQ(std::memcmp(tree.units.data(), expected.units.data(), expected.units.size() * sizeof(BvhTree::Unit)), 0);
        EXPECT_EQ(tree.depth, expected.depth);
        EXPECT_EQ(tree.nodes, expected.nodes);
        EXPECT_EQ(tree.leaves, expected.leaves);
        EXPECT_TRUE(equal(tree.bounds, expected.bounds));
    }
}

// Large enough for every loop of the builder: bins in chunks, sets cut together, tasks.
TEST(BvhParallel, OneTreeFromAnyScheduleOfALargeScene) {
    expect_one_tree(triangles_in_cube(11, 300000, glm::vec3(0.0f), 1.0f, 0.02f));
    expect_one_tree(scenes::mixture(12, 60000, 1.0f));
    // Ties everywhere, zeros of both signs among them.
    Geometry tied = scenes::same_triangle_70000();
    for (int i = 0; i < 200000; ++i) {
        const float zero = i % 3 == 0 ? -0.0f : 0.0f;
        tied.spheres.push_back({glm::vec3(static_cast<float>(i % 50), zero, zero), 0.5f});
        tied.boxes.push_back(
            {glm::vec3(zero, -1.0f, static_cast<float>(i % 7)), glm::vec3(0.0f, zero, static_cast<float>(i % 7))});
    }
    expect_one_tree(tied);
}

class ParallelOnScene : public testing::TestWithParam<AdversarialScene> {};
TEST_P(ParallelOnScene, OneTreeFromAnySchedule) { expect_one_tree(GetParam().build()); }
INSTANTIATE_TEST_SUITE_P(Scenes, ParallelOnScene, testing::ValuesIn(kAdversarialScenes),
                         [](const testing::TestParamInfo<AdversarialScene>& scene) { return std::string(scene.param.name); });

TEST(BvhParallel, TheCallersLoopIsTheOneThatIsUsed) {
    const auto g = std::make_shared<const Geometry>(triangles_in_cube(13, 100000, glm::vec3(0.0f), 1.0f, 0.02f));
    std::size_t tasks = 0;
    const auto counting = [&](std::size_t count, const std::function<void(std::size_t)>& task) {
        tasks += count;
        serial_for(count, task);
    };
    EXPECT_NE(build_accelerator(AcceleratorKind::bvh, g, counting), nullptr);
    EXPECT_GT(tasks, 4u);
    // What it throws comes out, so that a build can be abandoned in the middle.
    const auto stopping = [&](std::size_t, const std::function<void(std::size_t)>&) { throw std::runtime_error("stop"); };
    EXPECT_THROW((void)build_accelerator(AcceleratorKind::bvh, g, stopping), std::runtime_error);
}

// About a minute each, up to 2.6 GB; see tests/README.md.
TEST(LongBvh, TenMillionPrimitivesOneSoundTreeAndTheHitsOfBruteForce) {
    const auto g = std::make_shared<const Geometry>(triangles_in_cube(14, 10000000, glm::vec3(0.0f), 1.0f, 0.005f));
    ASSERT_GT(g->triangles.size(), 9990000u);
    expect_one_tree(*g);
    const Bvh bvh(g, on_four_threads);
    expect_sound(*g, bvh.tree());
    const BruteForce truth(g);
    Random random(15);
    std::size_t found = 0;
    for (int i = 0; i < 100; ++i) {
        const Ray ray{random.in_cube(-1.5f, 1.5f), random.direction()};
        const Hit expected = truth.closest_hit(ray), hit = bvh.closest_hit(ray);
        found += expected.found() ? 1 : 0;
        EXPECT_EQ(hit.primitive, expected.primitive);
        EXPECT_EQ(hit.t, expected.t);
        EXPECT_EQ(bvh.occluded(ray), expected.found());
    }
    EXPECT_GT(found, 20u);
}

TEST(LongBvh, TenMillionPrimitivesInOnePlace) {
    Geometry g = scenes::one_triangle();
    g.triangles.assign(10000000, g.triangles.front());
    const BvhTree tree = build_bvh(g, on_four_threads);
    expect_sound(g, tree);
}

TEST(LongGrid, TenMillionPrimitives) {
    const auto g = std::make_shared<const Geometry>(triangles_in_cube(14, 10000000, glm::vec3(0.0f), 1.0f, 0.005f));
    const Bvh bvh(g, on_four_threads);
    const UniformGrid grid(g);
    Random random(16);
    for (int i = 0; i < 10000; ++i) {
        const Ray ray{random.in_cube(-1.5f, 1.5f), random.direction()};
        const Hit expected = bvh.closest_hit(ray), hit = grid.closest_hit(ray);
        ASSERT_EQ(hit.primitive, expected.primitive);
        ASSERT_EQ(hit.t, expected.t);
    }
}

}  // namespace
}  // namespace glint
